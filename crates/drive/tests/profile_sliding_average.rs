//! The sliding average of 0x2009: nothing is lost, nothing is late by more than the window.

use drive::profile::{Command, Generator, Position, Progress, Ramp, SlidingAverage, Speed};
use proptest::prelude::*;

/// A filter with a window of `ticks`.
fn filter(ticks: u16) -> SlidingAverage {
    let mut filter = SlidingAverage::new();
    filter.set_time(ticks * 50);
    filter
}

fn travel(filter: &mut SlidingAverage, sub_pulses: i64) -> i64 {
    filter.step(Speed::from_sub_pulses_per_tick(sub_pulses)).sub_pulses_per_tick()
}

proptest! {
    // manual: 2.2.9/lag
    #[test]
    fn a_filtered_move_ends_on_the_target_one_window_later_without_overshoot(
        ticks in 0u16..=512,
        target in -50_000i32..50_000,
        speed in 1000u32..300_000,
        acceleration in 100_000u32..10_000_000,
    ) {
        let mut filter = filter(ticks);
        let mut generator = Generator::default();
        let ramp = Ramp::new(acceleration, acceleration);
        let command = Command::MoveTo {
            target: Position::from_pulses(target),
            speed: Speed::from_pulses_per_second(speed.into()),
            ramp,
            onward: None,
        };
        let end = Position::from_pulses(target);
        let mut position = Position::default();
        let mut before = Speed::ZERO;
        loop {
            let reached = generator.step(&command) == Progress::Reached;
            let velocity = filter.step(generator.velocity());
            prop_assert!((velocity.sub_pulses_per_tick() - before.sub_pulses_per_tick()).abs() <= ramp.acceleration.per_tick() + 1);
            before = velocity;
            position = position.after_tick(velocity);
            prop_assert!(position.clamp(end.min(Position::default()), end.max(Position::default())) == position);
            if reached {
                break;
            }
        }
        // Once the generator has stood for a tick, the rest of the window comes out.
        for _ in 1..ticks.max(1) {
            prop_assert!(ticks <= 1 || target == 0 || !filter.is_settled());
            position = position.after_tick(filter.step(Speed::ZERO));
        }
        prop_assert!(filter.is_settled());
        prop_assert_eq!(position, end);
    }

    #[test]
    fn any_travel_comes_out_whole(ticks in 0u16..=512, travels in prop::collection::vec(-400_000_000_000i64..400_000_000_000, 1..1500)) {
        let mut filter = filter(ticks);
        let out: i64 = travels.iter().map(|&sub_pulses| travel(&mut filter, sub_pulses)).sum();
        let rest: i64 = (0..ticks.max(1)).map(|_| travel(&mut filter, 0)).sum();
        prop_assert_eq!(out + rest, travels.iter().sum::<i64>());
        prop_assert!(filter.is_settled());
        prop_assert_eq!(travel(&mut filter, 0), 0);
    }
}

// manual: 2.2.9/smooth
#[test]
fn a_step_in_speed_becomes_a_ramp_as_long_as_the_window() {
    let mut filter = filter(100);
    for tick in 1..=100 {
        assert_eq!(travel(&mut filter, 1_000_000), 10_000 * tick);
    }
    assert_eq!(travel(&mut filter, 1_000_000), 1_000_000);
}

#[test]
fn a_new_window_waits_for_standstill() {
    let mut filter = filter(4);
    assert_eq!(travel(&mut filter, 400), 100);
    filter.set_time(0);
    let out: Vec<i64> = (0..5).map(|_| travel(&mut filter, 0)).collect();
    assert_eq!(out, [100, 100, 100, 0, 0]);
    assert_eq!(travel(&mut filter, 400), 400);
    filter.set_time(100);
    assert_eq!(travel(&mut filter, 400), 400, "still moving");
    assert_eq!(travel(&mut filter, 0), 0);
    assert_eq!(travel(&mut filter, 400), 200);
    assert_eq!(travel(&mut filter, 400), 400);
}

#[test]
fn the_longest_window_and_the_highest_speed_do_not_overflow() {
    let mut filter = filter(512);
    filter.set_time(u16::MAX);
    let out: Vec<Speed> = (0..512).map(|_| filter.step(Speed::MAX)).collect();
    assert_eq!(out[511], Speed::MAX);
    filter.clear();
    assert!(filter.is_settled());
    assert_eq!(filter.step(Speed::ZERO), Speed::ZERO);
}
