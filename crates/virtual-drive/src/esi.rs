//! The ESI file (EtherCAT slave information, ETG.2000), made from identity, layout and object tables.

use std::collections::BTreeSet;
use std::io;

use device::layout::{self, Pdo, Usage};
use device::{identity, sii};
use dictionary::{DataType, Entry, lookup::objects};
use drive::DriveObjects;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};

type Xml = Writer<Vec<u8>>;

/// LCID of US English, which ETG.2000 asks for in names.
const ENGLISH: &str = "1033";

/// The file's text.
///
/// # Errors
/// None in practice: everything is written to memory.
pub fn document() -> io::Result<String> {
    let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    xml.create_element("EtherCATInfo")
        .with_attribute(("Version", "1.6"))
        .write_inner_content(|xml| {
            element(xml, "Vendor", |xml| {
                text(xml, "Id", &hex(identity::VENDOR))?;
                text(xml, "Name", identity::VENDOR_NAME)
            })?;
            element(xml, "Descriptions", |xml| {
                element(xml, "Groups", |xml| element(xml, "Group", |xml| named(xml, identity::GROUP)))?;
                element(xml, "Devices", device)
            })
        })?;
    let mut bytes = xml.into_inner();
    bytes.push(b'\n');
    String::from_utf8(bytes).map_err(io::Error::other)
}

fn device(xml: &mut Xml) -> io::Result<()> {
    xml.create_element("Device")
        .with_attribute(("Physics", "YY"))
        .write_inner_content(|xml| {
            xml.create_element("Type")
                .with_attribute(("ProductCode", hex(identity::PRODUCT).as_str()))
                .with_attribute(("RevisionNo", hex(identity::REVISION).as_str()))
                .write_text_content(BytesText::new(identity::NAME))?;
            name(xml, identity::NAME)?;
            info(xml)?;
            text(xml, "GroupType", identity::GROUP)?;
            profile(xml)?;
            for usage in layout::FMMUS {
                text(xml, "Fmmu", ["", "Outputs", "Inputs", "MBoxState"][usize::from(usage)])?;
            }
            for manager in layout::SYNC_MANAGERS {
                sync_manager(xml, &manager)?;
            }
            for (pdo, manager) in layout::RX_PDOS
                .iter()
                .map(|pdo| (pdo, 2))
                .chain(layout::TX_PDOS.iter().map(|pdo| (pdo, 3)))
            {
                process_data(xml, pdo, manager)?;
            }
            mailbox(xml)?;
            clocks(xml)?;
            eeprom(xml)
        })?;
    Ok(())
}

fn info(xml: &mut Xml) -> io::Result<()> {
    element(xml, "Info", |xml| {
        element(xml, "StateMachine", |xml| {
            element(xml, "Timeout", |xml| {
                text(xml, "PreopTimeout", "2000")?;
                text(xml, "SafeopOpTimeout", "9000")?;
                text(xml, "BackToInitTimeout", "5000")?;
                text(xml, "BackToSafeopTimeout", "200")
            })
        })?;
        element(xml, "Mailbox", |xml| {
            element(xml, "Timeout", |xml| {
                text(xml, "RequestTimeout", "100")?;
                text(xml, "ResponseTimeout", "2000")
            })
        })
    })
}

/// The profile with the object dictionary: data types first, then objects.
fn profile(xml: &mut Xml) -> io::Result<()> {
    element(xml, "Profile", |xml| {
        text(xml, "ProfileNo", "402")?;
        element(xml, "Dictionary", |xml| {
            element(xml, "DataTypes", data_types)?;
            element(xml, "Objects", |xml| all_objects().try_for_each(|entries| object(xml, entries)))
        })
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
    let mut basic: BTreeSet<(String, u16)> = all_objects().flatten().map(|entry| (type_name(entry), bits(entry))).collect();
    basic.insert(("USINT".into(), 8));
    for (name, bits) in basic {
        element(xml, "DataType", |xml| {
            text(xml, "Name", &name)?;
            text(xml, "BitSize", &bits.to_string())
        })?;
    }
    all_objects()
        .filter(|entries| is_record(entries))
        .try_for_each(|entries| record_type(xml, entries))
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

fn object(xml: &mut Xml, entries: &[Entry]) -> io::Result<()> {
    let first = &entries[0];
    element(xml, "Object", |xml| {
        text(xml, "Index", &hex(first.index.into()))?;
        text(xml, "Name", first.object)?;
        if is_record(entries) {
            text(xml, "Type", &record_name(entries))?;
            text(xml, "BitSize", &record_bits(entries).to_string())?;
            return element(xml, "Info", |xml| record_defaults(xml, entries));
        }
        text(xml, "Type", &type_name(first))?;
        text(xml, "BitSize", &bits(first).to_string())?;
        element(xml, "Info", |xml| text(xml, "DefaultData", &default_data(first)))?;
        element(xml, "Flags", |xml| flags(xml, first))
    })
}

fn record_defaults(xml: &mut Xml, entries: &[Entry]) -> io::Result<()> {
    let count = match entries.iter().find(|entry| !entry.in_record()) {
        Some(count) => count.default,
        None => entries.last().map_or(0, |last| last.sub.into()),
    };
    sub_default(xml, "SubIndex 000", &format!("{count:02X}"))?;
    entries
        .iter()
        .filter(|entry| entry.in_record())
        .try_for_each(|entry| sub_default(xml, entry.name, &default_data(entry)))
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
    match entry.data_type.bits() {
        Some(bits) => bits.into(),
        None => 8 * string(entry).len() as u16,
    }
}

fn type_name(entry: &Entry) -> String {
    match entry.data_type {
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

/// The value at delivery as the bytes on the wire.
fn default_data(entry: &Entry) -> String {
    let digits = |bytes: &[u8]| bytes.iter().map(|byte| format!("{byte:02X}")).collect();
    match (entry.data_type, entry.index, entry.sub) {
        (DataType::VisibleString, ..) => digits(string(entry).as_bytes()),
        (_, 0x1000, 0) => digits(&identity::DEVICE_TYPE.to_le_bytes()),
        (_, 0x1018, 1) => digits(&identity::VENDOR.to_le_bytes()),
        (_, 0x1018, 2) => digits(&identity::PRODUCT.to_le_bytes()),
        (_, 0x1018, 3) => digits(&identity::REVISION.to_le_bytes()),
        _ => digits(&entry.default.to_le_bytes()[..entry.size()]),
    }
}

fn sync_manager(xml: &mut Xml, manager: &layout::SyncManager) -> io::Result<()> {
    let (name, is_mailbox) = match manager.usage {
        Usage::MailboxOut => ("MBoxOut", true),
        Usage::MailboxIn => ("MBoxIn", true),
        Usage::Outputs => ("Outputs", false),
        Usage::Inputs => ("Inputs", false),
    };
    let mut element = xml.create_element("Sm");
    if is_mailbox {
        element = element
            .with_attribute(("MinSize", hex(layout::MAILBOX_MIN.into()).as_str()))
            .with_attribute(("MaxSize", hex(layout::MAILBOX_MAX.into()).as_str()));
    }
    element
        .with_attribute(("DefaultSize", manager.length.to_string().as_str()))
        .with_attribute(("StartAddress", hex(manager.start.into()).as_str()))
        .with_attribute(("ControlByte", hex(manager.control.into()).as_str()))
        .with_attribute(("Enable", "1"))
        .write_text_content(BytesText::new(name))?;
    Ok(())
}

fn process_data(xml: &mut Xml, pdo: &Pdo, manager: u8) -> io::Result<()> {
    let assigned = layout::RX_ASSIGNMENT.contains(&pdo.index) || layout::TX_ASSIGNMENT.contains(&pdo.index);
    let mut element = xml
        .create_element(if manager == 2 { "RxPdo" } else { "TxPdo" })
        .with_attribute(("Fixed", "0"));
    let manager = manager.to_string();
    if assigned {
        element = element.with_attribute(("Sm", manager.as_str()));
    }
    element.write_inner_content(|xml| {
        text(xml, "Index", &hex(pdo.index.into()))?;
        text(xml, "Name", pdo.name)?;
        pdo.excludes
            .iter()
            .try_for_each(|other| text(xml, "Exclude", &hex((*other).into())))?;
        pdo.entries.iter().try_for_each(|mapping| pdo_entry(xml, *mapping))
    })?;
    Ok(())
}

fn pdo_entry(xml: &mut Xml, mapping: u32) -> io::Result<()> {
    element(xml, "Entry", |xml| {
        text(xml, "Index", &hex(mapping >> 16))?;
        text(xml, "SubIndex", &(mapping >> 8 & 0xFF).to_string())?;
        text(xml, "BitLen", &(mapping & 0xFF).to_string())?;
        match DriveObjects::ENTRIES.iter().find(|entry| entry.mapping() == mapping) {
            Some(entry) => {
                text(xml, "Name", entry.name)?;
                text(xml, "DataType", entry.data_type.esi_name())
            }
            None => Ok(()),
        }
    })
}

fn mailbox(xml: &mut Xml) -> io::Result<()> {
    xml.create_element("Mailbox")
        .with_attribute(("DataLinkLayer", "true"))
        .write_inner_content(|xml| {
            xml.create_element("CoE")
                .with_attribute(("SdoInfo", "false"))
                .with_attribute(("PdoAssign", "true"))
                .with_attribute(("PdoConfig", "true"))
                .with_attribute(("CompleteAccess", "false"))
                .with_attribute(("SegmentedSdo", "true"))
                .write_empty()?;
            Ok(())
        })?;
    Ok(())
}

fn clocks(xml: &mut Xml) -> io::Result<()> {
    element(xml, "Dc", |xml| {
        layout::CLOCK_MODES.iter().try_for_each(|mode| {
            element(xml, "OpMode", |xml| {
                text(xml, "Name", mode.name)?;
                text(xml, "Desc", mode.description)?;
                text(xml, "AssignActivate", &hex(mode.assign_activate.into()))?;
                if mode.assign_activate == 0 {
                    return Ok(());
                }
                xml.create_element("CycleTimeSync0")
                    .with_attribute(("Factor", "1"))
                    .write_text_content(BytesText::new("0"))?;
                text(xml, "ShiftTimeSync0", "0")
            })
        })
    })
}

/// What TwinCAT writes into a blank EEPROM: size and configuration area.
fn eeprom(xml: &mut Xml) -> io::Result<()> {
    const CONFIGURATION_AREA: usize = 14;
    let image = sii::image(0, 0);
    element(xml, "Eeprom", |xml| {
        text(xml, "ByteSize", &sii::SIZE.to_string())?;
        text(
            xml,
            "ConfigData",
            &image[..CONFIGURATION_AREA]
                .iter()
                .map(|byte| format!("{byte:02X}"))
                .collect::<String>(),
        )
    })
}

fn element(xml: &mut Xml, tag: &str, content: impl FnOnce(&mut Xml) -> io::Result<()>) -> io::Result<()> {
    xml.create_element(tag).write_inner_content(content)?;
    Ok(())
}

fn text(xml: &mut Xml, tag: &str, content: &str) -> io::Result<()> {
    xml.create_element(tag).write_text_content(BytesText::new(content))?;
    Ok(())
}

fn name(xml: &mut Xml, content: &str) -> io::Result<()> {
    xml.create_element("Name")
        .with_attribute(("LcId", ENGLISH))
        .write_text_content(BytesText::new(content))?;
    Ok(())
}

/// A group's type and its name, which are the same.
fn named(xml: &mut Xml, content: &str) -> io::Result<()> {
    text(xml, "Type", content)?;
    name(xml, content)
}

fn hex(number: u32) -> String {
    format!("#x{number:04X}")
}
