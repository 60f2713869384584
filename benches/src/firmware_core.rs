//! The firmware core before a plant, with everything on that costs time.

use board::{Actuators, InputLevels, Nanos, Sensors};
use drive::{Drive, DriveObjects, PowerState};
use plant::{Plant, PlantConfig};
use usr2556e::master::process_data::towards_enabled;

/// Bits 4 and 5, 12 and 13 of 0x60B8: both probes on both edges; with bit 1, as the manual's first step sets it.
const PROBES_ON: u16 = 0x3333;
/// Ticks after which the probes are armed anew, so that they go on latching.
const PROBES_EVERY: u64 = 64;

/// OUT2 as its transistor conducts: the brake is open.
const BRAKE: u8 = 1 << 1;

/// Ticks that a drive may take until its brake opens: 1 s.
const PATIENCE: u32 = 20_000;

/// Drive, objects and what hangs on the terminals; [`Core::step`] is a tick of them.
#[derive(Clone, Debug)]
pub struct Core {
    /// The firmware core.
    pub drive: Drive,
    /// Its objects.
    pub objects: DriveObjects,
    /// Motor, axis, switches and supply.
    pub plant: Plant,
    /// A set-point of CSP begins with the next tick, for this cycle.
    pub set_point: Option<Nanos>,
    /// Whether ticks go through [`counted_tick`].
    pub counted: bool,
    /// What the last tick has commanded.
    pub actuators: Actuators,
    sensors: Sensors,
    ticks: u64,
}

/// A control tick by whose name a count of instructions finds it.
#[inline(never)]
pub fn counted_tick(drive: &mut Drive, sensors: &Sensors, objects: &mut DriveObjects, set_point: Option<Nanos>) -> Actuators {
    tick(drive, sensors, objects, set_point)
}

/// The control tick as the device makes it: [`Drive::tick`] and, where a set-point begins, [`Drive::synchronize`].
fn tick(drive: &mut Drive, sensors: &Sensors, objects: &mut DriveObjects, set_point: Option<Nanos>) -> Actuators {
    let actuators = drive.tick(sensors, objects);
    if set_point.is_some() {
        drive.synchronize(objects, set_point);
    }
    actuators
}

impl Core {
    /// A drive at power-up, in OP: the longest motion filter, functions and filters on all inputs and outputs, both touch probes, a brake
    /// and anti-vibration.
    pub fn new(plant: PlantConfig) -> Self {
        let mut drive = Drive::new();
        drive.set_network(true);
        let plant = Plant::new(plant);
        Self {
            drive,
            objects: everything_on(),
            sensors: plant.sensors(),
            plant,
            set_point: None,
            counted: false,
            actuators: Actuators::default(),
            ticks: 0,
        }
    }

    /// One tick.
    pub fn step(&mut self) {
        if self.ticks.is_multiple_of(PROBES_EVERY) {
            self.objects.probe_function ^= PROBES_ON;
        } else if self.objects.probe_function == 0 {
            self.objects.probe_function = PROBES_ON;
        }
        self.ticks += 1;
        let set_point = self.set_point.take();
        let tick = if self.counted { counted_tick } else { tick };
        self.actuators = tick(&mut self.drive, &self.sensors, &mut self.objects, set_point);
        self.sensors = self.plant.step(&self.actuators);
    }

    /// One tick whose master leads the drive to Operation Enabled.
    pub fn step_towards_enabled(&mut self) {
        self.objects.controlword = towards_enabled(self.objects.statusword, self.objects.controlword);
        self.step();
    }

    /// Enables the drive in a mode, until its brake has opened.
    ///
    /// # Panics
    /// The drive does not get there, with its statusword.
    pub fn enable(&mut self, mode: i8) {
        self.objects.mode = mode;
        let enabled = (0..PATIENCE).any(|_| {
            self.step_towards_enabled();
            self.is_ready()
        });
        assert!(enabled, "not enabled: statusword {:04X}", self.objects.statusword);
    }

    /// Whether the drive is in Operation Enabled and its brake is open.
    pub fn is_ready(&self) -> bool {
        self.drive.power_state() == PowerState::OperationEnabled && self.plant.outputs().0 & BRAKE != 0
    }

    /// Switches input terminals on by hand: bit 0 is IN1.
    pub fn hold(&mut self, inputs: u8) {
        self.plant.hold_inputs(InputLevels(inputs));
    }
}

fn everything_on() -> DriveObjects {
    let mut objects = DriveObjects::new();
    objects.filter_time = 25_600;
    objects.harmonic_amplitude = 100;
    objects.harmonic_phase_a = 256;
    objects.harmonic_phase_b = 512;
    // Probe 1, probe 2, the three switches of the axis, emergency stop.
    objects.input_1_function = 7;
    objects.input_2_function = 8;
    objects.input_3_function = 1;
    objects.input_4_function = 2;
    objects.input_5_function = 3;
    objects.input_6_function = 5;
    // In place, and the brake.
    objects.output_1_function = 3;
    objects.output_2_function = 2;
    objects
}
