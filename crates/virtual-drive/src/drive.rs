//! One virtual drive: slave controller, device and plant on one time line.

use board::{Actuators, Sensors, TICK};
use device::Device;
use drive::PowerState;
use esc::{Chip, ChipConfig};
use plant::{Plant, PlantConfig};
use wire::Nanos;
use wire::al::{AlState, AlStatusCode};

use crate::flash::{self, Flash};
use crate::indicators::Indicators;
use crate::motor_view::{MotorView, MotorWatch};

/// How far the simulation may fall behind before time is skipped, as after the computer slept: one second of ticks.
const MAX_BEHIND: Nanos = Nanos(1_000_000_000);

/// Which input the pin of each latch unit is wired to: IN1 and IN2, the fast ones (manual 1.3.1).
const LATCH_INPUTS: [usize; 2] = [1, 2];

/// What distinguishes one drive of a segment from the next.
#[derive(Clone, Debug)]
pub struct DriveConfig {
    /// Serial number (0x1018:04).
    pub serial: u32,
    /// Contents of the EEPROM; `None` for those of a new unit.
    pub eeprom: Option<[u8; device::sii::SIZE]>,
    /// Contents of the flash memory for saved parameters; `None` for an erased one, as of a new unit.
    pub parameters: Option<[u8; flash::SIZE]>,
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
            parameters: None,
            clock_offset_ns: 1_234_567 * u64::from(number),
            clock_ppb: 0,
            ports: 2,
            plant: PlantConfig::default(),
        }
    }

    /// A clock that drifts, by an amount of its own within `ppm` parts per million either way: the same at each start, another for each
    /// number of a drive.
    ///
    /// The amounts are spread evenly: steps of the golden ratio never come near one another, however many drives there are.
    pub fn drifting(mut self, position: usize, ppm: f64) -> Self {
        const GOLDEN_RATIO: f64 = 0.618_033_988_749_894_9;
        let place = (position as f64 + 1.0) * GOLDEN_RATIO % 1.0;
        self.clock_ppb = ((2.0 * place - 1.0) * ppm * 1000.0) as i32;
        self
    }
}

/// One drive on the wire.
#[derive(Clone)]
pub struct VirtualDrive {
    config: DriveConfig,
    chip: Chip,
    device: Device,
    memory: Flash,
    plant: Plant,
    sensors: Sensors,
    actuators: Actuators,
    next_tick: Nanos,
    now: Nanos,
    indicators: Indicators,
    motor: MotorWatch,
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
        let mut memory = config.parameters.map_or_else(Flash::erased, Flash::with);
        let plant = Plant::new(config.plant);
        Self {
            sensors: plant.sensors(),
            device: Device::new(config.serial, &mut memory),
            memory,
            actuators: Actuators::default(),
            next_tick: TICK_PERIOD,
            now: Nanos(0),
            indicators: Indicators::new(config.ports),
            motor: MotorWatch::default(),
            resets: chip.resets(),
            config,
            chip,
            plant,
        }
    }

    /// Switches the drive off and on again: everything but the EEPROM, the saved parameters and the place of the axis starts anew.
    pub fn power_cycle(&mut self) {
        self.chip.power_cycle();
        self.restart_device();
    }

    fn restart_device(&mut self) {
        self.device = Device::new(self.config.serial, &mut self.memory);
        self.actuators = Actuators::default();
        self.motor = MotorWatch::default();
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
        self.latch_until(now);
        self.chip.advance(now);
        self.device.poll(&mut self.chip, &mut self.memory, now);
        self.now = self.now.max(now);
        self.light(now);
    }

    /// Shows the latch units the edges up to `now`. The sensors are those of the next tick, so they know them in advance.
    fn latch_until(&mut self, now: Nanos) {
        for (unit, number) in LATCH_INPUTS.into_iter().enumerate() {
            let age = self.sensors.level_ages[number - 1];
            let edge = Nanos(self.next_tick.0.saturating_sub(age.0));
            if edge <= now {
                self.chip.latch(unit, self.sensors.inputs.is_on(number), edge);
            }
        }
    }

    fn tick(&mut self, now: Nanos) {
        self.latch_until(now);
        self.chip.advance(now);
        self.actuators = self.device.tick(&mut self.chip, &mut self.memory, &self.sensors, now);
        self.sensors = self.plant.step(&self.actuators);
        let drive = self.device.drive();
        self.motor.observe(drive.current_vector(), drive.is_shaft_locked(), &self.plant);
        if now.0.is_multiple_of(LED_PERIOD.0) {
            self.light(now);
        }
    }

    fn light(&mut self, now: Nanos) {
        let leds = self.device.leds(&mut self.chip, now);
        self.indicators.update(leds, &self.chip, self.device.drive(), now);
    }

    /// The instant up to which the drive is simulated.
    pub fn now(&self) -> Nanos {
        self.now
    }

    /// The slave controller.
    pub fn chip(&self) -> &Chip {
        &self.chip
    }

    /// Firmware core and slave stack.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// The memory of the saved parameters.
    pub fn memory(&self) -> &Flash {
        &self.memory
    }

    /// The memory of the saved parameters, to break it.
    pub fn memory_mut(&mut self) -> &mut Flash {
        &mut self.memory
    }

    /// Motor, axis and switches.
    pub fn plant(&self) -> &Plant {
        &self.plant
    }

    /// Motor, axis and switches, to put a hand on them.
    pub fn plant_mut(&mut self) -> &mut Plant {
        &mut self.plant
    }

    /// What the next control tick measures.
    pub fn sensors(&self) -> &Sensors {
        &self.sensors
    }

    /// What the last control tick commanded.
    pub fn actuators(&self) -> &Actuators {
        &self.actuators
    }

    /// What only a simulation can see of the motor: where its shaft really is, whether steps were lost, and how near it is to that.
    pub fn motor(&self) -> MotorView {
        self.motor.view(&self.plant)
    }

    /// The LEDs on the drive's front.
    pub fn indicators(&self) -> &Indicators {
        &self.indicators
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
            motor: self.motor(),
            indicators: self.indicators,
        }
    }
}

const TICK_PERIOD: Nanos = Nanos(TICK.0);

/// How often the LEDs are looked after while time passes without a frame.
const LED_PERIOD: Nanos = Nanos(1_000_000);

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
    /// What only a simulation can see.
    pub motor: MotorView,
    /// The LEDs.
    pub indicators: Indicators,
}
