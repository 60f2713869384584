//! One USR2556E: firmware core and EtherCAT slave stack joined.
//!
//! | module | holds |
//! |---|---|
//! | [`identity`] | names and numbers: the one table behind 0x1018, SII and ESI |
//! | [`layout`] | sync managers, FMMUs, default PDOs and clock modes |
//! | [`sii`] | the EEPROM image made from both |
//! | `application` | what the slave stack asks of the drive |
//!
//! [`Device`] runs over any slave controller: the chip in software on a PC, the real one on a board.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod application;
pub mod identity;
pub mod layout;
pub mod sii;

use application::Application;
use board::{Actuators, Sensors};
use dictionary::AbortCode;
use drive::{Drive, DriveObjects};
pub use slave::MAX_OBJECT_SIZE;
use slave::{Configuration, Identity, MailboxLimits, Slave, Sync};
use wire::al::AlState;
use wire::{EscAccess, Nanos};

/// One drive without its slave controller and its power stage.
#[derive(Clone, Debug)]
pub struct Device {
    slave: Slave,
    drive: Drive,
    objects: DriveObjects,
}

impl Device {
    /// A device just switched on.
    pub fn new(serial: u32) -> Self {
        Self {
            slave: Slave::new(configuration(serial)),
            drive: Drive::new(),
            objects: DriveObjects::new(),
        }
    }

    /// One control tick, every 50 us: bus events, motion, process data for the master.
    pub fn tick(&mut self, esc: &mut impl EscAccess, sensors: &Sensors, now: Nanos) -> Actuators {
        let sync = self.exchange(esc, now);
        let actuators = self.drive.tick(sensors, &mut self.objects);
        // The tick has brought motion up to this instant, at which a new set-point begins: what is published is the end of the old one.
        self.synchronize(sync);
        let application = Application {
            drive: &self.drive,
            objects: &mut self.objects,
        };
        self.slave.publish_inputs(esc, &application, now);
        actuators
    }

    /// Answers what the master has asked between two ticks, so that states and mailboxes do not wait for the next one.
    pub fn poll(&mut self, esc: &mut impl EscAccess, now: Nanos) {
        let sync = self.exchange(esc, now);
        self.synchronize(sync);
    }

    /// Bus events and process data. Returns whether outputs have taken effect.
    fn exchange(&mut self, esc: &mut impl EscAccess, now: Nanos) -> Option<Sync> {
        let mut application = Application {
            drive: &self.drive,
            objects: &mut self.objects,
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
        };
        self.slave.read_object(&application, index, sub, now, out)
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

/// How long a master waits for SAFEOP and OP by the ESI, in ms.
pub const OP_TIMEOUT_MS: u32 = 9000;

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
        op_timeout_ms: OP_TIMEOUT_MS,
        mappings: &MAPPINGS,
        rx_assignment: &layout::RX_ASSIGNMENT,
        tx_assignment: &layout::TX_ASSIGNMENT,
    }
}
