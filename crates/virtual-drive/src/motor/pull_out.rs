//! The torque a motor carries at each speed: by formula, and by simulation of the drive's own control law on the motor.

use std::time::Duration;

use plant::Envelope;

use crate::parallel;
use crate::test_bench::{NotEnabled, Setup, TestBench};

/// How long a load rises.
const RISE: Duration = Duration::from_millis(500);
/// Steps in which it rises.
const RISE_STEPS: u32 = 250;
/// How long it then has to be carried. Hunting at middle speeds takes a few tenths of a second to grow.
const HOLD: Duration = Duration::from_millis(500);
/// How long the motor turns at its speed before it is loaded.
const SETTLE: Duration = Duration::from_millis(200);
/// Halvings of the search, from the holding torque and a quarter: to an eighth of a percent of it.
const HALVINGS: u32 = 10;
/// Where the search begins, as a part of the holding torque: a bridge of two phases gives up to 4/pi of what the formula allows.
const MOST: f64 = 1.3;
/// Part of the torque at hand that accelerating takes at the most.
const ACCELERATING: f64 = 0.15;
/// Accelerations in turns/s^2.
const ACCELERATIONS: (f64, f64) = (5.0, 50.0);

/// The torque at a speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Speed in turns a second.
    pub speed: f64,
    /// The formula's torque in Nm; not above zero where the motor cannot turn so fast.
    pub envelope: f64,
    /// The largest torque that the motor carries in the simulation, in Nm; `None` if it does not get to the speed without a load.
    pub simulated: Option<f64>,
}

/// The formula for what is on the bench.
pub fn envelope(setup: &Setup) -> Envelope {
    let supply = f64::from(setup.plant.supply.0) / 1e3;
    let current = f64::from(setup.objects.peak_current) / 1e3;
    Envelope::new(&setup.plant.motor, supply, current)
}

/// Evenly spread speeds, in turns a second: from half a turn up to a little above where the formula has no torque left.
pub fn speeds(setup: &Setup, count: usize) -> Vec<f64> {
    const LEAST: f64 = 0.5;
    let fastest = (envelope(setup).no_load_speed() * 1.1).max(2.0 * LEAST);
    let steps = count.max(2) - 1;
    (0..=steps)
        .map(|step| LEAST + (fastest - LEAST) * step as f64 / steps as f64)
        .collect()
}

/// Finds the torque at each of `speeds`, on all cores of the machine; `done` is told of each that is found.
///
/// The result does not depend on the number of cores.
///
/// # Errors
/// The drive does not get enabled.
pub fn measure(setup: &Setup, speeds: &[f64], done: &(dyn Fn() + Sync)) -> Result<Vec<Point>, NotEnabled> {
    let bench = TestBench::enabled(setup)?;
    let envelope = envelope(setup);
    Ok(parallel::map(speeds, |&speed| {
        let torque = envelope.torque_at(speed);
        let point = Point {
            speed,
            envelope: torque,
            simulated: largest_torque(&bench, speed, torque),
        };
        done();
        point
    }))
}

/// The largest torque that the motor carries at a speed; `None` if it does not get there.
fn largest_torque(bench: &TestBench, speed: f64, expected: f64) -> Option<f64> {
    let config = bench.plant().config();
    let inertia = config.motor.inertia + config.load.inertia;
    let at_hand = ACCELERATING * expected.max(0.0) / (inertia * std::f64::consts::TAU);
    let mut bench = bench.clone();
    if !bench.run_up(speed, at_hand.clamp(ACCELERATIONS.0, ACCELERATIONS.1)) || !bench.stays_in_step(SETTLE) {
        return None;
    }
    let current = f64::from(bench.objects().peak_current) / 1e3;
    let (mut carried, mut lost) = (0.0, MOST * config.motor.holding_torque(current));
    for _ in 0..HALVINGS {
        let middle = (carried + lost) / 2.0;
        if carries(bench.clone(), middle) {
            carried = middle;
        } else {
            lost = middle;
        }
    }
    Some(carried)
}

/// Whether the motor stays in step while its load rises to a torque, and then for a time.
fn carries(mut bench: TestBench, torque: f64) -> bool {
    for step in 1..=RISE_STEPS {
        bench.set_load_torque(torque * f64::from(step) / f64::from(RISE_STEPS));
        if !bench.stays_in_step(RISE / RISE_STEPS) {
            return false;
        }
    }
    bench.stays_in_step(HOLD)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motor::Motor;

    const SPEEDS: [f64; 4] = [4.0, 8.0, 12.5, 20.0];

    /// Motors and supplies of the reference's table.
    const CASES: [(&str, f64); 4] = [
        ("17hs4401", 24.0),
        ("qsh5718-56", 24.0),
        ("qsh6018-86-4a2", 48.0),
        ("three-phase-57", 48.0),
    ];

    fn setup(name: &str, supply: f64) -> Setup {
        let motor = Motor::find(name).unwrap().parameters;
        Setup::of(&motor, supply, motor.rated_current).without_losses()
    }

    fn ratios(setup: &Setup, speeds: &[f64]) -> Vec<(f64, f64)> {
        let points = measure(setup, speeds, &|| {}).unwrap();
        points
            .iter()
            .map(|point| (point.speed, point.simulated.unwrap_or(0.0) / point.envelope))
            .collect()
    }

    #[test]
    fn below_the_corner_the_motor_carries_what_the_formula_says_and_above_at_least_nineteen_twentieths_of_it() {
        for (name, supply) in CASES {
            let setup = setup(name, supply);
            let corner = envelope(&setup).corner_speed();
            for (speed, ratio) in ratios(&setup, &SPEEDS) {
                let range = if speed < corner {
                    0.98..1.02
                } else {
                    0.95..4.0 / std::f64::consts::PI
                };
                assert!(
                    range.contains(&ratio),
                    "{name} at {speed} turns/s, corner {corner}: {ratio} of the formula"
                );
            }
        }
    }

    #[test]
    fn without_the_damper_middle_speeds_cost_torque() {
        let mut setup = setup("qsh5718-56", 24.0);
        setup.objects.bemf_coefficient = 0;
        let [(_, middle), (_, low)] = ratios(&setup, &[12.5, 4.0])[..] else {
            unreachable!()
        };
        assert!(middle < 0.7, "{middle} of the formula at 12.5 turns/s");
        assert!((0.98..1.02).contains(&low), "{low} of the formula at 4 turns/s");
    }

    #[test]
    fn losses_of_bridge_and_supply_cost_torque_at_high_speed() {
        let ideal = setup("qsh5718-56", 24.0);
        let motor = ideal.plant.motor;
        let real = Setup::of(&motor, 24.0, motor.rated_current);
        assert!(ratios(&real, &[12.5])[0].1 < ratios(&ideal, &[12.5])[0].1);
    }

    #[test]
    fn a_speed_beyond_reach_has_no_torque() {
        let setup = setup("qsh6018-86", 24.0);
        let points = measure(&setup, &[60.0], &|| {}).unwrap();
        assert!(points[0].envelope < 0.0 && points[0].simulated.is_none(), "{points:?}");
    }

    #[test]
    fn speeds_reach_beyond_the_end_of_the_formula() {
        let setup = setup("qsh5718-56", 36.0);
        let speeds = speeds(&setup, 24);
        assert_eq!((speeds.len(), speeds[0]), (24, 0.5));
        assert!(envelope(&setup).torque_at(speeds[23]) < 0.0);
    }
}
