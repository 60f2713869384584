//! The ESI file (EtherCAT slave information, ETG.2000), made from identity, layout and object tables.
//!
//! | module | holds |
//! |---|---|
//! | here | the device: identity, sync managers, PDOs, mailbox, clocks |
//! | `dictionary` | its object dictionary, and the texts of its diagnosis messages |
//! | `xml` | the few shapes of XML that take part |

mod dictionary;
mod xml;

use std::io;

use device::layout::{self, Pdo, Usage};
use device::{identity, sii};
use drive::DriveObjects;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};

use self::dictionary::profile;
use self::xml::{Xml, digits, element, hex, name, named, text};

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
        })?;
        text(xml, "IdentificationReg134", "true")
    })
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
                .with_attribute(("SdoInfo", "true"))
                .with_attribute(("PdoAssign", "true"))
                .with_attribute(("PdoConfig", "true"))
                .with_attribute(("CompleteAccess", "true"))
                .with_attribute(("SegmentedSdo", "true"))
                .write_empty()?;
            xml.create_element("FoE").write_empty()?;
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
        text(xml, "ConfigData", &digits(&image[..CONFIGURATION_AREA]))
    })
}
