//! A test bench: one drive and one motor on a free axis, without a network, with a load whose torque can be set.
//!
//! The drive is the firmware core as it is, and runs at speeds in profile velocity mode. Every tick can be looked at: what the drive
//! commands, and what the rotor does.
//!
//! ```
//! use std::time::Duration;
//! use plant::motors::QSH5718_56;
//! use usr2556e::test_bench::{Setup, TestBench};
//!
//! let setup = Setup::of(&QSH5718_56, 36.0, 3.96).with_load_inertia(300e-7);
//! let mut bench = TestBench::enabled(&setup).unwrap();
//! bench.run_up(5.0, 50.0);
//! bench.set_load_torque(0.5);
//! let mut largest_lag: f64 = 0.0;
//! bench.run(Duration::from_millis(100), |seen| largest_lag = largest_lag.max(seen.lag));
//! assert!(largest_lag > 0.03 && !bench.is_out_of_step());
//! ```

use std::fmt;
use std::time::Duration;

use board::{Millivolts, Sensors, TICK, TICKS_PER_SECOND};
use drive::faults::Fault;
use drive::{Drive, DriveObjects, PowerState};
use plant::{BridgeParameters, Load, MotorParameters, Plant, PlantConfig, SupplyParameters, Travel, Turns};

use crate::motor::commissioning::Commissioning;

use crate::synchronism::Synchronism;

/// Electrical periods in a turn.
const PERIODS: f64 = board::ELECTRICAL_PERIODS_PER_TURN as f64;

/// A rotor further than this from the commanded field, in electrical periods, has lost a period or more: in step it is within a half, and
/// after a loss beyond three quarters.
const OUT_OF_STEP: f64 = 0.75;

/// Ticks in which a drive gets enabled: ten seconds, more than the longest shaft lock (0x200A) of 6.6 s.
const ENABLING_LIMIT: u32 = 10 * TICKS_PER_SECOND;

/// Ticks in which a speed is reached, after the time that the ramp takes: the motion filter's at most.
const FILTER_LIMIT: u32 = TICKS_PER_SECOND / 10;

/// Mode of operation: profile velocity.
const PROFILE_VELOCITY: i8 = 3;

/// What is on the bench.
#[derive(Clone, Debug)]
pub struct Setup {
    /// Motor, load and supply.
    pub plant: PlantConfig,
    /// The objects that the drive begins with.
    pub objects: DriveObjects,
}

impl Setup {
    /// A motor without a load, behind a supply in V, with a current's peak in A.
    ///
    /// The axis is free: no switches, no end stops. The drive knows the motor, as somebody would tell it who has its data sheet: resistance,
    /// back-EMF, and the current loop's gains that its own identification would find. Its outputs have no function; all other objects are as
    /// at delivery.
    pub fn of(motor: &MotorParameters, supply: f64, current: f64) -> Self {
        let far = Turns(f64::INFINITY);
        let opposite = Turns(f64::NEG_INFINITY);
        let plant = PlantConfig {
            travel: Travel {
                negative_limit: opposite,
                positive_limit: far,
                home: (far, far),
                stops: (opposite, far),
            },
            supply: Millivolts((supply * 1e3).round() as i32),
            motor: *motor,
            load: Load::inertia(0.0),
            ..PlantConfig::default()
        };
        let mut objects = DriveObjects {
            mode: PROFILE_VELOCITY,
            auto_pi: 0,
            current_loop_kp: (motor.inductance * 1e6).round().clamp(100.0, 65_535.0) as u16,
            current_loop_ki: (motor.resistance * 1e3 / 5.0).round().clamp(0.0, 10_000.0) as u16,
            resistance_set: (motor.resistance * 1e3).round().clamp(0.0, 10_000.0) as u16,
            inductance_set: (motor.inductance * 1e3).round().clamp(1.0, 10.0) as u16,
            output_1_function: 0,
            output_2_function: 0,
            ..DriveObjects::new()
        };
        Commissioning::of(motor, current).write(&mut objects);
        Self { plant, objects }
    }

    /// With an inertia in kg m^2 that turns with the shaft.
    pub fn with_load_inertia(mut self, inertia: f64) -> Self {
        self.plant.load.inertia = inertia;
        self
    }

    /// With a bridge and a supply that lose nothing, as formulas have them.
    pub fn without_losses(mut self) -> Self {
        self.plant.bridge = BridgeParameters {
            on_resistance: 0.0,
            dead_time: 0.0,
            ..self.plant.bridge
        };
        self.plant.source = SupplyParameters {
            impedance: 1e-3,
            consumption: 0.0,
            ..self.plant.source
        };
        self
    }
}

/// Why a drive does not get enabled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotEnabled {
    /// The state it stays in.
    pub state: PowerState,
    /// The fault, if there is one.
    pub fault: Option<Fault>,
}

impl fmt::Display for NotEnabled {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.fault {
            Some(fault) => write!(f, "the drive reports a fault: {fault:?}, code {:04X}", fault.error_code()),
            None => write!(f, "the drive stays in {:?}", self.state),
        }
    }
}

impl std::error::Error for NotEnabled {}

/// What is seen in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Where the drive commands the shaft to be, in turns from where it was when the drive was enabled.
    pub commanded: f64,
    /// Where it is.
    pub shaft: f64,
    /// By how much it is behind, in electrical periods: lost ones count on.
    pub lag: f64,
    /// Speed of the shaft in turns a second.
    pub speed: f64,
}

/// One drive and one motor.
#[derive(Clone, Debug)]
pub struct TestBench {
    drive: Drive,
    objects: DriveObjects,
    plant: Plant,
    sensors: Sensors,
    synchronism: Synchronism,
    is_out_of_step: bool,
}

impl TestBench {
    /// A drive that has just been enabled, at rest with its full current.
    ///
    /// # Errors
    /// The drive does not get to Operation Enabled.
    pub fn enabled(setup: &Setup) -> Result<Self, NotEnabled> {
        let plant = Plant::new(setup.plant);
        let mut bench = Self {
            drive: Drive::new(),
            objects: setup.objects.clone(),
            sensors: plant.sensors(),
            plant,
            synchronism: Synchronism::default(),
            is_out_of_step: false,
        };
        bench.drive.set_network(true);
        for tick in 0..ENABLING_LIMIT {
            bench.objects.controlword = match tick {
                0 => 0x00,
                1 => 0x06,
                2 => 0x07,
                _ => 0x0F,
            };
            bench.tick();
            let is_locked = bench.drive.current_vector().is_some_and(|vector| {
                bench.drive.power_state() == PowerState::OperationEnabled && vector.amplitude.0 >= i32::from(bench.objects.peak_current)
            });
            if is_locked {
                return Ok(bench);
            }
            if bench.drive.fault().is_some() {
                break;
            }
        }
        Err(NotEnabled {
            state: bench.drive.power_state(),
            fault: bench.drive.fault(),
        })
    }

    /// Lets a control tick pass.
    pub fn tick(&mut self) -> Seen {
        let actuators = self.drive.tick(&self.sensors, &mut self.objects);
        self.sensors = self.plant.step(&actuators);
        let locked = self.drive.is_shaft_locked();
        self.synchronism.observe(self.drive.current_vector(), locked, self.plant.shaft());
        let seen = self.seen();
        self.is_out_of_step |= seen.lag.abs() > OUT_OF_STEP;
        seen
    }

    /// Lets a time pass, and shows every tick of it.
    pub fn run(&mut self, time: Duration, mut look: impl FnMut(&Seen)) {
        for _ in 0..ticks(time) {
            look(&self.tick());
        }
    }

    /// Lets a time pass as long as the motor stays in step; whether it did.
    pub fn stays_in_step(&mut self, time: Duration) -> bool {
        for _ in 0..ticks(time) {
            self.tick();
            if self.is_out_of_step {
                return false;
            }
        }
        true
    }

    /// Brings the motor to a speed in turns a second, either way, with an acceleration in turns/s^2, and returns whether it stayed in step.
    /// Speed and acceleration are rounded to whole pulses.
    pub fn run_up(&mut self, speed: f64, acceleration: f64) -> bool {
        let pulses = f64::from(self.objects.resolution);
        let [velocity, rate] = [speed * pulses, acceleration.abs() * pulses].map(|value| value.round() as i32);
        let change = f64::from(velocity) / pulses - self.commanded_speed();
        self.objects.target_velocity = velocity;
        (self.objects.profile_acceleration, self.objects.profile_deceleration) = (rate.max(1), rate.max(1));
        let ramp = change.abs() / (f64::from(rate.max(1)) / pulses) * f64::from(TICKS_PER_SECOND);
        // Up and down again, if it turned the other way.
        for _ in 0..ramp as u32 + FILTER_LIMIT {
            self.tick();
            if self.is_out_of_step {
                return false;
            }
        }
        true
    }

    /// Loads the shaft with a torque in Nm against positive motion, from the next tick on.
    pub fn set_load_torque(&mut self, torque: f64) {
        self.plant.set_load_torque(torque);
    }

    /// Whether the motor has ever lost an electrical period.
    pub fn is_out_of_step(&self) -> bool {
        self.is_out_of_step
    }

    /// The speed that the drive commands, in turns a second.
    pub fn commanded_speed(&self) -> f64 {
        f64::from(self.drive.velocity().pulses_per_second()) / f64::from(self.objects.resolution)
    }

    /// What there is to see now.
    pub fn seen(&self) -> Seen {
        let motor = self.plant.motor();
        let shaft = motor.turns - self.plant.config().start.0;
        let lag = self.synchronism.behind();
        Seen {
            commanded: shaft + lag / PERIODS,
            shaft,
            lag,
            speed: motor.speed / std::f64::consts::TAU,
        }
    }

    /// The drive.
    pub fn drive(&self) -> &Drive {
        &self.drive
    }

    /// The drive's objects.
    pub fn objects(&self) -> &DriveObjects {
        &self.objects
    }

    /// The drive's objects, to change them: they act from the next tick on.
    pub fn objects_mut(&mut self) -> &mut DriveObjects {
        &mut self.objects
    }

    /// Motor, load and supply.
    pub fn plant(&self) -> &Plant {
        &self.plant
    }

    /// Motor, load and supply, to break something.
    pub fn plant_mut(&mut self) -> &mut Plant {
        &mut self.plant
    }
}

fn ticks(time: Duration) -> u64 {
    (time.as_nanos() / u128::from(TICK.0)) as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use plant::motors::{self, QSH5718_56};

    #[test]
    fn a_load_turns_the_shaft_by_the_arcsine_of_its_share_of_the_torque() {
        let setup = Setup::of(&QSH5718_56, 36.0, 3.96).without_losses();
        let smooth = MotorParameters {
            detent_torque: 0.0,
            friction: 0.0,
            ..QSH5718_56
        };
        let mut bench = TestBench::enabled(&Setup {
            plant: PlantConfig {
                motor: smooth,
                ..setup.plant
            },
            ..setup
        })
        .unwrap();
        assert!(bench.run_up(0.5, 5.0));
        bench.set_load_torque(0.63);
        bench.run(Duration::from_millis(1500), |_| {});
        let drag = smooth.drag * 0.5 * std::f64::consts::TAU;
        let expected = ((0.63 + drag) / smooth.holding_torque(3.96)).asin() / std::f64::consts::TAU;
        let mut sum = 0.0;
        bench.run(Duration::from_millis(400), |seen| sum += seen.lag);
        let lag = sum / 8000.0;
        // A tick of the loop and one of the bridge at half a turn a second are 0.0025 periods.
        assert!((lag - expected).abs() < 0.005, "{lag} periods, not {expected}");
    }

    #[test]
    fn too_much_load_takes_the_motor_out_of_step() {
        for motor in [motors::AS1010, QSH5718_56, motors::THREE_PHASE_57] {
            let mut bench = TestBench::enabled(&Setup::of(&motor, 36.0, motor.rated_current)).unwrap();
            assert!(bench.run_up(2.0, 20.0));
            let holding = motor.holding_torque(motor.rated_current);
            bench.set_load_torque(0.5 * holding);
            assert!(bench.stays_in_step(Duration::from_millis(300)));
            bench.set_load_torque(1.2 * holding);
            assert!(!bench.stays_in_step(Duration::from_millis(300)));
        }
    }

    #[test]
    fn the_same_setup_does_the_same_to_the_last_bit() {
        let run = || {
            let mut bench = TestBench::enabled(&Setup::of(&motors::AS1050, 48.0, 5.0)).unwrap();
            bench.run_up(-3.0, 40.0);
            bench.seen()
        };
        assert_eq!(run(), run());
        assert!((run().speed + 3.0).abs() < 1.0);
    }

    #[test]
    fn a_drive_that_does_not_get_enabled_says_why() {
        let refused = TestBench::enabled(&Setup::of(&QSH5718_56, 70.0, 3.0)).unwrap_err();
        assert_eq!(refused.fault, Some(Fault::Overvoltage));
        assert_eq!(refused.to_string(), "the drive reports a fault: Overvoltage, code 3110");
    }
}
