//! The profile with the object dictionary: objects with their defaults, limits and units; and the texts of diagnosis messages.

use std::io;

use device::{Device, MAX_OBJECT_SIZE, NoMemory};
use dictionary::lookup::objects;
use dictionary::{Entry, unit};
use drive::DriveObjects;
use slave::event_log::{MESSAGES, MessageText};
use slave::objects::COUNT_NAME;
use wire::Nanos;

use super::data_types::{bits, data_types, flags, has_sub_indices, object_bits, object_name, type_name};
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
    let all: Vec<&[Entry]> = objects(slave::objects::ENTRIES).chain(objects(DriveObjects::ENTRIES)).collect();
    element(xml, "Profile", |xml| {
        text(xml, "ProfileNo", "402")?;
        element(xml, "Dictionary", |xml| {
            element(xml, "DataTypes", |xml| data_types(xml, &all))?;
            let mut new = New(Device::new(0, &mut NoMemory));
            element(xml, "Objects", |xml| {
                all.iter().try_for_each(|entries| object(xml, entries, &mut new))
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

fn object(xml: &mut Xml, entries: &[Entry], new: &mut New) -> io::Result<()> {
    let first = &entries[0];
    element(xml, "Object", |xml| {
        text(xml, "Index", &hex(first.index.into()))?;
        text(xml, "Name", first.object)?;
        if has_sub_indices(entries) {
            text(xml, "Type", &object_name(entries))?;
            text(xml, "BitSize", &object_bits(entries).to_string())?;
            return element(xml, "Info", |xml| sub_indices(xml, entries, new));
        }
        text(xml, "Type", &type_name(first))?;
        text(xml, "BitSize", &bits(first).to_string())?;
        let default = new.digits(first.index, 0);
        element(xml, "Info", |xml| value(xml, first, &default))?;
        element(xml, "Flags", |xml| flags(xml, first))
    })
}

fn sub_indices(xml: &mut Xml, entries: &[Entry], new: &mut New) -> io::Result<()> {
    if entries[0].in_record() {
        let count = new.digits(entries[0].index, 0);
        sub_index(xml, COUNT_NAME, |xml| text(xml, "DefaultData", &count))?;
    }
    entries.iter().try_for_each(|entry| {
        let default = match new.digits(entry.index, entry.sub) {
            // Entries behind the count of a mapping or an assignment, and messages not there yet, have no value; ESI wants one.
            nothing if nothing.is_empty() => "00".repeat(entry.size()),
            digits => digits,
        };
        sub_index(xml, entry.name, |xml| value(xml, entry, &default))
    })
}

fn sub_index(xml: &mut Xml, name: &str, information: impl FnOnce(&mut Xml) -> io::Result<()>) -> io::Result<()> {
    element(xml, "SubItem", |xml| {
        text(xml, "Name", name)?;
        element(xml, "Info", information)
    })
}

/// Limits where they are narrower than the type's, the default, and the unit.
fn value(xml: &mut Xml, entry: &Entry, default: &str) -> io::Result<()> {
    if entry.data_type.range().is_some_and(|range| range != (entry.min, entry.max)) {
        let limit = |value: i64| digits(&value.to_le_bytes()[..entry.size()]);
        text(xml, "MinData", &limit(entry.min))?;
        text(xml, "MaxData", &limit(entry.max))?;
    }
    text(xml, "DefaultData", default)?;
    match unit::code(entry.unit) {
        Some(code) => text(xml, "Unit", &hex(code)),
        None => Ok(()),
    }
}
