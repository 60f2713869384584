//! The table of objects 0x1000 to 0x1FFF (ETG.1000.6, communication area; ETG.1020 for 0x10F1, 0x10F3, 0x1C32 and 0x1C33).
//!
//! Rows of one value are declared with [`object_dictionary!`](dictionary::object_dictionary); strings, PDO mappings, PDO assignments,
//! diagnosis messages and the sync manager parameters, whose rows repeat or have gaps, are generated beside them.

use dictionary::{Access, DataType, Entry, object_dictionary};

use crate::event_log::{self, history};
use crate::sync_parameters;

/// PDO mapping objects of each direction, from 0x1600 and 0x1A00 on; as many can be assigned.
pub const PDOS_PER_DIRECTION: usize = 3;
/// Entries of one PDO mapping object.
pub const MAX_MAPPING_ENTRIES: usize = 12;

/// The first mapping object of the RxPDOs.
pub(crate) const RX_MAPPING: u16 = 0x1600;
/// The first mapping object of the TxPDOs.
pub(crate) const TX_MAPPING: u16 = 0x1A00;
/// Identity.
const IDENTITY: u16 = 0x1018;
/// Diagnosis history.
pub(crate) const DIAGNOSIS_HISTORY: u16 = 0x10F3;
/// What the sync managers are for.
const SYNC_MANAGER_TYPES: u16 = 0x1C00;
/// The assignment of RxPDOs to sync manager 2.
pub(crate) const RX_ASSIGNMENT: u16 = 0x1C12;
/// The assignment of TxPDOs to sync manager 3.
pub(crate) const TX_ASSIGNMENT: u16 = 0x1C13;
/// Parameters of sync manager 2.
pub(crate) const OUTPUT_PARAMETERS: u16 = 0x1C32;
/// Parameters of sync manager 3.
pub(crate) const INPUT_PARAMETERS: u16 = 0x1C33;
/// Device name.
pub(crate) const DEVICE_NAME: u16 = 0x1008;
/// Hardware version.
pub(crate) const HARDWARE_VERSION: u16 = 0x1009;
/// Software version.
pub(crate) const SOFTWARE_VERSION: u16 = 0x100A;

object_dictionary! {
    /// The objects of one value each.
    pub struct FixedObjects in fixed {
        /// Device profile number and additional information.
        0x1000:0 device_type: u32 = 0, RO, "Device type";
        /// Kinds of errors that are present (CiA 301).
        0x1001:0 error_register: u8 = 0, RO, "Error register";
        /// Writing 1 saves all parameters; other values are refused.
        0x1010:1 save_all: u16 = 0, RW, "Save all" of "Save parameters";
        /// Writing 1 restores the parameters of delivery; other values are refused.
        0x1011:1 restore_all: u16 = 0, RW, "Restore all to default" of "Restore parameters";
        /// Vendor ID of the EtherCAT Technology Group.
        0x1018:1 vendor: u32 = 0, RO, "Vendor ID" of "Identity";
        /// Product code.
        0x1018:2 product: u32 = 0, RO, "Product code" of "Identity";
        /// Revision number.
        0x1018:3 revision: u32 = 0, RO, "Revision" of "Identity";
        /// Serial number.
        0x1018:4 serial: u32 = 0, RO, "Serial number" of "Identity";
        /// Reaction on a local error (ETG.1020).
        0x10F1:1 local_error_reaction: u32 = 1, RW, "Local Error Reaction" of "Error Settings";
        /// Missed outputs that end OP, each counted three; 0 switches the check off (ETG.1020).
        0x10F1:2 sync_error_limit: u16 = 4, RW, "Sync Error Counter Limit" of "Error Settings";
        /// How many messages the history holds (ETG.1020).
        0x10F3:1 maximum_messages: u8 = event_log::CAPACITY as u8, RO, "Maximum Messages" of "Diagnosis History";
        /// Sub-index of the newest message, 0 for none (ETG.1020).
        0x10F3:2 newest_message: u8 = 0, RO, "Newest Message" of "Diagnosis History";
        /// Sub-index of the newest message that was acknowledged; writing 0 clears the history (ETG.1020).
        0x10F3:3 acknowledged_message: u8 = 0, RW, "Newest Acknowledged Message" of "Diagnosis History";
        /// Whether the newest message was neither read nor acknowledged (ETG.1020).
        0x10F3:4 new_messages: bool = false, RO | TX_PDO, "New Messages Available" of "Diagnosis History";
        /// Bits 1, 2, 3: leave out information, warnings, errors; bit 5: a message that was not acknowledged was overwritten (ETG.1020).
        0x10F3:5 diagnosis_flags: u16 = 0, RW, "Flags" of "Diagnosis History";
        /// Time of the device (ETG.1020).
        0x10F8:0 timestamp: u64 = 0, RW | TX_PDO, unit "ns", "Timestamp Object";
        /// Sync manager 0 receives the mailbox.
        0x1C00:1 sync_manager_0: u8 = 1, RO, "SubIndex 001" of "Sync manager type";
        /// Sync manager 1 sends the mailbox.
        0x1C00:2 sync_manager_1: u8 = 2, RO, "SubIndex 002" of "Sync manager type";
        /// Sync manager 2 receives the process data.
        0x1C00:3 sync_manager_2: u8 = 3, RO, "SubIndex 003" of "Sync manager type";
        /// Sync manager 3 sends the process data.
        0x1C00:4 sync_manager_3: u8 = 4, RO, "SubIndex 004" of "Sync manager type";
    }
}

/// The name of sub-index 0 of an object with sub-indices.
pub const COUNT_NAME: &str = "SubIndex 000";

const SUB_NAMES: [&str; MAX_MAPPING_ENTRIES + 1] = [
    COUNT_NAME,
    "SubIndex 001",
    "SubIndex 002",
    "SubIndex 003",
    "SubIndex 004",
    "SubIndex 005",
    "SubIndex 006",
    "SubIndex 007",
    "SubIndex 008",
    "SubIndex 009",
    "SubIndex 010",
    "SubIndex 011",
    "SubIndex 012",
];

const MAPPINGS: [(u16, &str); 2 * PDOS_PER_DIRECTION] = [
    (RX_MAPPING, "RXPDO 1 Mapping Parameter"),
    (RX_MAPPING + 1, "RXPDO 2 Mapping Parameter"),
    (RX_MAPPING + 2, "RXPDO 3 Mapping Parameter"),
    (TX_MAPPING, "TXPDO 1 Mapping Parameter"),
    (TX_MAPPING + 1, "TXPDO 2 Mapping Parameter"),
    (TX_MAPPING + 2, "TXPDO 3 Mapping Parameter"),
];

const STRINGS: [(u16, &str, &str); 3] = [
    (DEVICE_NAME, "Device name", " Name of the device.\n"),
    (HARDWARE_VERSION, "Hardware version", " Version of the hardware.\n"),
    (SOFTWARE_VERSION, "Software version", " Version of the firmware.\n"),
];

const COUNT: usize = FixedObjects::ENTRIES.len()
    + STRINGS.len()
    + MAPPINGS.len() * (MAX_MAPPING_ENTRIES + 1)
    + 2 * (PDOS_PER_DIRECTION + 1)
    + 1
    + event_log::CAPACITY
    + 2 * sync_parameters::ROWS.len();

/// All entries of 0x1000 to 0x1FFF, sorted. Strings have 0 bits here; values that come from the configuration are read from the stack.
pub const ENTRIES: &[Entry] = &{
    let mut table = [FixedObjects::ENTRIES[0]; COUNT];
    let mut length = 0;
    while length < FixedObjects::ENTRIES.len() {
        table[length] = FixedObjects::ENTRIES[length];
        length += 1;
    }
    let mut i = 0;
    while i < STRINGS.len() {
        let (index, name, doc) = STRINGS[i];
        table[length] = entry(index, 0, (name, name), DataType::VisibleString, Access::RO, doc);
        (length, i) = (length + 1, i + 1);
    }
    let mut i = 0;
    while i < MAPPINGS.len() {
        let (index, object) = MAPPINGS[i];
        let doc = " An object of the PDO: index, sub-index, bits.\n";
        (table, length) = append_list(table, length, (index, object, doc), MAX_MAPPING_ENTRIES, DataType::Unsigned32);
        i += 1;
    }
    let doc = " A PDO of the sync manager.\n";
    (table, length) = append_list(
        table,
        length,
        (RX_ASSIGNMENT, "RxPDO assign", doc),
        PDOS_PER_DIRECTION,
        DataType::Unsigned16,
    );
    (table, length) = append_list(
        table,
        length,
        (TX_ASSIGNMENT, "TxPDO assign", doc),
        PDOS_PER_DIRECTION,
        DataType::Unsigned16,
    );
    (table, length) = append_messages(table, length);
    let mut i = 0;
    while i < sync_parameters::ROWS.len() {
        let row = &sync_parameters::ROWS[i];
        table[length] = entry(
            OUTPUT_PARAMETERS,
            row.sub,
            (row.name, "SM output parameter"),
            row.data_type,
            row.access,
            row.doc,
        );
        table[length + 1] = entry(
            INPUT_PARAMETERS,
            row.sub,
            (row.name, "SM input parameter"),
            row.data_type,
            row.access,
            row.doc,
        );
        // Every parameter of 32 bits is a time (ETG.1020).
        if let DataType::Unsigned32 = row.data_type {
            (table[length].unit, table[length + 1].unit) = ("ns", "ns");
        }
        (length, i) = (length + 2, i + 1);
    }
    assert!(length == COUNT);
    sorted(table)
};

/// Appends an object whose sub-index 0 can be written, with `count` entries behind it.
const fn append_list(
    mut table: [Entry; COUNT],
    mut length: usize,
    (index, object, doc): (u16, &'static str, &'static str),
    count: usize,
    data_type: DataType,
) -> ([Entry; COUNT], usize) {
    let mut sub = 0;
    while sub <= count {
        let (kind, doc) = if sub == 0 {
            (DataType::Unsigned8, " How many entries count.\n")
        } else {
            (data_type, doc)
        };
        table[length] = entry(index, sub as u8, (SUB_NAMES[sub], object), kind, Access::RW_PREOP, doc);
        if sub == 0 {
            table[length].max = count as i64;
        }
        (length, sub) = (length + 1, sub + 1);
    }
    (table, length)
}

/// Appends the sub-index 0 and the messages of the diagnosis history.
const fn append_messages(mut table: [Entry; COUNT], mut length: usize) -> ([Entry; COUNT], usize) {
    let (object, doc) = ("Diagnosis History", " Sub-index of the last message.\n");
    table[length] = entry(DIAGNOSIS_HISTORY, 0, (COUNT_NAME, object), DataType::Unsigned8, Access::RO, doc);
    let behind = history::FIRST_MESSAGE as i64 - 1;
    (table[length].min, table[length].max) = (behind, behind + event_log::CAPACITY as i64);
    length += 1;
    let mut i = 0;
    while i < event_log::CAPACITY {
        let doc = " Code, flags, text, time, parameters (ETG.1020).\n";
        let sub = history::FIRST_MESSAGE + i as u8;
        let name = (history::NAMES[i], object);
        table[length] = entry(DIAGNOSIS_HISTORY, sub, name, DataType::OctetString, Access::RO, doc);
        (table[length].bits, table[length].max) = (8 * history::MESSAGE_SIZE as u16, 0);
        (length, i) = (length + 1, i + 1);
    }
    (table, length)
}

/// An entry whose range is that of its type.
const fn entry(
    index: u16,
    sub: u8,
    (name, object): (&'static str, &'static str),
    data_type: DataType,
    access: Access,
    doc: &'static str,
) -> Entry {
    let bits = match data_type.bits() {
        Some(bits) => bits as u16,
        None => 0,
    };
    let (min, max) = match data_type.range() {
        Some(range) => range,
        None => (0, 0),
    };
    Entry {
        index,
        sub,
        name,
        object,
        data_type,
        bits,
        access,
        default: 0,
        min,
        max,
        unit: "",
        doc,
    }
}

/// What kind of object a set of entries makes up (CiA 301, object codes).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum ObjectCode {
    /// One value.
    Variable = 7,
    /// Values of one type.
    Array = 8,
    /// Values of their own types.
    Record = 9,
}

/// Object code and data type of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// The object code.
    pub code: ObjectCode,
    /// The number of the data type: that of the value, of an array's elements, or of a record's structure.
    pub data_type: u16,
}

/// Data types of records (ETG.1000.6, PDO mapping and identity; ETG.1020, synchronisation parameters).
mod record {
    pub(super) const PDO_MAPPING: u16 = 0x0021;
    pub(super) const IDENTITY: u16 = 0x0023;
    pub(super) const SYNC_PARAMETERS: u16 = 0x0029;
    pub(super) const RECORD: u16 = 0x002A;
}

/// The kind of object that these entries, all of one object, make up.
///
/// # Panics
/// If there are none.
pub fn kind(entries: &[Entry]) -> Kind {
    let last = &entries[entries.len() - 1];
    let (code, data_type) = match last.index {
        _ if !last.in_record() => (ObjectCode::Variable, last.data_type.code()),
        SYNC_MANAGER_TYPES | RX_ASSIGNMENT | TX_ASSIGNMENT => (ObjectCode::Array, last.data_type.code()),
        RX_MAPPING..SYNC_MANAGER_TYPES => (ObjectCode::Record, record::PDO_MAPPING),
        IDENTITY => (ObjectCode::Record, record::IDENTITY),
        OUTPUT_PARAMETERS | INPUT_PARAMETERS => (ObjectCode::Record, record::SYNC_PARAMETERS),
        _ => (ObjectCode::Record, record::RECORD),
    };
    Kind { code, data_type }
}

/// Insertion sort, at compile time.
const fn sorted(mut table: [Entry; COUNT]) -> [Entry; COUNT] {
    let mut i = 1;
    while i < COUNT {
        let mut k = i;
        while k > 0 && key(&table[k]) < key(&table[k - 1]) {
            (table[k], table[k - 1]) = (table[k - 1], table[k]);
            k -= 1;
        }
        i += 1;
    }
    table
}

const fn key(entry: &Entry) -> u32 {
    (entry.index as u32) << 8 | entry.sub as u32
}

/// Sorted, and no entry twice.
const _: () = {
    let mut i = 1;
    while i < COUNT {
        assert!(key(&ENTRIES[i - 1]) < key(&ENTRIES[i]));
        i += 1;
    }
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_object_of_the_communication_area_is_there_once() {
        let indices: std::vec::Vec<u16> = dictionary::lookup::objects(ENTRIES).map(|object| object[0].index).collect();
        assert_eq!(
            indices,
            [
                0x1000, 0x1001, 0x1008, 0x1009, 0x100A, 0x1010, 0x1011, 0x1018, 0x10F1, 0x10F3, 0x10F8, 0x1600, 0x1601, 0x1602, 0x1A00,
                0x1A01, 0x1A02, 0x1C00, 0x1C12, 0x1C13, 0x1C32, 0x1C33
            ]
        );
    }

    #[test]
    fn access_words_are_those_a_real_unit_lists() {
        let access = |index, sub| match dictionary::lookup(ENTRIES, index, sub) {
            Ok(dictionary::Lookup::Slot(slot)) => ENTRIES[slot].access.bits(),
            other => panic!("{index:04X}:{sub:02X} {other:?}"),
        };
        for (index, sub, bits) in [
            (0x1000, 0, 0x0007),
            (0x1010, 1, 0x003F),
            (0x10F8, 0, 0x00BF),
            (0x1C12, 0, 0x000F),
            (0x1C12, 1, 0x000F),
            (0x1C32, 0x01, 0x000F),
            (0x1C32, 0x02, 0x0007),
            (0x1C33, 0x08, 0x003F),
            (0x1C33, 0x20, 0x0007),
        ] {
            assert_eq!(access(index, sub), bits, "{index:04X}:{sub:02X}");
        }
    }
}
