//! Cyclic synchronous position: each target is reached in its cycle, and nothing beyond it.

use board::{Nanos, TICK};
use drive::profile::{Interpolator, Position, Speed};
use proptest::prelude::*;

/// The cycle times a master may use, not all of them multiples of the tick.
const CYCLES: [u64; 6] = [125_000, 250_000, 333_000, 500_000, 1_000_000, 2_000_000];

/// Whether a synchronisation at `k * cycle + phase` falls into the tick that begins at `tick * 50 us`; and which one.
fn synchronisation(tick: u64, cycle: u64, phase: u64) -> Option<usize> {
    let now = tick * TICK.0;
    let latest = now.checked_sub(phase)? / cycle;
    (latest * cycle + phase + TICK.0 > now).then_some(latest as usize)
}

proptest! {
    #[test]
    fn every_target_is_reached_exactly_when_the_next_one_comes(
        cycle in prop::sample::select(CYCLES.to_vec()),
        start: i32,
        steps in prop::collection::vec(-2000i32..2000, 50..80),
    ) {
        let mut targets = vec![start];
        for step in &steps {
            targets.push(targets.last().unwrap().wrapping_add(*step));
        }
        let mut interpolator = Interpolator::at(Position::from_pulses(start));
        let mut travelled = 0;
        for tick in 0.. {
            if let Some(cycles) = synchronisation(tick, cycle, 0) {
                prop_assert_eq!(interpolator.position(), Position::from_pulses(targets[cycles]), "cycle {}", cycles);
                let Some(&target) = targets.get(cycles + 1) else { break };
                interpolator.synchronise(target, Nanos(cycle));
            }
            interpolator.step();
            travelled += interpolator.velocity().sub_pulses_per_tick();
            prop_assert_eq!(interpolator.position(), Position::from_sub_pulses(Position::from_pulses(start).sub_pulses() + travelled).wrapped());
        }
    }

    #[test]
    fn the_grid_of_a_master_out_of_step_is_found_in_a_few_cycles(
        cycle in prop::sample::select(CYCLES.to_vec()),
        phase in 0..TICK.0,
    ) {
        let mut interpolator = Interpolator::at(Position::default());
        let mut inexact = 0;
        for tick in 0.. {
            if let Some(cycles) = synchronisation(tick, cycle, phase) {
                inexact += usize::from(interpolator.position() != Position::from_pulses(cycles as i32 * 100));
                if cycles == 500 {
                    break;
                }
                interpolator.synchronise((cycles as i32 + 1) * 100, Nanos(cycle));
            }
            interpolator.step();
        }
        prop_assert!(inexact <= 2, "{inexact} of 500 cycles");
    }

    #[test]
    fn each_tick_of_a_cycle_travels_the_same(cycle in prop::sample::select(CYCLES.to_vec()), target in -100_000i32..100_000) {
        let mut interpolator = Interpolator::at(Position::default());
        interpolator.synchronise(target, Nanos(cycle));
        let ticks = cycle.div_ceil(TICK.0);
        let share = Position::from_pulses(target).sub_pulses() / ticks as i64;
        for _ in 0..ticks {
            interpolator.step();
            // The last tick also travels what the division leaves over.
            prop_assert!((interpolator.velocity().sub_pulses_per_tick() - share).abs() < ticks as i64);
        }
        prop_assert_eq!(interpolator.position(), Position::from_pulses(target));
    }

    #[test]
    fn any_cycle_time_and_target_are_survived(targets in prop::collection::vec((any::<i32>(), any::<u64>(), 0u32..5), 20)) {
        let mut interpolator = Interpolator::at(Position::default());
        for (target, cycle, ticks) in targets {
            interpolator.synchronise(target, Nanos(cycle));
            for _ in 0..ticks {
                interpolator.step();
                prop_assert!(interpolator.velocity() <= Speed::MAX);
            }
        }
    }
}

#[test]
fn it_stands_at_the_actual_position_until_the_first_target() {
    let actual = Position::from_pulses(-1234);
    let mut interpolator = Interpolator::at(actual);
    for _ in 0..10 {
        interpolator.step();
        assert_eq!((interpolator.position(), interpolator.velocity()), (actual, Speed::ZERO));
    }
}

#[test]
fn an_overdue_target_leaves_it_standing_on_the_last_one() {
    let mut interpolator = Interpolator::at(Position::default());
    interpolator.synchronise(1000, Nanos(1_000_000));
    for _ in 0..20 {
        interpolator.step();
    }
    for _ in 0..30 {
        interpolator.step();
        assert_eq!(
            (interpolator.position(), interpolator.velocity()),
            (Position::from_pulses(1000), Speed::ZERO)
        );
    }
    interpolator.synchronise(2000, Nanos(1_000_000));
    for _ in 0..20 {
        interpolator.step();
        assert_eq!(interpolator.velocity(), Speed::from_pulses_per_second(1_000_000));
    }
    assert_eq!(interpolator.position(), Position::from_pulses(2000));
}

#[test]
fn an_early_target_is_approached_from_where_the_axis_is() {
    let mut interpolator = Interpolator::at(Position::default());
    interpolator.synchronise(1000, Nanos(1_000_000));
    for _ in 0..15 {
        interpolator.step();
    }
    interpolator.synchronise(2750, Nanos(1_000_000));
    for _ in 0..20 {
        interpolator.step();
        assert_eq!(interpolator.velocity(), Speed::from_pulses_per_second(2_000_000));
    }
    assert_eq!(interpolator.position(), Position::from_pulses(2750));
}

#[test]
fn a_target_across_the_end_of_the_range_is_near() {
    let mut interpolator = Interpolator::at(Position::from_pulses(i32::MAX));
    interpolator.synchronise(i32::MIN + 19, Nanos(1_000_000));
    for _ in 0..20 {
        interpolator.step();
        assert_eq!(interpolator.velocity(), Speed::from_pulses_per_second(20_000));
    }
    assert_eq!(interpolator.position(), Position::from_pulses(i32::MIN + 19));
}
