//! A drive and a motor on a bench: bridge with dead times and resistance, current sensors with offsets and a converter of 12 bits.

use board::{Duty, InputLevels, Milliamps, Millivolts, Nanos, PowerStage, Sensors};
use drive::{Drive, DriveObjects, PowerState};
use plant::{MotorParameters, MotorState, Phases};

/// A step of the converter in A: 12 bits over 12.8 A either way.
const STEP: f64 = 25.6 / 4096.0;
/// Resistance of a transistor in ohm.
const TRANSISTOR: f64 = 0.03;

/// Numbers from a seed: splitmix64.
pub struct Random(pub u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ z >> 31
    }

    /// From `low` up to `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// As a normal distribution of deviation 1 has them.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.between(0.0, 1.0)).sum::<f64>() - 6.0
    }
}

pub struct Bench {
    pub drive: Drive,
    pub objects: DriveObjects,
    pub motor: MotorParameters,
    pub state: MotorState,
    /// Voltage of the supply in V.
    pub supply: f64,
    /// Inertia of the load in kg m^2.
    pub load_inertia: f64,
    /// Torque of the load in Nm, against the present motion.
    pub load: f64,
    /// Offsets of both current sensors in A.
    pub offsets: [f64; 2],
    /// Share of the supply that dead times take.
    pub dead: f64,
    /// A winding of two phases, or 2 for V of three, that carries no current.
    pub open: Option<usize>,
    /// Voltages that act in the coming period.
    coming: Option<[f64; 2]>,
    random: Random,
}

impl Bench {
    /// The drive has had its power for 5 ms, and is in OP with the motor's rated current, up to what it can drive.
    pub fn new(motor: MotorParameters, seed: u64) -> Self {
        let mut bench = Self {
            drive: Drive::new(),
            objects: DriveObjects::new(),
            motor,
            state: MotorState::default(),
            supply: 36.0,
            load_inertia: motor.inertia,
            load: 0.0,
            offsets: [0.0; 2],
            dead: 0.008,
            open: None,
            coming: None,
            random: Random(seed),
        };
        bench.objects.peak_current = (motor.rated_current * 1000.0).min(6000.0) as u16;
        bench.objects.motor_type = u16::from(motor.phases == Phases::Three);
        bench.objects.output_2_function = 0;
        bench.drive.set_network(true);
        bench
    }

    /// Goes to Operation Enabled in a mode.
    pub fn enable(&mut self, mode: i8) {
        self.objects.mode = mode;
        for controlword in [0x00, 0x06, 0x07] {
            self.objects.controlword = controlword;
            self.ticks(200);
        }
        self.objects.controlword = 0x0F;
    }

    pub fn ticks(&mut self, count: usize) {
        for _ in 0..count {
            self.tick();
        }
    }

    /// Ticks until `condition` holds; their number, if it happens within a second.
    pub fn until(&mut self, condition: impl Fn(&Self) -> bool) -> Option<usize> {
        (1..=20_000).find(|_| {
            self.tick();
            condition(self)
        })
    }

    /// Goes through the shaft lock.
    pub fn lock(&mut self) {
        self.until(|bench| bench.drive.power_state() == PowerState::OperationEnabled)
            .expect("enabled");
        self.ticks(2_200);
        assert_eq!(self.objects.error_code, 0);
    }

    pub fn tick(&mut self) {
        let sensors = Sensors {
            inputs: InputLevels(0),
            level_ages: [Nanos(0); 6],
            bus_voltage: Millivolts((self.supply * 1000.0) as i32),
            phase_currents: self.measured(),
        };
        let stage = self.drive.tick(&sensors, &mut self.objects).stage;
        let voltages = match stage {
            PowerStage::Legs(duties) => {
                let voltages = self.voltages(duties);
                self.coming.replace(voltages).unwrap_or([0.0; 2])
            }
            _ => {
                self.coming = None;
                self.state.currents = [0.0; 2];
                [0.0; 2]
            }
        };
        self.step(voltages);
        if stage == PowerStage::Off {
            self.state.currents = [0.0; 2];
        }
    }

    /// The voltages over the windings, before what the bridge takes.
    fn voltages(&self, duties: [Duty; 4]) -> [f64; 2] {
        let [u, v, w, x] = duties.map(|duty| f64::from(duty.0) / 65_536.0 * self.supply);
        match self.motor.phases {
            Phases::Two => [u - v, w - x],
            Phases::Three => [(2.0 * u - v - w) / 3.0, (v - w) / 3f64.sqrt()],
        }
    }

    fn step(&mut self, [a, b]: [f64; 2]) {
        let lost = |current: f64, transistors: f64| {
            let dead = self.dead * self.supply / 2.0 * (current / 0.02).clamp(-1.0, 1.0);
            transistors * (dead + TRANSISTOR * current)
        };
        let [ia, ib] = self.state.currents;
        let half = 0.75f64.sqrt();
        let voltages = match self.motor.phases {
            Phases::Two => [a - lost(ia, 2.0), b - lost(ib, 2.0)],
            Phases::Three => {
                let [u, v, w] = [ia, -ia / 2.0 + half * ib, -ia / 2.0 - half * ib].map(|current| lost(current, 1.0));
                [a - (2.0 * u - v - w) / 3.0, b - (v - w) / 3f64.sqrt()]
            }
        };
        let load = if self.state.speed < 0.0 { -self.load } else { self.load };
        self.state = self.motor.step(self.state, voltages, load, self.load_inertia);
        let currents = &mut self.state.currents;
        match self.open {
            Some(2) => {
                // Without V, what flows is along the axis between U and W.
                let along = (currents[0] * half - currents[1] / 2.0) * half;
                *currents = [along, -along * 0.5 / half];
                *currents = [currents[0], currents[0] / 3f64.sqrt()];
            }
            Some(winding) => currents[winding] = 0.0,
            None => (),
        }
    }

    fn measured(&mut self) -> [Milliamps; 2] {
        let [a, b] = self.state.currents;
        let currents = match self.motor.phases {
            Phases::Two => [a, b],
            Phases::Three => [a, -a / 2.0 - 0.75f64.sqrt() * b],
        };
        [0, 1].map(|phase| {
            let steps = ((currents[phase] + self.offsets[phase]) / STEP + 1.5 * self.random.normal()).round();
            Milliamps((steps * STEP * 1000.0).round() as i32)
        })
    }
}
