//! A drive and a motor, with nothing but a stiff supply between them.

use board::{Actuators, Duty, LEG_COUNT, Milliamps, Millivolts, PowerStage, Sensors};
use drive::{CurrentVector, Drive, DriveObjects, PowerState};
use plant::{MotorParameters, MotorState, Phases};

const SQRT_3: f64 = 1.732_050_807_568_877_2;
const PULSES_PER_TURN: f64 = 10_000.0;

pub struct Axis {
    pub drive: Drive,
    pub objects: DriveObjects,
    pub motor: MotorParameters,
    pub state: MotorState,
    /// Supply in volt.
    pub supply: f64,
    /// Torque in Nm against positive motion.
    pub load: f64,
    /// Inertia of the load in kg m^2.
    pub load_inertia: f64,
    /// A rotor that is held.
    pub blocked: bool,
    /// Where the drive has commanded the shaft to be, in turns.
    pub commanded: f64,
    duties: Option<[Duty; LEG_COUNT]>,
    angle: Option<u32>,
}

impl Axis {
    /// A motor at rest, and a drive with the gains of that motor and its rated current, or what the drive can give.
    pub fn new(motor: MotorParameters, supply: f64) -> Self {
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
        Self {
            drive,
            objects,
            motor,
            state: MotorState::default(),
            supply,
            load: 0.0,
            load_inertia: motor.inertia,
            blocked: false,
            commanded: 0.0,
            duties: None,
            angle: None,
        }
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
        let currents = self.leg_currents();
        let sensors = Sensors {
            bus_voltage: Millivolts((self.supply * 1000.0) as i32),
            phase_currents: currents.map(|ampere| Milliamps((ampere * 1000.0).round() as i32)),
            ..Sensors::default()
        };
        let actuators = self.drive.tick(&sensors, &mut self.objects);
        let voltages = self.voltages(&actuators);
        let before = self.state;
        self.state = self.motor.step(before, voltages, self.load, self.load_inertia);
        if self.blocked {
            (self.state.turns, self.state.speed) = (before.turns, 0.0);
        }
        if let Some(CurrentVector { angle, .. }) = self.drive.current_vector() {
            let before = self.angle.replace(angle.0).unwrap_or(angle.0);
            self.commanded += f64::from(angle.0.wrapping_sub(before) as i32) / 2f64.powi(32) / 50.0;
        }
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
        (self.commanded - self.state.turns) * 50.0
    }

    /// Whether the shaft is still in the electrical period it belongs to.
    pub fn is_in_sync(&self) -> bool {
        self.lag().abs() < 0.75
    }

    /// The amplitude of the measured current vector in ampere.
    pub fn current(&self) -> f64 {
        self.state.currents[0].hypot(self.state.currents[1])
    }

    fn voltages(&mut self, actuators: &Actuators) -> [f64; 2] {
        let next = match actuators.stage {
            PowerStage::Legs(duties) => Some(duties),
            _ => None,
        };
        let Some(duties) = core::mem::replace(&mut self.duties, next) else {
            return [0.0; 2];
        };
        let [u, v, w, x] = duties.map(|duty| f64::from(duty.0) / 65_536.0 * self.supply);
        match self.motor.phases {
            Phases::Two => [u - v, w - x],
            Phases::Three => [(2.0 * u - v - w) / 3.0, (v - w) / SQRT_3],
        }
    }

    fn leg_currents(&self) -> [f64; 2] {
        let [a, b] = self.state.currents;
        match self.motor.phases {
            Phases::Two => [a, b],
            Phases::Three => [a, -a / 2.0 - SQRT_3 / 2.0 * b],
        }
    }
}
