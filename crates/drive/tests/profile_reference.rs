//! The trapezoid generator beside the continuous optimum in closed form, tick by tick and after changes in flight.
//!
//! The reference knows pulses, seconds and real numbers only; it shares no code and no rounding with the generator.

use drive::profile::{Command, Generator, Position, Progress, Ramp, Speed};
use proptest::prelude::*;

const TICK: f64 = 50e-6;

/// What a motion may not exceed, in pulses and seconds.
#[derive(Clone, Copy, Debug)]
struct Limits {
    speed: f64,
    acceleration: f64,
    deceleration: f64,
}

impl Limits {
    fn command(self, target: i32) -> Command {
        Command::MoveTo {
            target: Position::from_pulses(target),
            speed: Speed::from_pulses_per_second(self.speed as i64),
            ramp: Ramp::new(self.acceleration as u32, self.deceleration as u32),
            onward: None,
        }
    }

    /// The highest speed on the way over `distance` to a stop, starting at `speed` along it.
    fn peak(self, distance: f64, speed: f64) -> f64 {
        let (a, d) = (self.acceleration, self.deceleration);
        ((2.0 * a * d * distance + d * speed * speed) / (a + d)).sqrt().min(self.speed)
    }

    /// The least time from `speed`, positive towards the target, to standing on the target `distance` away.
    fn least_seconds(self, distance: f64, speed: f64) -> f64 {
        let (a, d) = (self.acceleration, self.deceleration);
        let stop = speed * speed / (2.0 * d);
        if speed < 0.0 {
            return -speed / d + self.least_seconds(distance + stop, 0.0);
        }
        if stop > distance {
            return speed / d + self.least_seconds(stop - distance, 0.0);
        }
        if speed > self.speed {
            return speed / d + (distance - stop) / self.speed;
        }
        let peak = self.peak(distance, speed);
        let ramps = (peak * peak - speed * speed) / (2.0 * a) + peak * peak / (2.0 * d);
        (peak - speed) / a + peak / d + ((distance - ramps) / peak.max(1e-9)).max(0.0)
    }

    /// The distance covered after `seconds` of the optimum from rest to rest over `distance`.
    fn covered(self, distance: f64, seconds: f64) -> f64 {
        let (a, d) = (self.acceleration, self.deceleration);
        let (peak, whole) = (self.peak(distance, 0.0), self.least_seconds(distance, 0.0));
        let (seconds, left) = (seconds.clamp(0.0, whole), whole - seconds.clamp(0.0, whole));
        if seconds < peak / a {
            a * seconds * seconds / 2.0
        } else if left < peak / d {
            distance - d * left * left / 2.0
        } else {
            peak * peak / (2.0 * a) + peak * (seconds - peak / a)
        }
    }
}

/// A value whose order of magnitude is uniform.
fn magnitude(least: f64, most: f64) -> impl Strategy<Value = f64> {
    (least.ln()..=most.ln()).prop_map(|log| log.exp().round())
}

fn limits() -> impl Strategy<Value = Limits> {
    (
        magnitude(10.0, 300_000.0),
        magnitude(1_000.0, 10_000_000.0),
        magnitude(1_000.0, 10_000_000.0),
    )
        .prop_map(|(speed, acceleration, deceleration)| Limits {
            speed,
            acceleration,
            deceleration,
        })
}

/// A distance that takes up to about `seconds`.
fn distance(limits: Limits, seconds: f64, part: f64) -> i32 {
    let weaker = limits.acceleration.min(limits.deceleration);
    (limits.speed * seconds)
        .min(weaker * seconds * seconds / 4.0)
        .mul_add(part, part.signum()) as i32
}

fn pulses(generator: &Generator) -> f64 {
    generator.position().sub_pulses() as f64 / 4e8
}

fn pulses_per_second(generator: &Generator) -> f64 {
    generator.velocity().sub_pulses_per_tick() as f64 / 20_000.0
}

/// Steps to the end of `command`, and counts the ticks.
fn ticks_to_the_end(generator: &mut Generator, command: &Command) -> Result<u32, TestCaseError> {
    for tick in 1..10_000_000 {
        if generator.step(command) == Progress::Reached {
            return Ok(tick);
        }
    }
    Err(TestCaseError::fail("no end"))
}

proptest! {
    #[test]
    fn a_move_is_at_every_tick_between_the_optimum_one_tick_ahead_and_two_ticks_behind(limits in limits(), part in -1.0f64..1.0) {
        let target = distance(limits, 0.2, part);
        let way = f64::from(target.abs());
        let command = limits.command(target);
        let mut generator = Generator::default();
        for tick in 1.. {
            let progress = generator.step(&command);
            let (here, time) = (pulses(&generator).abs(), f64::from(tick));
            let (ahead, behind) = (limits.covered(way, (time + 1.0) * TICK), limits.covered(way, (time - 2.0) * TICK));
            prop_assert!((behind - 1e-6..=ahead + 1e-6).contains(&here), "tick {tick}: {here} not in {behind}..{ahead}");
            if progress == Progress::Reached {
                break;
            }
        }
        prop_assert_eq!(generator, Generator::at(Position::from_pulses(target), Speed::ZERO));
    }

    #[test]
    fn whatever_a_change_in_flight_changes_the_rest_takes_at_most_two_ticks_more_than_the_optimum_and_one_for_turning_round(
        start in limits(),
        ticks in 1u32..2_000,
        change in limits(),
        part in -1.0f64..1.0,
    ) {
        let mut generator = Generator::default();
        let far = start.command(i32::MAX);
        (0..ticks).for_each(|_| {
            generator.step(&far);
        });
        let (here, speed) = (pulses(&generator), pulses_per_second(&generator));
        let target = here as i32 + distance(change, 0.2, part);
        let ahead = f64::from(target) - here;
        let least = change.least_seconds(ahead.abs(), speed * ahead.signum());
        prop_assume!(least < 2.0);
        let turns = ahead < 0.0 || speed * speed / (2.0 * change.deceleration) > ahead;
        let taken = f64::from(ticks_to_the_end(&mut generator, &change.command(target))?);
        // Braking in ticks covers less than braking does by up to half a tick at the old speed, and the new one has to make up for it.
        let made_up = if speed > change.speed { speed / change.speed / 2.0 } else { 0.0 };
        let most = least / TICK + made_up + if turns { 3.0 } else { 2.0 };
        prop_assert!(taken <= most, "{taken} ticks, optimum {}", least / TICK);
        prop_assert_eq!(generator, Generator::at(Position::from_pulses(target), Speed::ZERO));
    }
}

#[test]
fn the_reference_knows_a_triangle_a_trapezoid_and_an_overrun() {
    let limits = Limits {
        speed: 1_000.0,
        acceleration: 10_000.0,
        deceleration: 5_000.0,
    };
    let is = |seconds: f64, expected: f64| assert!((seconds - expected).abs() < 1e-9, "{seconds} instead of {expected}");
    is(limits.least_seconds(150.0, 0.0), 0.3);
    is(limits.least_seconds(250.0, 0.0), 0.4);
    is(limits.least_seconds(100.0, 1_000.0), 0.2);
    is(limits.least_seconds(1_000.0, 2_000.0), 0.4 + 0.6);
    is(limits.least_seconds(-50.0 + 100.0, 1_000.0), 0.2 + limits.least_seconds(50.0, 0.0));
    is(limits.least_seconds(10.0, -1_000.0), 0.2 + limits.least_seconds(110.0, 0.0));
    is(limits.covered(150.0, 0.05), 12.5);
    is(limits.covered(250.0, 0.2), 150.0);
    is(limits.covered(250.0, 0.4), 250.0);
}
