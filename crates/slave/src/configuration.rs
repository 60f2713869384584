//! What makes a device of the stack.

use core::ops::Range;

/// The longest mailbox the stack has memory for, in bytes.
pub const MAX_MAILBOX: usize = 256;
/// The longest value of one object, in bytes: names of [`Configuration`].
pub const MAX_OBJECT_SIZE: usize = 64;
/// The largest process image of one direction, in bytes.
pub const MAX_PROCESS_DATA: usize = 256;

/// Everything that makes a device of the stack; it does not change while the device runs.
#[derive(Clone, Debug)]
pub struct Configuration {
    /// 0x1000: device profile and type.
    pub device_type: u32,
    /// 0x1008, at most [`MAX_OBJECT_SIZE`] bytes.
    pub device_name: &'static str,
    /// 0x1009, at most [`MAX_OBJECT_SIZE`] bytes.
    pub hardware_version: &'static str,
    /// 0x100A, at most [`MAX_OBJECT_SIZE`] bytes.
    pub software_version: &'static str,
    /// 0x1018.
    pub identity: Identity,
    /// Which mailboxes a master may set up.
    pub mailbox: MailboxLimits,
    /// Where the process data may lie in the chip's memory.
    pub process_window: Range<u16>,
    /// 0x1C32:05 and 0x1C33:05: the shortest SYNC0 cycle in ns.
    pub minimum_cycle_ns: u32,
    /// The longest time from an event of synchronisation to the poll that serves it, in ns: what 0x1C32:06, 0x1C32:09 and 0x1C33:06 state
    /// until they are measured.
    pub reaction_ns: u32,
    /// How long a master waits for SAFEOP and OP, in ms; the device gives up shortly before.
    pub op_timeout_ms: u32,
    /// PDO mappings at delivery: index 0x1600.. or 0x1A00.. and entries (index, sub-index, bits). PDOs not listed are empty.
    pub mappings: &'static [(u16, &'static [u32])],
    /// 0x1C12 at delivery.
    pub rx_assignment: &'static [u16],
    /// 0x1C13 at delivery.
    pub tx_assignment: &'static [u16],
}

/// Who the device is: 0x1018, and words 8 to 15 of the SII.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Vendor ID, assigned by the EtherCAT Technology Group.
    pub vendor: u32,
    /// Product code.
    pub product: u32,
    /// Revision number.
    pub revision: u32,
    /// Serial number.
    pub serial: u32,
}

/// Which mailboxes a master may set up.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MailboxLimits {
    /// Shortest mailbox in bytes, at least 24: what an SDO with its headers needs.
    pub min: u16,
    /// Longest mailbox in bytes, at most [`MAX_MAILBOX`].
    pub max: u16,
    /// Where mailboxes may lie in the chip's memory.
    pub window: Range<u16>,
}

impl Configuration {
    /// Panics if the configuration is one the stack has no memory for; that is a mistake of the device's author.
    pub(crate) fn assert_valid(&self) {
        assert!(self.mailbox.min >= 24, "an SDO does not fit the shortest mailbox");
        assert!(
            usize::from(self.mailbox.max) <= MAX_MAILBOX,
            "the longest mailbox is longer than MAX_MAILBOX"
        );
        assert!(self.mailbox.min <= self.mailbox.max, "the mailbox limits are crossed");
        for name in [self.device_name, self.hardware_version, self.software_version] {
            assert!(name.len() <= MAX_OBJECT_SIZE, "a name is longer than MAX_OBJECT_SIZE");
        }
    }
}
