//! The data types of the object dictionary: basic ones, and one or two for each object with sub-indices.

use std::collections::BTreeSet;
use std::io;

use device::identity;
use dictionary::{DataType, Entry};
use quick_xml::events::BytesText;
use slave::objects::{COUNT_NAME, ObjectCode, kind};

use super::xml::{Xml, element, text};

/// Bits from an object's start to the first entry behind sub-index 0, which is padded to 16 (complete access, ETG.1000.6).
const ENTRIES_START: u16 = 16;

/// Objects that every drive with CoE and modes of operation has (ETG.1000.6, CiA 402).
const MANDATORY: [u16; 7] = [0x1000, 0x1018, 0x1C00, 0x6040, 0x6041, 0x6060, 0x6061];
/// Objects that every device with process data has: PDO mappings and assignments (ETG.1000.6).
const CONDITIONAL: std::ops::Range<u16> = 0x1600..0x1C14;

/// Basic types that some entry has, then those of the objects with sub-indices.
pub(super) fn data_types(xml: &mut Xml, objects: &[&[Entry]]) -> io::Result<()> {
    let entries = || objects.iter().copied().flatten();
    let mut basic: BTreeSet<(String, u16)> = entries()
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
    let octets = entries().filter(|entry| entry.data_type == DataType::OctetString);
    let sizes: BTreeSet<usize> = octets.map(Entry::size).collect();
    sizes.into_iter().try_for_each(|size| octet_string(xml, size))?;
    for entries in objects.iter().filter(|entries| has_sub_indices(entries)) {
        if kind(entries).code == ObjectCode::Array {
            array_elements(xml, entries)?;
        }
        object_type(xml, entries)?;
    }
    Ok(())
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

/// Whether an object has more than one value.
pub(super) fn has_sub_indices(entries: &[Entry]) -> bool {
    entries.iter().any(Entry::in_record)
}

/// The entries behind sub-index 0.
fn members(entries: &[Entry]) -> impl Iterator<Item = &Entry> {
    entries.iter().filter(|entry| entry.in_record())
}

/// The type of an array's elements together.
fn array_elements(xml: &mut Xml, entries: &[Entry]) -> io::Result<()> {
    element(xml, "DataType", |xml| {
        text(xml, "Name", &elements_name(entries))?;
        text(xml, "BaseType", &type_name(&entries[entries.len() - 1]))?;
        text(xml, "BitSize", &members(entries).map(bits).sum::<u16>().to_string())?;
        element(xml, "ArrayInfo", |xml| {
            text(xml, "LBound", "1")?;
            text(xml, "Elements", &members(entries).count().to_string())
        })
    })
}

fn object_type(xml: &mut Xml, entries: &[Entry]) -> io::Result<()> {
    element(xml, "DataType", |xml| {
        text(xml, "Name", &object_name(entries))?;
        text(xml, "BitSize", &object_bits(entries).to_string())?;
        sub_item(xml, Some(0), COUNT_NAME, ("USINT", 8, 0), |xml| match entries[0].sub {
            0 => flags(xml, &entries[0]),
            _ => access(xml, "ro", &entries[0]),
        })?;
        if kind(entries).code == ObjectCode::Array {
            let size = object_bits(entries) - ENTRIES_START;
            let last = &entries[entries.len() - 1];
            return sub_item(xml, None, "Elements", (&elements_name(entries), size, ENTRIES_START), |xml| {
                flags(xml, last)
            });
        }
        let mut offset = ENTRIES_START;
        for entry in members(entries) {
            sub_item(xml, Some(entry.sub), entry.name, (&type_name(entry), bits(entry), offset), |xml| {
                flags(xml, entry)
            })?;
            offset += bits(entry);
        }
        Ok(())
    })
}

fn sub_item(
    xml: &mut Xml,
    sub: Option<u8>,
    name: &str,
    (kind, bits, offset): (&str, u16, u16),
    flags: impl FnOnce(&mut Xml) -> io::Result<()>,
) -> io::Result<()> {
    element(xml, "SubItem", |xml| {
        if let Some(sub) = sub {
            text(xml, "SubIdx", &sub.to_string())?;
        }
        text(xml, "Name", name)?;
        text(xml, "Type", kind)?;
        text(xml, "BitSize", &bits.to_string())?;
        text(xml, "BitOffs", &offset.to_string())?;
        element(xml, "Flags", flags)
    })
}

/// Access, category, PDO directions and persistence of an entry.
pub(super) fn flags(xml: &mut Xml, entry: &Entry) -> io::Result<()> {
    access(xml, if entry.access.is_writable() { "rw" } else { "ro" }, entry)?;
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
        text(xml, "Backup", "1")?;
    }
    if entry.access.is_setting() {
        text(xml, "Setting", "1")?;
    }
    Ok(())
}

fn access(xml: &mut Xml, rights: &str, entry: &Entry) -> io::Result<()> {
    let mut element = xml.create_element("Access");
    if rights == "rw" && entry.access.is_writable_in_preop_only() {
        element = element.with_attribute(("WriteRestrictions", "PreOP"));
    }
    element.write_text_content(BytesText::new(rights))?;
    text(
        xml,
        "Category",
        match entry.index {
            index if MANDATORY.contains(&index) => "m",
            index if CONDITIONAL.contains(&index) => "c",
            _ => "o",
        },
    )
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

/// Length of an entry's value.
pub(super) fn bits(entry: &Entry) -> u16 {
    match entry.data_type {
        DataType::VisibleString => 8 * string(entry).len() as u16,
        _ => entry.bits,
    }
}

/// Length of an object with sub-indices, as complete access has it.
pub(super) fn object_bits(entries: &[Entry]) -> u16 {
    let bits: u16 = members(entries).map(bits).sum();
    (ENTRIES_START + bits).next_multiple_of(8)
}

/// The type of an entry.
pub(super) fn type_name(entry: &Entry) -> String {
    match entry.data_type {
        DataType::OctetString => octet_string_name(entry.size()),
        DataType::VisibleString => format!("STRING({})", string(entry).len()),
        other => other.esi_name().to_owned(),
    }
}

/// The type of an object with sub-indices.
pub(super) fn object_name(entries: &[Entry]) -> String {
    format!("DT{:04X}", entries[0].index)
}

fn elements_name(entries: &[Entry]) -> String {
    format!("DT{:04X}ARR", entries[0].index)
}
