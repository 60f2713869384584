//! One experiment: a motor is brought to a speed with some values of 0x2060 to 0x2062, and its ripple is measured.

use std::f64::consts::TAU;
use std::time::Duration;

use board::{ELECTRICAL_PERIODS_PER_TURN, TICK, TICKS_PER_SECOND};

use super::{Ripple, Values};
use crate::motor::figures;
use crate::test_bench::{NotEnabled, Setup, TestBench};

/// Periods of the natural frequency that an experiment lets the rotor settle, if it turns alone. An inertia that turns with it lets it
/// swing longer, with its square root.
const SETTLING_PERIODS: f64 = 80.0;
/// Periods of the natural frequency that the ripple is measured over.
const MEASURED_PERIODS: f64 = 80.0;
/// Part of the holding torque that accelerating takes at the most.
const ACCELERATING: f64 = 0.1;
/// The fastest acceleration in turns/s^2: slow enough to set the rotor swinging but little.
const MOST_ACCELERATION: f64 = 10.0;

/// Speed and load of an experiment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// Speed in turns a second.
    pub speed: f64,
    /// Torque of the load in Nm against the motion.
    pub load_torque: f64,
}

/// Speed over time: seconds, and turns a second.
pub type Course = Vec<(f64, f64)>;

/// A motor at rest on a bench, from which every experiment begins.
#[derive(Clone, Debug)]
pub struct Laboratory {
    bench: TestBench,
    /// Natural frequency of motor and load in Hz.
    natural_frequency: f64,
    acceleration: f64,
    settling: f64,
}

impl Laboratory {
    /// Enables the drive.
    ///
    /// # Errors
    /// It does not get enabled.
    pub fn new(setup: &Setup) -> Result<Self, NotEnabled> {
        let motor = &setup.plant.motor;
        let inertia = motor.inertia + setup.plant.load.inertia;
        let current = f64::from(setup.objects.peak_current) / 1e3;
        let natural_frequency = figures::natural_frequency(motor, current, setup.plant.load.inertia);
        let at_hand = ACCELERATING * motor.holding_torque(current) / (inertia * TAU);
        Ok(Self {
            bench: TestBench::enabled(setup)?,
            natural_frequency,
            acceleration: at_hand.min(MOST_ACCELERATION),
            settling: SETTLING_PERIODS * (inertia / motor.inertia).sqrt() / natural_frequency,
        })
    }

    /// Speed in turns a second at which the first resonance is to be expected.
    pub fn expected_resonance(&self) -> f64 {
        figures::resonant_speed(self.natural_frequency)
    }

    /// Simulated seconds that an experiment takes at the expected resonance.
    pub fn duration(&self) -> f64 {
        self.expected_resonance() / self.acceleration + self.settling + MEASURED_PERIODS / self.natural_frequency
    }

    /// The motor at its speed, settled; `None` if it falls out of step on the way.
    fn settled(&self, conditions: Conditions, values: Values) -> Option<TestBench> {
        let mut bench = self.bench.clone();
        values.set(bench.objects_mut());
        bench.set_load_torque(conditions.load_torque);
        let is_in_step = bench.run_up(conditions.speed, self.acceleration) && bench.stays_in_step(Duration::from_secs_f64(self.settling));
        is_in_step.then_some(bench)
    }

    /// Measures the ripple.
    pub fn ripple(&self, conditions: Conditions, values: Values) -> Ripple {
        let Some(mut bench) = self.settled(conditions, values) else {
            return Ripple::OUT_OF_STEP;
        };
        let mut deviations = Deviations::default();
        bench.run(self.window(conditions.speed), |seen| deviations.add(seen.speed - conditions.speed));
        match bench.is_out_of_step() {
            true => Ripple::OUT_OF_STEP,
            false => Ripple(deviations.root_mean_square() / conditions.speed),
        }
    }

    /// The speed over some electrical periods.
    pub fn course(&self, conditions: Conditions, values: Values, periods: u32) -> Course {
        let Some(mut bench) = self.settled(conditions, values) else {
            return Vec::new();
        };
        let mut course = Vec::new();
        bench.run(electrical_periods(f64::from(periods), conditions.speed), |seen| {
            course.push((course.len() as f64 / f64::from(TICKS_PER_SECOND), seen.speed));
        });
        course
    }

    /// The time to measure over: whole electrical periods, so that no part of a swing falsifies the mean.
    fn window(&self, speed: f64) -> Duration {
        let frequency = speed * f64::from(ELECTRICAL_PERIODS_PER_TURN);
        electrical_periods((MEASURED_PERIODS / self.natural_frequency * frequency).ceil(), speed)
    }
}

/// The ticks nearest to that many electrical periods.
fn electrical_periods(periods: f64, speed: f64) -> Duration {
    let frequency = speed * f64::from(ELECTRICAL_PERIODS_PER_TURN);
    let ticks = (periods / frequency * f64::from(TICKS_PER_SECOND)).round();
    Duration::from_nanos(ticks as u64 * TICK.0)
}

/// Deviations from a value near their mean.
#[derive(Default)]
struct Deviations {
    count: f64,
    sum: f64,
    squares: f64,
}

impl Deviations {
    fn add(&mut self, deviation: f64) {
        self.count += 1.0;
        self.sum += deviation;
        self.squares += deviation * deviation;
    }

    /// About their mean.
    fn root_mean_square(&self) -> f64 {
        let mean = self.sum / self.count;
        (self.squares / self.count - mean * mean).max(0.0).sqrt()
    }
}
