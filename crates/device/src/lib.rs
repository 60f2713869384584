//! One USR2556E: firmware core and EtherCAT slave stack joined.
//!
//! | module | holds |
//! |---|---|
//! | [`identity`] | names and numbers: the one table behind 0x1018, SII and ESI |
//! | [`layout`] | sync managers, FMMUs, default PDOs, clock modes, time-outs |
//! | [`sii`] | the EEPROM image made from both |
//! | [`parameter_file`] | saved parameters as a file: backup and restore |
//! | `application` | what the slave stack asks of the drive |
//! | `parameter_set` | the saved parameters as bytes |
//! | `parameter_store` | the flash that keeps them, whatever happens to the power |
//! | `flash` | flash memories: none at all, and those that are complete when they return |
//! | `site_address` | where the station alias comes from |
//!
//! [`Device`] runs over any slave controller: the chip in software on a PC, the real one on a board; and over any flash memory that
//! implements [`nor_flash::NorFlash`], or [`NoMemory`].
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod application;
mod flash;
pub mod identity;
pub mod layout;
pub mod parameter_file;
mod parameter_set;
mod parameter_store;
pub mod sii;
mod site_address;

use application::Application;
use board::{Actuators, Sensors};
use dictionary::AbortCode;
use drive::{Drive, DriveObjects};
/// What a memory for parameters implements.
pub use embedded_storage::nor_flash;
pub use flash::NoMemory;
use nor_flash::NorFlash;
use parameter_file::ParameterFile;
use site_address::SiteAddress;
pub use slave::MAX_OBJECT_SIZE;
use slave::{Configuration, Identity, Leds, MailboxLimits, Slave, Sync};
use wire::al::AlState;
use wire::{EscAccess, Nanos};

/// One drive without its slave controller, its power stage and the memory for its parameters.
///
/// The memory is used as a whole: at least four erasable pages of 1 KiB or more, for the parameters alone. It is read at power-on. It is
/// written only when the master saves or restores parameters, at standstill; [`Device::tick`] or [`Device::poll`] then lasts as long as
/// the flash takes to write half a kilobyte and now and then to erase a page, and the power stage has to hold its last command meanwhile.
#[derive(Clone, Debug)]
pub struct Device {
    slave: Slave,
    drive: Drive,
    objects: DriveObjects,
    site_address: SiteAddress,
    parameter_file: ParameterFile,
}

impl Device {
    /// A device just switched on, with the parameters that `memory` holds. If that is damaged, it has those of delivery and fault 0x5530.
    pub fn new(serial: u32, memory: &mut impl NorFlash) -> Self {
        let mut drive = Drive::new();
        let objects = parameter_store::load(memory).unwrap_or_else(|parameter_store::Damaged| {
            drive.parameters_lost();
            DriveObjects::new()
        });
        Self {
            slave: Slave::new(configuration(serial)),
            drive,
            objects,
            site_address: SiteAddress::default(),
            parameter_file: ParameterFile::new(),
        }
    }

    /// One control tick, every 50 us: bus events, motion, process data for the master.
    pub fn tick(&mut self, esc: &mut impl EscAccess, memory: &mut impl NorFlash, sensors: &Sensors, now: Nanos) -> Actuators {
        let sync = self.exchange(esc, memory, now);
        let actuators = self.drive.tick(sensors, &mut self.objects);
        // The tick has brought motion up to this instant, at which a new set-point begins: what is published is the end of the old one.
        self.synchronize(sync);
        let application = Application {
            drive: &self.drive,
            objects: &mut self.objects,
            memory,
            parameter_file: &mut self.parameter_file,
        };
        self.slave.publish_inputs(esc, &application, now);
        actuators
    }

    /// Answers what the master has asked between two ticks, so that states and mailboxes do not wait for the next one.
    pub fn poll(&mut self, esc: &mut impl EscAccess, memory: &mut impl NorFlash, now: Nanos) {
        let sync = self.exchange(esc, memory, now);
        self.synchronize(sync);
    }

    /// Bus events and process data. Returns whether outputs have taken effect.
    fn exchange(&mut self, esc: &mut impl EscAccess, memory: &mut impl NorFlash, now: Nanos) -> Option<Sync> {
        self.site_address.settle(esc, &mut self.objects);
        let mut application = Application {
            drive: &self.drive,
            objects: &mut self.objects,
            memory,
            parameter_file: &mut self.parameter_file,
        };
        let report = self.slave.poll(esc, &mut application, now);
        self.drive.set_network(report.state == AlState::Op);
        report.sync
    }

    fn synchronize(&mut self, sync: Option<Sync>) {
        if let Some(sync) = sync {
            let cycle = sync.cycle.map(|nanoseconds| board::Nanos(nanoseconds.into()));
            self.drive.synchronize(&self.objects, cycle);
        }
    }

    /// Reads any object, as an SDO upload would, and returns its length in bytes.
    ///
    /// # Errors
    /// The abort code that the upload would end with.
    pub fn read_object(&mut self, index: u16, sub: u8, now: Nanos, out: &mut [u8]) -> Result<usize, AbortCode> {
        let application = Application {
            drive: &self.drive,
            objects: &mut self.objects,
            memory: &mut NoMemory,
            parameter_file: &mut self.parameter_file,
        };
        self.slave.read_object(&application, index, sub, now, out)
    }

    /// RUN and ERR LED, see [`Slave::leds`]; the alarm LED is [`Drive::alarm_light`].
    pub fn leds(&mut self, esc: &mut impl EscAccess, now: Nanos) -> Leds {
        self.slave.leds(esc, now)
    }

    /// The slave stack.
    pub fn slave(&self) -> &Slave {
        &self.slave
    }

    /// The firmware core.
    pub fn drive(&self) -> &Drive {
        &self.drive
    }

    /// The drive's objects.
    pub fn objects(&self) -> &DriveObjects {
        &self.objects
    }
}

/// PDO mappings at delivery, as the slave stack takes them.
const MAPPINGS: [(u16, &[u32]); 6] = {
    let mut mappings: [(u16, &[u32]); 6] = [(0, &[]); 6];
    let mut i = 0;
    while i < 3 {
        mappings[i] = (layout::RX_PDOS[i].index, layout::RX_PDOS[i].entries);
        mappings[i + 3] = (layout::TX_PDOS[i].index, layout::TX_PDOS[i].entries);
        i += 1;
    }
    mappings
};

/// An event of synchronisation waits for the next control tick at the most.
const REACTION_NS: u32 = board::TICK.0 as u32;

/// What makes the slave stack a USR2556E.
fn configuration(serial: u32) -> Configuration {
    Configuration {
        device_type: identity::DEVICE_TYPE,
        device_name: identity::DEVICE_NAME,
        hardware_version: identity::HARDWARE_VERSION,
        software_version: identity::SOFTWARE_VERSION,
        identity: Identity {
            vendor: identity::VENDOR,
            product: identity::PRODUCT,
            revision: identity::REVISION,
            serial,
        },
        mailbox: MailboxLimits {
            min: layout::MAILBOX_MIN,
            max: layout::MAILBOX_MAX,
            window: layout::MAILBOX_WINDOW,
        },
        process_window: layout::PROCESS_DATA_WINDOW,
        minimum_cycle_ns: layout::MINIMUM_CYCLE_NS,
        reaction_ns: REACTION_NS,
        op_timeout_ms: layout::TIMEOUTS.op_ms,
        mappings: &MAPPINGS,
        rx_assignment: &layout::RX_ASSIGNMENT,
        tx_assignment: &layout::TX_ASSIGNMENT,
    }
}
