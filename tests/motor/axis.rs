//! A drive and a motor, with nothing but a bridge and a supply without losses between them.

use board::{Millivolts, Sensors};
use drive::{Drive, DriveObjects, PowerState};
use plant::{BridgeParameters, Faults, Load, MotorParameters, MotorState, Phases, Plant, PlantConfig, SupplyParameters, Travel, Turns};
use usr2556e::synchronism::Synchronism;

const PULSES_PER_TURN: f64 = 10_000.0;
/// No switch and no stop is as far away.
const FAR: Turns = Turns(1e6);

pub struct Axis {
    pub drive: Drive,
    pub objects: DriveObjects,
    pub motor: MotorParameters,
    pub plant: Plant,
    sensors: Sensors,
    /// Torque in Nm against positive motion.
    pub load: f64,
    synchronism: Synchronism,
}

impl Axis {
    /// A motor at rest that turns its own inertia once more, and a drive with the gains of that motor and its rated current, or what the drive
    /// can give.
    pub fn new(motor: MotorParameters, supply: f64) -> Self {
        Self::with_inertia(motor, supply, motor.inertia)
    }

    /// The same with another load, in kg m^2.
    pub fn with_inertia(motor: MotorParameters, supply: f64, inertia: f64) -> Self {
        let mut objects = DriveObjects::new();
        objects.output_2_function = 0;
        objects.filter_time = 0;
        objects.soft_lock_time = 100;
        objects.auto_pi = 0;
        objects.peak_current = (motor.rated_current * 1000.0).min(6_000.0) as u16;
        objects.current_loop_kp = (motor.inductance * 1e6).round() as u16;
        objects.current_loop_ki = (motor.resistance * 200.0).round() as u16;
        objects.resistance_set = (motor.resistance * 1000.0).round() as u16;
        objects.motor_type = u16::from(motor.phases == Phases::Three);
        objects.mode = 3;
        let mut drive = Drive::new();
        drive.set_network(true);
        let plant = Plant::new(lossless(motor, supply, inertia));
        Self {
            drive,
            objects,
            motor,
            sensors: plant.sensors(),
            plant,
            load: 0.0,
            synchronism: Synchronism::default(),
        }
    }

    /// Holds the rotor.
    pub fn block(&mut self) {
        self.plant.set_faults(Faults {
            stuck_rotor: true,
            ..Faults::default()
        });
    }

    /// Brings the drive to Operation Enabled and through its shaft lock.
    pub fn enable(&mut self) {
        self.try_to_enable();
        assert_eq!(self.drive.power_state(), PowerState::OperationEnabled);
    }

    /// As [`Axis::enable`], but the drive may meet a fault.
    pub fn try_to_enable(&mut self) {
        for controlword in [0, 0x06, 0x0F] {
            self.objects.controlword = controlword;
            self.tick();
        }
        self.ticks(2 * usize::from(self.objects.soft_lock_time) + 10);
    }

    pub fn tick(&mut self) {
        let actuators = self.drive.tick(&self.sensors, &mut self.objects);
        if self.load != self.plant.config().load.torque {
            self.plant.set_load_torque(self.load);
        }
        self.sensors = self.plant.step(&actuators);
        let locked = self.drive.is_shaft_locked();
        self.synchronism.observe(self.drive.current_vector(), locked, self.plant.shaft());
    }

    pub fn ticks(&mut self, count: usize) {
        (0..count).for_each(|_| self.tick());
    }

    pub fn seconds(&mut self, seconds: f64) {
        self.ticks((seconds / (board::TICK.0 as f64 * 1e-9)).round() as usize);
    }

    /// Accelerates to a speed in turns a second with a ramp in turns a second, each second.
    pub fn run_at(&mut self, speed: f64, ramp: f64) {
        self.ramp_to(speed, ramp);
        let wanted = (speed * PULSES_PER_TURN) as i32;
        while self.drive.velocity().pulses_per_second() != wanted {
            self.tick();
        }
    }

    /// Commands a speed and lets the drive go there.
    pub fn ramp_to(&mut self, speed: f64, ramp: f64) {
        self.objects.target_velocity = (speed * PULSES_PER_TURN) as i32;
        self.objects.profile_acceleration = (ramp * PULSES_PER_TURN) as i32;
        self.objects.profile_deceleration = (ramp * PULSES_PER_TURN) as i32;
    }

    /// Electrical periods by which the shaft is behind the command.
    pub fn lag(&self) -> f64 {
        self.synchronism.behind()
    }

    /// Whether the shaft is still in the electrical period it belongs to.
    pub fn is_in_sync(&self) -> bool {
        self.lag().abs() < 0.75
    }

    /// Currents, speed and angle of the motor.
    pub fn state(&self) -> MotorState {
        self.plant.motor()
    }

    /// The amplitude of the current vector in ampere.
    pub fn current(&self) -> f64 {
        let [a, b] = self.state().currents;
        a.hypot(b)
    }
}

/// A motor on a free axis, with a bridge and a supply that lose nothing.
fn lossless(motor: MotorParameters, supply: f64, inertia: f64) -> PlantConfig {
    let defaults = PlantConfig::default();
    PlantConfig {
        travel: Travel {
            negative_limit: Turns(-FAR.0),
            positive_limit: FAR,
            home: (FAR, FAR),
            stops: (Turns(-FAR.0), FAR),
        },
        supply: Millivolts((supply * 1000.0) as i32),
        source: SupplyParameters {
            impedance: 1e-3,
            consumption: 0.0,
            capacitance: 1.0,
        },
        bridge: BridgeParameters {
            on_resistance: 0.0,
            dead_time: 0.0,
            ..defaults.bridge
        },
        motor,
        load: Load::inertia(inertia),
        ..defaults
    }
}
