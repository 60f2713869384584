//! A drive on a test rig: objects, network, supply, and switches that the shaft meets.
#![allow(dead_code, reason = "every test file uses a part of the rig")]

use board::{Actuators, INPUT_COUNT, InputLevels, Milliamps, Millivolts, Nanos, PowerStage, Sensors};
use dictionary::{AbortCode, Objects};
use drive::{CurrentVector, Drive, DriveObjects, PowerState};

/// Pulses of one electrical period at the default resolution: 10 000 pulses and 50 periods a turn.
const PULSES_PER_PERIOD: f64 = 200.0;

pub const IN_POSITIVE_LIMIT: u8 = 1 << 2;
pub const IN_NEGATIVE_LIMIT: u8 = 1 << 3;
pub const IN_HOME: u8 = 1 << 4;
pub const IN_OFFLINE: u8 = 1 << 5;

/// Where the switches are on in shaft pulses, as half-open ranges.
#[derive(Clone, Debug)]
pub struct Travel {
    pub negative_limit_below: f64,
    pub positive_limit_from: f64,
    pub home: std::ops::Range<f64>,
}

#[derive(Clone)]
pub struct Rig {
    pub drive: Drive,
    pub objects: DriveObjects,
    /// Inputs set by hand, beside those of the travel's switches.
    pub inputs: u8,
    /// How long before the next tick inputs took their level.
    pub level_ages: [Nanos; INPUT_COUNT],
    pub bus: Millivolts,
    /// What the current sensors read, if not the currents of an ideal motor.
    pub readings: Option<[Milliamps; 2]>,
    pub travel: Option<Travel>,
    /// The shaft, which follows the field, in pulses.
    pub shaft: f64,
    pub actuators: Actuators,
    angle: u32,
}

impl Rig {
    /// A drive in OP, one tick after power-up, without motion filter and input filter, and without brake.
    pub fn new() -> Self {
        let mut rig = Self::at_power_up();
        rig.objects.filter_time = 0;
        rig.objects.input_filter = 0;
        rig.objects.soft_lock_time = 0;
        rig.drive.set_network(true);
        rig.tick();
        rig
    }

    /// A drive before its first tick, with default objects but for the brake on OUT2, which would delay most changes of state.
    pub fn at_power_up() -> Self {
        let mut objects = DriveObjects::new();
        objects.output_2_function = 0;
        // The rig has no windings to identify.
        objects.auto_pi = 0;
        Self {
            drive: Drive::new(),
            objects,
            inputs: 0,
            level_ages: [Nanos(0); INPUT_COUNT],
            bus: Millivolts(24_000),
            readings: None,
            travel: None,
            shaft: 0.0,
            actuators: Actuators::default(),
            angle: 0,
        }
    }

    /// A drive in Operation Enabled in a mode.
    pub fn enabled(mode: i8) -> Self {
        let mut rig = Self::new();
        rig.objects.mode = mode;
        rig.enable();
        rig
    }

    pub fn enable(&mut self) {
        self.command(0x06);
        self.command(0x0F);
        self.tick();
        assert_eq!(self.state(), PowerState::OperationEnabled);
    }

    pub fn tick(&mut self) {
        let sensors = Sensors {
            inputs: InputLevels(self.inputs | self.switches()),
            level_ages: self.level_ages,
            bus_voltage: self.bus,
            phase_currents: self.readings.unwrap_or_else(|| self.phase_currents()),
        };
        self.actuators = self.drive.tick(&sensors, &mut self.objects);
        if let Some(CurrentVector { angle, .. }) = self.drive.current_vector() {
            self.shaft += f64::from(angle.0.wrapping_sub(self.angle) as i32) / 2f64.powi(32) * PULSES_PER_PERIOD;
            self.angle = angle.0;
        }
    }

    pub fn ticks(&mut self, count: usize) {
        for _ in 0..count {
            self.tick();
        }
    }

    pub fn milliseconds(&mut self, count: usize) {
        self.ticks(count * 20);
    }

    /// Writes the controlword and lets a tick see it.
    pub fn command(&mut self, controlword: u16) {
        self.objects.controlword = controlword;
        self.tick();
    }

    /// Ticks at least once, until `condition` holds; the number of ticks it took.
    pub fn until(&mut self, what: &str, condition: impl Fn(&Self) -> bool) -> usize {
        for count in 1..4_000_000 {
            self.tick();
            if condition(self) {
                return count;
            }
        }
        panic!(
            "never {what}: statusword {:04X}, position {}",
            self.objects.statusword, self.objects.position
        );
    }

    /// One bus cycle of CSP: synchronisation, then the ticks of the cycle.
    pub fn cycle(&mut self, target: i32, cycle: Nanos) {
        self.objects.target_position = target;
        self.drive.synchronize(&self.objects, Some(cycle));
        self.ticks((cycle.0 / board::TICK.0) as usize);
    }

    pub fn state(&self) -> PowerState {
        self.drive.power_state()
    }

    pub fn status(&self, bit: u8) -> bool {
        self.objects.statusword >> bit & 1 == 1
    }

    /// Bits 13, 12 and 10 of the statusword.
    pub fn homing_bits(&self) -> (bool, bool, bool) {
        (self.status(13), self.status(12), self.status(10))
    }

    pub fn pulses_per_second(&self) -> i32 {
        self.drive.velocity().pulses_per_second()
    }

    pub fn is_powered(&self) -> bool {
        self.actuators.stage != PowerStage::Off
    }

    pub fn amplitude(&self) -> Option<i32> {
        self.drive.current_vector().map(|vector| vector.amplitude.0)
    }

    /// A download as the device does it: the drive's veto first, then the table's checks.
    pub fn download(&mut self, index: u16, sub: u8, data: &[u8]) -> Result<(), AbortCode> {
        let slot = slot(index, sub);
        self.drive.check_write(&self.objects, slot, data)?;
        self.objects.store(slot, data)
    }

    /// Currents as an ideal motor has them: those that the last tick has commanded.
    fn phase_currents(&self) -> [Milliamps; 2] {
        let Some(CurrentVector { angle, amplitude }) = self.drive.current_vector() else {
            return [Milliamps(0); 2];
        };
        let radians = f64::from(angle.0) / 2f64.powi(32) * std::f64::consts::TAU;
        [radians.cos(), radians.sin()].map(|part| Milliamps((f64::from(amplitude.0) * part).round() as i32))
    }

    fn switches(&self) -> u8 {
        let Some(travel) = &self.travel else { return 0 };
        let mut on = 0;
        if self.shaft < travel.negative_limit_below {
            on |= IN_NEGATIVE_LIMIT;
        }
        if self.shaft >= travel.positive_limit_from {
            on |= IN_POSITIVE_LIMIT;
        }
        if travel.home.contains(&self.shaft) {
            on |= IN_HOME;
        }
        on
    }
}

pub fn slot(index: u16, sub: u8) -> usize {
    DriveObjects::ENTRIES
        .iter()
        .position(|entry| (entry.index, entry.sub) == (index, sub))
        .unwrap_or_else(|| panic!("no object {index:04X}:{sub}"))
}
