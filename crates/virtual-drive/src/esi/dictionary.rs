//! The profile with the object dictionary: data types, objects, defaults; and the texts of diagnosis messages.

use std::collections::BTreeSet;
use std::io;

use device::{Device, MAX_OBJECT_SIZE, identity};
use dictionary::lookup::objects;
use dictionary::{DataType, Entry};
use drive::DriveObjects;
use quick_xml::events::BytesText;
use slave::event_log::{MESSAGES, MessageText};
use wire::Nanos;

use super::xml::{Xml, digits, element, hex, text};

/// A device just switched on, whose objects are the defaults of the file.
struct New(Device);

impl New {
    /// The value at `index` and `sub` as the bytes on the wire.
    fn value(&mut self, index: u16, sub: u8) -> Vec<u8> {
        let mut value = [0; MAX_OBJECT_SIZE];
        let length = self.0.read_object(index, sub, Nanos(0), &mut value).unwrap_or(0);
        value[..length].to_vec()
    }

    /// The same as hexadecimal digits.
    fn digits(&mut self, index: u16, sub: u8) -> String {
        digits(&self.value(index, sub))
    }
}

/// The profile with the object dictionary: data types first, then objects. The texts that messages of 0x10F3 name come behind it.
pub(super) fn profile(xml: &mut Xml) -> io::Result<()> {
    element(xml, "Profile", |xml| {
        text(xml, "ProfileNo", "402")?;
        element(xml, "Dictionary", |xml| {
            element(xml, "DataTypes", data_types)?;
            let mut new = New(Device::new(0));
            element(xml, "Objects", |xml| {
                all_objects().try_for_each(|entries| object(xml, entries, &mut new))
            })
        })?;
        element(xml, "DiagMessages", |xml| {
            MESSAGES.iter().try_for_each(|message| diagnosis_message(xml, message))
        })
    })
}

fn diagnosis_message(xml: &mut Xml, message: &MessageText) -> io::Result<()> {
    element(xml, "DiagMessage", |xml| {
        text(xml, "TextId", &hex(message.id.into()))?;
        text(xml, "MessageText", message.text)?;
        element(xml, "Flags", |xml| text(xml, "DiagClass", message.severity.name()))
    })
}

fn all_objects() -> impl Iterator<Item = &'static [Entry]> {
    objects(slave::objects::ENTRIES).chain(objects(DriveObjects::ENTRIES))
}

fn is_record(entries: &[Entry]) -> bool {
    entries.iter().any(Entry::in_record)
}

/// Basic types that some entry has, then one type for each object with sub-indices.
fn data_types(xml: &mut Xml) -> io::Result<()> {
    let mut basic: BTreeSet<(String, u16)> = all_objects()
        .flatten()
        .map(|entry| match entry.data_type {
            DataType::OctetString => (entry.data_type.esi_name().into(), 8),
            _ => (type_name(entry), bits(entry)),
        })
        .collect();
    basic.insert(("USINT".into(), 8));
    for (name, bits) in basic {
        element(xml, "DataType", |xml| {
            text(xml, "Name", &name)?;
            text(xml, "BitSize", &bits.to_string())
        })?;
    }
    let octets: BTreeSet<usize> = all_objects()
        .flatten()
        .filter(|entry| entry.data_type == DataType::OctetString)
        .map(Entry::size)
        .collect();
    octets.into_iter().try_for_each(|size| octet_string(xml, size))?;
    all_objects()
        .filter(|entries| is_record(entries))
        .try_for_each(|entries| record_type(xml, entries))
}

/// A string of octets is an array in an ESI file.
fn octet_string(xml: &mut Xml, size: usize) -> io::Result<()> {
    element(xml, "DataType", |xml| {
        text(xml, "Name", &octet_string_name(size))?;
        text(xml, "BaseType", DataType::OctetString.esi_name())?;
        text(xml, "BitSize", &(8 * size).to_string())?;
        element(xml, "ArrayInfo", |xml| {
            text(xml, "LBound", "0")?;
            text(xml, "Elements", &size.to_string())
        })
    })
}

fn octet_string_name(size: usize) -> String {
    format!("ARRAY [0..{}] OF {}", size - 1, DataType::OctetString.esi_name())
}

/// Bits from one object's start to the first entry behind sub-index 0, which is padded to 16 (complete access, ETG.1000.6).
const RECORD_START: u16 = 16;

fn record_type(xml: &mut Xml, entries: &[Entry]) -> io::Result<()> {
    let members = || entries.iter().filter(|entry| entry.in_record());
    element(xml, "DataType", |xml| {
        text(xml, "Name", &record_name(entries))?;
        text(xml, "BitSize", &record_bits(entries).to_string())?;
        let count_access = entries.iter().find(|entry| !entry.in_record()).map_or("ro", access);
        sub_item(xml, 0, "SubIndex 000", ("USINT", 8, 0), |xml| text(xml, "Access", count_access))?;
        let mut offset = RECORD_START;
        for entry in members() {
            sub_item(xml, entry.sub, entry.name, (&type_name(entry), bits(entry), offset), |xml| {
                flags(xml, entry)
            })?;
            offset += bits(entry);
        }
        Ok(())
    })
}

fn sub_item(
    xml: &mut Xml,
    sub: u8,
    name: &str,
    (kind, bits, offset): (&str, u16, u16),
    flags: impl FnOnce(&mut Xml) -> io::Result<()>,
) -> io::Result<()> {
    element(xml, "SubItem", |xml| {
        text(xml, "SubIdx", &sub.to_string())?;
        text(xml, "Name", name)?;
        text(xml, "Type", kind)?;
        text(xml, "BitSize", &bits.to_string())?;
        text(xml, "BitOffs", &offset.to_string())?;
        element(xml, "Flags", flags)
    })
}

fn object(xml: &mut Xml, entries: &[Entry], new: &mut New) -> io::Result<()> {
    let first = &entries[0];
    element(xml, "Object", |xml| {
        text(xml, "Index", &hex(first.index.into()))?;
        text(xml, "Name", first.object)?;
        if is_record(entries) {
            text(xml, "Type", &record_name(entries))?;
            text(xml, "BitSize", &record_bits(entries).to_string())?;
            return element(xml, "Info", |xml| record_defaults(xml, entries, new));
        }
        text(xml, "Type", &type_name(first))?;
        text(xml, "BitSize", &bits(first).to_string())?;
        element(xml, "Info", |xml| text(xml, "DefaultData", &new.digits(first.index, 0)))?;
        element(xml, "Flags", |xml| flags(xml, first))
    })
}

fn record_defaults(xml: &mut Xml, entries: &[Entry], new: &mut New) -> io::Result<()> {
    sub_default(xml, "SubIndex 000", &new.digits(entries[0].index, 0))?;
    entries.iter().filter(|entry| entry.in_record()).try_for_each(|entry| {
        let value = match new.digits(entry.index, entry.sub) {
            // Entries behind the count of a mapping or an assignment, and messages not there yet, have no value; ESI wants one.
            nothing if nothing.is_empty() => "00".repeat(entry.size()),
            digits => digits,
        };
        sub_default(xml, entry.name, &value)
    })
}

fn sub_default(xml: &mut Xml, name: &str, data: &str) -> io::Result<()> {
    element(xml, "SubItem", |xml| {
        text(xml, "Name", name)?;
        element(xml, "Info", |xml| text(xml, "DefaultData", data))
    })
}

fn flags(xml: &mut Xml, entry: &Entry) -> io::Result<()> {
    if entry.access.is_writable_in_preop_only() {
        xml.create_element("Access")
            .with_attribute(("WriteRestrictions", "PreOP"))
            .write_text_content(BytesText::new("rw"))?;
    } else {
        text(xml, "Access", access(entry))?;
    }
    let mapping = match (entry.access.is_tx_mappable(), entry.access.is_rx_mappable()) {
        (true, true) => Some("TR"),
        (true, false) => Some("T"),
        (false, true) => Some("R"),
        (false, false) => None,
    };
    if let Some(directions) = mapping {
        text(xml, "PdoMapping", directions)?;
    }
    if entry.access.is_saved() {
        text(xml, "Backup", "1")
    } else {
        Ok(())
    }
}

fn access(entry: &Entry) -> &'static str {
    if entry.access.is_writable() { "rw" } else { "ro" }
}

/// The text of a string object.
fn string(entry: &Entry) -> &'static str {
    match entry.index {
        0x1008 => identity::DEVICE_NAME,
        0x1009 => identity::HARDWARE_VERSION,
        0x100A => identity::SOFTWARE_VERSION,
        _ => "",
    }
}

fn bits(entry: &Entry) -> u16 {
    match entry.data_type {
        DataType::VisibleString => 8 * string(entry).len() as u16,
        _ => entry.bits,
    }
}

fn type_name(entry: &Entry) -> String {
    match entry.data_type {
        DataType::OctetString => octet_string_name(entry.size()),
        DataType::VisibleString => format!("STRING({})", string(entry).len()),
        other => other.esi_name().to_owned(),
    }
}

fn record_name(entries: &[Entry]) -> String {
    format!("DT{:04X}", entries[0].index)
}

fn record_bits(entries: &[Entry]) -> u16 {
    let bits: u16 = entries.iter().filter(|entry| entry.in_record()).map(bits).sum();
    (RECORD_START + bits).next_multiple_of(8)
}
