//! One virtual drive: slave controller, device and plant on one time line.

use board::{Actuators, Sensors, TICK};
use device::Device;
use drive::PowerState;
use esc::{Chip, ChipConfig};
use plant::{Plant, PlantConfig, Turns};
use wire::Nanos;
use wire::al::{AlState, AlStatusCode};

/// How far the simulation may fall behind before time is skipped, as after the computer slept: one second of ticks.
const MAX_BEHIND: Nanos = Nanos(1_000_000_000);

/// What distinguishes one drive of a segment from the next.
#[derive(Clone, Debug)]
pub struct DriveConfig {
    /// Serial number (0x1018:04).
    pub serial: u32,
    /// Contents of the EEPROM; `None` for those of a new unit.
    pub eeprom: Option<[u8; device::sii::SIZE]>,
    /// What the slave controller's local clock shows at power-on, in ns.
    pub clock_offset_ns: u64,
    /// How much the slave controller's clock runs too fast, in parts per billion.
    pub clock_ppb: i32,
    /// EtherCAT ports of the slave controller, 1 to 4: the USR2556E has two; with three or four, it is a junction.
    pub ports: usize,
    /// Motor, axis, switches and supply.
    pub plant: PlantConfig,
}

impl DriveConfig {
    /// Drive number `position`, counted from 0, of a segment: serial numbers count up and local clocks differ, as those of real units do.
    pub fn numbered(position: usize) -> Self {
        let number = position as u32 + 1;
        Self {
            serial: number,
            eeprom: None,
            clock_offset_ns: 1_234_567 * u64::from(number),
            clock_ppb: 0,
            ports: 2,
            plant: PlantConfig::default(),
        }
    }
}

/// One drive on the wire.
#[derive(Clone)]
pub struct VirtualDrive {
    config: DriveConfig,
    chip: Chip,
    device: Device,
    plant: Plant,
    sensors: Sensors,
    actuators: Actuators,
    next_tick: Nanos,
    /// The slave controller's resets that the device has followed.
    resets: u32,
}

impl VirtualDrive {
    /// A drive just switched on, at instant 0.
    pub fn new(config: DriveConfig) -> Self {
        let eeprom = config.eeprom.unwrap_or_else(|| device::sii::image(config.serial, 0));
        let chip = ChipConfig {
            eeprom,
            clock_offset_ns: config.clock_offset_ns,
            clock_ppb: config.clock_ppb,
        };
        let chip = Chip::with_ports(chip, config.ports);
        let plant = Plant::new(config.plant);
        Self {
            sensors: plant.sensors(),
            device: Device::new(config.serial),
            actuators: Actuators::default(),
            next_tick: TICK_PERIOD,
            resets: chip.resets(),
            config,
            chip,
            plant,
        }
    }

    /// Switches the drive off and on again: everything but EEPROM and the place of the axis starts anew.
    pub fn power_cycle(&mut self) {
        self.chip.power_cycle();
        self.restart_device();
    }

    fn restart_device(&mut self) {
        self.device = Device::new(self.config.serial);
        self.actuators = Actuators::default();
    }

    /// Simulates up to `now`: every control tick on the way, then what the master has asked since the last of them.
    ///
    /// When the slave controller has been reset by register (0x0040), its reset pin has restarted the processor with it.
    pub fn catch_up(&mut self, now: Nanos) {
        if self.chip.resets() != self.resets {
            self.resets = self.chip.resets();
            self.restart_device();
        }
        if now.since(self.next_tick) > MAX_BEHIND.0 {
            let ticks = (now.since(self.next_tick) - MAX_BEHIND.0) / TICK_PERIOD.0;
            self.next_tick.0 += ticks * TICK_PERIOD.0;
        }
        while self.next_tick <= now {
            self.tick(self.next_tick);
            self.next_tick.0 += TICK_PERIOD.0;
        }
        self.chip.advance(now);
        self.device.poll(&mut self.chip, now);
    }

    fn tick(&mut self, now: Nanos) {
        self.chip.advance(now);
        self.actuators = self.device.tick(&mut self.chip, &self.sensors, now);
        self.sensors = self.plant.step(&self.actuators);
    }

    /// The slave controller.
    pub fn chip(&self) -> &Chip {
        &self.chip
    }

    /// Firmware core and slave stack.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// Motor, axis and switches.
    pub fn plant(&self) -> &Plant {
        &self.plant
    }

    /// Motor, axis and switches, to put a hand on them.
    pub fn plant_mut(&mut self) -> &mut Plant {
        &mut self.plant
    }

    /// What a status line shows.
    pub fn status(&self) -> DriveStatus {
        let objects = self.device.objects();
        DriveStatus {
            al_state: self.device.slave().state(),
            al_status_code: self.device.slave().status_code(),
            power_state: self.device.drive().power_state(),
            mode: objects.mode_display,
            statusword: objects.statusword,
            error_code: objects.error_code,
            position: objects.position,
            velocity_rpm: objects.velocity,
            shaft: self.plant.shaft(),
        }
    }
}

const TICK_PERIOD: Nanos = Nanos(TICK.0);

impl AsMut<Chip> for VirtualDrive {
    fn as_mut(&mut self) -> &mut Chip {
        &mut self.chip
    }
}

/// A drive at a glance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveStatus {
    /// State of the EtherCAT state machine.
    pub al_state: AlState,
    /// Why the last state was refused or left.
    pub al_status_code: AlStatusCode,
    /// State of the CiA 402 power state machine.
    pub power_state: PowerState,
    /// 0x6061.
    pub mode: i8,
    /// 0x6041.
    pub statusword: u16,
    /// 0x603F.
    pub error_code: u16,
    /// 0x6064 in pulses.
    pub position: i32,
    /// 0x606C in rpm.
    pub velocity_rpm: i32,
    /// Where the shaft really is.
    pub shaft: Turns,
}
