//! How the device uses the slave controller: sync managers, FMMUs, PDOs and clocks. SII, ESI and slave stack are made from it.

use wire::register::sync_manager::{CONTROL_WATCHDOG, DIRECTION_READ, DIRECTION_WRITE, MODE_BUFFERED, MODE_MAILBOX};

/// Interrupt to the application on bus access: bit 5 of a sync manager's control byte.
const CONTROL_PDI_INTERRUPT: u8 = 1 << 5;

/// What a sync manager is for, with its code in SII and 0x1C00.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Usage {
    /// Mailbox from the master.
    MailboxOut = 1,
    /// Mailbox to the master.
    MailboxIn = 2,
    /// Process data from the master.
    Outputs = 3,
    /// Process data to the master.
    Inputs = 4,
}

/// One sync manager as a master is told to set it up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SyncManager {
    /// What it is for.
    pub usage: Usage,
    /// Start address.
    pub start: u16,
    /// Length in bytes at the default PDO assignment.
    pub length: u16,
    /// Control byte.
    pub control: u8,
}

/// Shortest mailbox in bytes.
pub const MAILBOX_MIN: u16 = 0x24;
/// Longest mailbox in bytes, and the default.
pub const MAILBOX_MAX: u16 = 0x80;
/// Memory for the mailboxes; the process data follow behind it.
pub const MAILBOX_WINDOW: core::ops::Range<u16> = 0x1000..0x1100;
/// Memory for the process data.
pub const PROCESS_DATA_WINDOW: core::ops::Range<u16> = 0x1100..0x3000;

/// The sync managers.
pub const SYNC_MANAGERS: [SyncManager; 4] = [
    SyncManager {
        usage: Usage::MailboxOut,
        start: 0x1000,
        length: MAILBOX_MAX,
        control: CONTROL_PDI_INTERRUPT | DIRECTION_WRITE | MODE_MAILBOX,
    },
    SyncManager {
        usage: Usage::MailboxIn,
        start: 0x1080,
        length: MAILBOX_MAX,
        control: CONTROL_PDI_INTERRUPT | DIRECTION_READ | MODE_MAILBOX,
    },
    SyncManager {
        usage: Usage::Outputs,
        start: 0x1100,
        length: byte_length(RX_PDOS[0].entries),
        control: CONTROL_WATCHDOG | CONTROL_PDI_INTERRUPT | DIRECTION_WRITE | MODE_BUFFERED,
    },
    SyncManager {
        usage: Usage::Inputs,
        start: 0x1400,
        length: byte_length(TX_PDOS[0].entries),
        control: CONTROL_PDI_INTERRUPT | DIRECTION_READ | MODE_BUFFERED,
    },
];

/// What FMMUs 0, 1 and 2 are for, with SII codes: mailbox state, outputs, inputs.
pub const FMMUS: [u8; 3] = [3, 1, 2];

/// A PDO and its mapping at delivery.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pdo {
    /// Index of the mapping object.
    pub index: u16,
    /// Name in ESI and SII.
    pub name: &'static str,
    /// Entries as the mapping object holds them: index, sub-index, length in bits.
    pub entries: &'static [u32],
    /// PDOs that cannot be assigned together with this one.
    pub excludes: &'static [u16],
}

const CONTROLWORD: u32 = 0x6040_0010;
const MODES_OF_OPERATION: u32 = 0x6060_0008;
const TARGET_POSITION: u32 = 0x607A_0020;
const PROFILE_VELOCITY: u32 = 0x6081_0020;
const PROFILE_ACCELERATION: u32 = 0x6083_0020;
const PROFILE_DECELERATION: u32 = 0x6084_0020;
const TARGET_VELOCITY: u32 = 0x60FF_0020;
const STATUSWORD: u32 = 0x6041_0010;
const MODES_OF_OPERATION_DISPLAY: u32 = 0x6061_0008;
const POSITION_ACTUAL_VALUE: u32 = 0x6064_0020;
const VELOCITY_ACTUAL_VALUE: u32 = 0x606C_0020;
const DIGITAL_INPUTS: u32 = 0x60FD_0020;

/// RxPDOs.
pub const RX_PDOS: [Pdo; 3] = [
    Pdo {
        index: 0x1600,
        name: "Receive PDO 1",
        entries: &[CONTROLWORD, MODES_OF_OPERATION, TARGET_POSITION],
        excludes: &[],
    },
    Pdo {
        index: 0x1601,
        name: "Receive PDO 2",
        entries: &[
            CONTROLWORD,
            TARGET_POSITION,
            PROFILE_VELOCITY,
            PROFILE_ACCELERATION,
            PROFILE_DECELERATION,
            MODES_OF_OPERATION,
        ],
        excludes: &[0x1602],
    },
    Pdo {
        index: 0x1602,
        name: "Receive PDO 3",
        entries: &[
            CONTROLWORD,
            PROFILE_ACCELERATION,
            PROFILE_DECELERATION,
            TARGET_VELOCITY,
            MODES_OF_OPERATION,
        ],
        excludes: &[0x1601],
    },
];

/// TxPDOs.
pub const TX_PDOS: [Pdo; 3] = [
    Pdo {
        index: 0x1A00,
        name: "Transmit PDO 1",
        entries: &[STATUSWORD, MODES_OF_OPERATION_DISPLAY, POSITION_ACTUAL_VALUE, DIGITAL_INPUTS],
        excludes: &[],
    },
    Pdo {
        index: 0x1A01,
        name: "Transmit PDO 2",
        entries: &[STATUSWORD, MODES_OF_OPERATION_DISPLAY, VELOCITY_ACTUAL_VALUE, DIGITAL_INPUTS],
        excludes: &[],
    },
    Pdo {
        index: 0x1A02,
        name: "Transmit PDO 3",
        entries: &[],
        excludes: &[],
    },
];

/// RxPDOs assigned at delivery.
pub const RX_ASSIGNMENT: [u16; 1] = [0x1600];
/// TxPDOs assigned at delivery.
pub const TX_ASSIGNMENT: [u16; 1] = [0x1A00];

/// A way to use the distributed clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClockMode {
    /// Name in ESI and SII.
    pub name: &'static str,
    /// What it means.
    pub description: &'static str,
    /// Value for registers 0x0980 and 0x0981.
    pub assign_activate: u16,
}

/// The clock modes; the first is the default.
pub const CLOCK_MODES: [ClockMode; 2] = [
    ClockMode {
        name: "DC",
        description: "DC-Synchron",
        assign_activate: 0x0300,
    },
    ClockMode {
        name: "Synchron",
        description: "SM-Synchron",
        assign_activate: 0x0000,
    },
];

/// How long a master waits for the device, in ms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timeouts {
    /// INIT to PREOP.
    pub preop_ms: u32,
    /// PREOP to SAFEOP, SAFEOP to OP.
    pub op_ms: u32,
    /// To INIT.
    pub back_to_init_ms: u32,
    /// OP to SAFEOP.
    pub back_to_safeop_ms: u32,
    /// Until a request is taken out of the mailbox.
    pub mailbox_request_ms: u32,
    /// Until the answer lies in the other.
    pub mailbox_response_ms: u32,
}

/// The time-outs in the ESI; the device gives up waiting for OP shortly before its own.
pub const TIMEOUTS: Timeouts = Timeouts {
    preop_ms: 2000,
    op_ms: 9000,
    back_to_init_ms: 5000,
    back_to_safeop_ms: 200,
    mailbox_request_ms: 100,
    mailbox_response_ms: 2000,
};

/// An SDO download with which a configured master begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InitCommand {
    /// The change of state before which it is sent: IP, PS or SO.
    pub transition: &'static str,
    /// Index of the object.
    pub index: u16,
    /// Sub-index.
    pub sub: u8,
    /// The value, little-endian.
    pub data: &'static [u8],
    /// What it is for.
    pub comment: &'static str,
}

/// The downloads in the ESI: cyclic synchronous position, for masters whose axes do not set 0x6060. PDO assignments and mappings
/// are not among them: masters make those downloads of the PDOs they have chosen.
pub const INIT_COMMANDS: [InitCommand; 1] = [InitCommand {
    transition: "PS",
    index: 0x6060,
    sub: 0,
    data: &[8],
    comment: "Cyclic synchronous position",
}];

/// Shortest cycle in ns (manual 1.1.1).
pub const MINIMUM_CYCLE_NS: u32 = 500_000;

/// Bytes of a PDO with these entries.
const fn byte_length(entries: &[u32]) -> u16 {
    let mut bits = 0;
    let mut i = 0;
    while i < entries.len() {
        bits += (entries[i] & 0xFF) as u16;
        i += 1;
    }
    bits.div_ceil(8)
}
