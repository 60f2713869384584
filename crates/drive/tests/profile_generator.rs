//! The trapezoid generator over random motions: exact ends, kept limits, no time lost.

use drive::profile::{Acceleration, Command, Generator, Onward, Position, Progress, Ramp, Speed};
use proptest::prelude::*;

const TICKS_PER_SECOND: f64 = 20_000.0;

/// The limits of a motion, as the objects hold them.
#[derive(Clone, Copy, Debug)]
struct Motion {
    speed: u32,
    acceleration: u32,
    deceleration: u32,
}

impl Motion {
    fn to(self, target: i32) -> Command {
        Command::MoveTo {
            target: Position::from_pulses(target),
            speed: self.speed(),
            ramp: self.ramp(),
            onward: None,
        }
    }

    fn speed(self) -> Speed {
        Speed::from_pulses_per_second(self.speed.into())
    }

    fn ramp(self) -> Ramp {
        Ramp::new(self.acceleration, self.deceleration)
    }

    /// The least time from rest to rest over `distance` pulses, in ticks.
    fn least_ticks(self, distance: f64) -> f64 {
        let (v, a, d) = (f64::from(self.speed), f64::from(self.acceleration), f64::from(self.deceleration));
        let ramps = v * v / 2.0 * (1.0 / a + 1.0 / d);
        let seconds = if ramps <= distance {
            distance / v + v / 2.0 * (1.0 / a + 1.0 / d)
        } else {
            (2.0 * distance * (a + d) / (a * d)).sqrt()
        };
        seconds * TICKS_PER_SECOND
    }
}

/// A value whose order of magnitude is uniform.
fn magnitude(least: u32, most: u32) -> impl Strategy<Value = u32> {
    (f64::from(least).ln()..=f64::from(most).ln()).prop_map(move |log| (log.exp() as u32).clamp(least, most))
}

fn motion() -> impl Strategy<Value = Motion> {
    (magnitude(1, 300_000), magnitude(100, 10_000_000), magnitude(100, 10_000_000)).prop_map(|(speed, acceleration, deceleration)| Motion {
        speed,
        acceleration,
        deceleration,
    })
}

/// Anywhere in the range, its ends included.
fn anywhere() -> impl Strategy<Value = i32> {
    prop_oneof![4 => any::<i32>(), 1 => i32::MAX - 5..=i32::MAX, 1 => i32::MIN..=i32::MIN + 5, 1 => -5..5]
}

/// Steps once and checks that the speed changed by no more than the ramp allows, and not upwards beyond `top`.
fn step_within(generator: &mut Generator, command: &Command, top: Speed, ramp: Ramp) -> Result<Progress, TestCaseError> {
    let start = *generator;
    let progress = generator.step(command);
    let (before, after) = (start.velocity().sub_pulses_per_tick(), generator.velocity().sub_pulses_per_tick());
    let (slower, faster) = (-ramp.deceleration.per_tick(), ramp.acceleration.per_tick());
    let change = if before == 0 || before.signum() == after.signum() || after == 0 {
        after.abs() - before.abs()
    } else {
        return Err(TestCaseError::fail(format!("jumped through zero: {before} to {after}")));
    };
    prop_assert!(
        (slower..=faster).contains(&change),
        "speed changed by {change}: {start:?} {command:?}"
    );
    prop_assert!(
        after.abs() <= top.sub_pulses_per_tick().max(before.abs()),
        "too fast: {after} {command:?}"
    );
    prop_assert_eq!(generator.position().sub_pulses_from(start.position()), after);
    Ok(progress)
}

/// Runs until the command is fulfilled; a motion that takes longer than `most` ticks fails.
fn run(generator: &mut Generator, command: &Command, top: Speed, ramp: Ramp, most: f64) -> Result<u32, TestCaseError> {
    for tick in 0..=most as u32 {
        if step_within(generator, command, top, ramp)? == Progress::Reached {
            return Ok(tick);
        }
    }
    Err(TestCaseError::fail(format!(
        "not there after {most} ticks: {generator:?} {command:?}"
    )))
}

/// A target about `ticks` of travel at most away from `start`, on either side, or the end of the range if that is nearer.
fn target_near(start: i32, motion: Motion, ticks: f64, part: f64) -> i32 {
    let seconds = ticks / TICKS_PER_SECOND;
    let weaker = f64::from(motion.acceleration.min(motion.deceleration));
    let farthest = (f64::from(motion.speed) * seconds).min(weaker * seconds * seconds / 4.0).max(2.0);
    (f64::from(start) + farthest * part) as i32
}

proptest! {
    #[test]
    fn moves_end_on_the_target_without_overshoot_and_lose_at_most_two_ticks(
        start in anywhere(),
        moves in prop::collection::vec((motion(), -1.0f64..1.0), 12),
    ) {
        let mut generator = Generator::at(Position::from_pulses(start), Speed::ZERO);
        for (motion, part) in moves {
            let start = generator.position();
            let target = target_near(start.pulses(), motion, 4000.0, part);
            let end = Position::from_pulses(target);
            let least = motion.least_ticks((f64::from(target) - f64::from(start.pulses())).abs());
            let mut arrival = 0;
            while generator.position() != end {
                step_within(&mut generator, &motion.to(target), motion.speed(), motion.ramp())?;
                arrival += 1;
                prop_assert!(f64::from(arrival) <= least + 2.0, "late: {arrival} ticks, least {least}");
                prop_assert!(generator.position().clamp(start.min(end), start.max(end)) == generator.position(), "overshoot");
            }
            prop_assert_eq!(generator.step(&motion.to(target)), Progress::Reached);
            prop_assert!(generator.is_standing());
        }
    }

    #[test]
    fn targets_speeds_and_ramps_changed_in_flight_keep_the_limits_and_are_reached(
        start in -1_000_000..1_000_000i32,
        changes in prop::collection::vec((motion(), -1.0f64..1.0, 1u32..2000), 12),
    ) {
        let mut generator = Generator::at(Position::from_pulses(start), Speed::ZERO);
        for &(motion, part, ticks) in &changes {
            let target = target_near(generator.position().pulses(), motion, 4000.0, part);
            for _ in 0..ticks {
                step_within(&mut generator, &motion.to(target), motion.speed(), motion.ramp())?;
            }
        }
        let last = Motion { deceleration: 1_000_000, acceleration: 1_000_000, speed: 300_000 };
        run(&mut generator, &last.to(start), last.speed(), last.ramp(), 400_000.0)?;
        prop_assert_eq!(generator, Generator::at(Position::from_pulses(start), Speed::ZERO));
    }

    #[test]
    fn a_target_too_near_to_stop_at_is_reached_by_turning_round(motion in motion(), ticks in 100u32..3000, nearer in 0.0f64..1.0) {
        let mut generator = Generator::default();
        for _ in 0..ticks {
            step_within(&mut generator, &motion.to(i32::MAX), motion.speed(), motion.ramp())?;
        }
        let passed = generator.position();
        let target = (f64::from(passed.pulses()) * nearer) as i32;
        let overrun = f64::from(motion.speed).powi(2) / 2.0 / f64::from(motion.deceleration);
        let most = 2.0 * motion.least_ticks(f64::from(passed.pulses()) + overrun + 1.0) + f64::from(ticks) + 10.0;
        run(&mut generator, &motion.to(target), motion.speed(), motion.ramp(), most + f64::from(motion.speed) / f64::from(motion.deceleration) * TICKS_PER_SECOND)?;
        prop_assert_eq!(generator.position(), Position::from_pulses(target));
    }

    #[test]
    fn a_stop_ends_on_a_whole_pulse_less_than_one_pulse_beyond_the_shortest_stop(
        start in anywhere(),
        cruise in motion(),
        reverse: bool,
        ticks in 1u32..3000,
        deceleration in magnitude(1000, 10_000_000),
    ) {
        let mut generator = Generator::at(Position::from_pulses(start), Speed::ZERO);
        let velocity = Speed::from_pulses_per_second(i64::from(cruise.speed) * if reverse { -1 } else { 1 });
        for _ in 0..ticks {
            step_within(&mut generator, &Command::RunAt { velocity, ramp: cruise.ramp() }, velocity.max(cruise.speed()), cruise.ramp())?;
        }
        let (from, speed) = (generator.position(), generator.velocity().sub_pulses_per_tick().abs() as f64 / TICKS_PER_SECOND);
        let stop = Command::Stop { deceleration: Acceleration::new(deceleration) };
        let ramp = Ramp::new(deceleration, deceleration);
        let creep = Speed::from_pulses_per_second(100);
        let shortest = speed * speed / 2.0 / f64::from(deceleration);
        let most = (speed / f64::from(deceleration) + 2.0 / (f64::from(deceleration)).sqrt() + 1.0 / speed.max(100.0)) * TICKS_PER_SECOND + 3.0;
        run(&mut generator, &stop, creep, ramp, most)?;
        prop_assert!(generator.is_standing());
        let travel = generator.position().sub_pulses_from(from) as f64 / 4e8;
        // The continuous stop is longer than the one in ticks by up to half a tick at the first speed.
        prop_assert!(travel.abs() <= shortest + 1.0, "{travel} instead of {shortest}");
        prop_assert!(travel.abs() >= shortest - speed / TICKS_PER_SECOND - 1.0, "{travel} instead of {shortest}");
        let stands = generator;
        prop_assert_eq!(generator.step(&stop), Progress::Reached);
        prop_assert_eq!(generator, stands);
    }

    #[test]
    fn velocities_are_reached_in_the_ramps_time_and_reversed_through_zero(
        start in anywhere(),
        legs in prop::collection::vec((motion(), any::<bool>()), 8),
    ) {
        let mut generator = Generator::at(Position::from_pulses(start), Speed::ZERO);
        for (motion, reverse) in legs {
            let motion = Motion { acceleration: motion.acceleration.max(10_000), deceleration: motion.deceleration.max(10_000), ..motion };
            let signed = i64::from(motion.speed) * if reverse { -1 } else { 1 };
            let velocity = Speed::from_pulses_per_second(signed);
            let before = i64::from(generator.velocity().pulses_per_second());
            let (rise, fall) = if before * signed < 0 {
                (signed.abs(), before.abs())
            } else {
                ((signed.abs() - before.abs()).max(0), (before.abs() - signed.abs()).max(0))
            };
            let ticks = (rise as f64 / f64::from(motion.acceleration) + fall as f64 / f64::from(motion.deceleration)) * TICKS_PER_SECOND;
            let command = Command::RunAt { velocity, ramp: motion.ramp() };
            let taken = run(&mut generator, &command, motion.speed(), motion.ramp(), ticks + 3.0)?;
            prop_assert!(f64::from(taken) + 2.0 >= ticks);
            prop_assert_eq!(generator.velocity(), velocity);
        }
    }

    #[test]
    fn a_set_point_chained_ahead_is_passed_at_full_speed_and_one_behind_is_stopped_at(
        first in 50_000i32..100_000,
        second in -200_000i32..300_000,
        speed in 30_000u32..100_000,
        deceleration in 200_000u32..10_000_000,
        last_deceleration in 200_000u32..10_000_000,
    ) {
        let motion = Motion { speed, acceleration: 1_000_000, deceleration };
        let last = Motion { deceleration: last_deceleration, ..motion };
        let onward = Onward { target: Position::from_pulses(second), deceleration: Acceleration::new(last_deceleration) };
        let chained = Command::MoveTo {
            target: Position::from_pulses(first),
            speed: motion.speed(),
            ramp: motion.ramp(),
            onward: Some(onward),
        };
        let mut generator = Generator::default();
        run(&mut generator, &chained, motion.speed(), motion.ramp(), 400_000.0)?;
        if second > first {
            prop_assert!(generator.position() >= Position::from_pulses(first));
            let room = f64::from(second - first);
            let fast = f64::from(generator.velocity().pulses_per_second());
            let weaker = f64::from(deceleration.min(last_deceleration));
            prop_assert!(fast >= (2.0 * weaker * room).sqrt().min(f64::from(speed)) * 0.999 - 3.0 * weaker / TICKS_PER_SECOND);
        } else {
            prop_assert_eq!(generator, Generator::at(Position::from_pulses(first), Speed::ZERO));
        }
        let mut farthest = generator.position();
        for _ in 0..400_000 {
            let progress = step_within(&mut generator, &last.to(second), last.speed(), last.ramp())?;
            farthest = farthest.max(generator.position());
            if progress == Progress::Reached {
                break;
            }
        }
        prop_assert_eq!(generator, Generator::at(Position::from_pulses(second), Speed::ZERO));
        prop_assert!(farthest <= Position::from_pulses(first.max(second)), "overshoot");
    }
}

#[test]
fn the_whole_range_is_crossed_exactly() {
    let motion = Motion {
        speed: 2_000_000_000,
        acceleration: 4_000_000_000,
        deceleration: 3_000_000_000,
    };
    let mut generator = Generator::at(Position::from_pulses(i32::MIN), Speed::ZERO);
    run(&mut generator, &motion.to(i32::MAX), motion.speed(), motion.ramp(), 100_000.0).unwrap();
    assert_eq!(generator.position(), Position::from_pulses(i32::MAX));
}

#[test]
fn the_gentlest_ramp_is_exact_too() {
    let motion = Motion {
        speed: 10,
        acceleration: 0,
        deceleration: 0,
    };
    let mut generator = Generator::default();
    run(
        &mut generator,
        &motion.to(-3),
        motion.speed(),
        motion.ramp(),
        4.0 * TICKS_PER_SECOND,
    )
    .unwrap();
    assert_eq!(generator.position(), Position::from_pulses(-3));
}

#[test]
fn a_move_beyond_the_range_goes_straight_on() {
    let target = Position::from_pulses(i32::MAX - 10).offset_by(1000);
    let mut generator = Generator::at(Position::from_pulses(i32::MAX - 10), Speed::ZERO);
    let command = Command::MoveTo {
        target,
        speed: Speed::from_pulses_per_second(10_000),
        ramp: Ramp::new(1_000_000, 1_000_000),
        onward: None,
    };
    for _ in 0..3000 {
        generator.step(&command);
        assert!(generator.velocity() >= Speed::ZERO);
    }
    assert_eq!(generator.position(), target);
    assert_eq!(generator.position().pulses(), i32::MIN + 989);
}

#[test]
fn running_on_past_the_end_of_the_range_wraps_and_keeps_the_velocity() {
    let mut generator = Generator::at(Position::from_pulses(i32::MAX), Speed::ZERO);
    let velocity = Speed::from_pulses_per_second(20_000);
    let command = Command::RunAt {
        velocity,
        ramp: Ramp::new(1_000_000_000, 1),
    };
    for _ in 0..20_000 {
        generator.step(&command);
    }
    assert_eq!(generator.velocity(), velocity);
    assert_eq!(generator.position(), Position::from_pulses(i32::MIN + 19_999));
}

#[test]
fn a_speed_of_zero_brakes_to_rest_and_stays() {
    let motion = Motion {
        speed: 0,
        acceleration: 100_000,
        deceleration: 100_000,
    };
    let mut generator = Generator::at(Position::default(), Speed::from_pulses_per_second(1000));
    for _ in 0..300 {
        generator.step(&motion.to(1_000_000));
    }
    assert_eq!(generator.velocity(), Speed::ZERO);
}

#[test]
fn a_stop_at_rest_between_pulses_goes_to_the_nearer_one() {
    for (sub_pulses, pulse) in [(100_000_000, 0), (300_000_000, 1), (-300_000_000, -1)] {
        let mut generator = Generator::at(Position::from_sub_pulses(sub_pulses), Speed::ZERO);
        let stop = Command::Stop {
            deceleration: Acceleration::new(100_000),
        };
        let ticks = (0..1000).find(|_| generator.step(&stop) == Progress::Reached).expect("a stop ends");
        assert_eq!(generator.position(), Position::from_pulses(pulse));
        assert!(ticks <= 200);
    }
}

#[test]
fn a_stop_from_the_highest_speed_with_the_gentlest_ramp_does_not_overflow() {
    let mut generator = Generator::at(Position::default(), Speed::MAX);
    let stop = Command::Stop {
        deceleration: Acceleration::new(0),
    };
    for tick in 1..1000 {
        generator.step(&stop);
        assert_eq!(generator.velocity().sub_pulses_per_tick(), Speed::MAX.sub_pulses_per_tick() - tick);
    }
}
