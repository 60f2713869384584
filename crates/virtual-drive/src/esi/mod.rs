//! The ESI file (EtherCAT slave information, ETG.2000), made from identity, layout and object tables.
//!
//! | module | holds |
//! |---|---|
//! | here | the device: identity, sync managers, PDOs, mailbox, clocks |
//! | `dictionary` | its objects, and the texts of its diagnosis messages |
//! | `data_types` | their types |
//! | `xml` | the few shapes of XML that take part |

mod data_types;
mod dictionary;
mod xml;

use std::io;

use device::layout::{self, InitCommand, Pdo, Usage};
use device::{identity, sii};
use drive::DriveObjects;
use esc::{Chip, ChipConfig};
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};
use wire::{EscAccess, register};

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
                fmmu(xml, usage)?;
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
                text(xml, "PreopTimeout", &layout::TIMEOUTS.preop_ms.to_string())?;
                text(xml, "SafeopOpTimeout", &layout::TIMEOUTS.op_ms.to_string())?;
                text(xml, "BackToInitTimeout", &layout::TIMEOUTS.back_to_init_ms.to_string())?;
                text(xml, "BackToSafeopTimeout", &layout::TIMEOUTS.back_to_safeop_ms.to_string())
            })
        })?;
        element(xml, "Mailbox", |xml| {
            element(xml, "Timeout", |xml| {
                text(xml, "RequestTimeout", &layout::TIMEOUTS.mailbox_request_ms.to_string())?;
                text(xml, "ResponseTimeout", &layout::TIMEOUTS.mailbox_response_ms.to_string())
            })
        })?;
        element(xml, "EtherCATController", controller)?;
        text(xml, "IdentificationReg134", "true")
    })
}

/// What the slave controller says of itself.
fn controller(xml: &mut Xml) -> io::Result<()> {
    let mut chip = Chip::new(ChipConfig {
        eeprom: sii::image(0, 0),
        clock_offset_ns: 0,
        clock_ppb: 0,
    });
    let mut counts = [0; 3];
    chip.read(register::FMMU_COUNT, &mut counts);
    let [fmmus, sync_managers, kilobytes] = counts;
    text(xml, "DpramSize", &(1024 * u32::from(kilobytes)).to_string())?;
    text(xml, "SmCount", &sync_managers.to_string())?;
    text(xml, "FmmuCount", &fmmus.to_string())
}

fn fmmu(xml: &mut Xml, usage: u8) -> io::Result<()> {
    let (name, manager) = match usage {
        1 => ("Outputs", Some(Usage::Outputs)),
        2 => ("Inputs", Some(Usage::Inputs)),
        _ => ("MBoxState", None),
    };
    let mut element = xml.create_element("Fmmu");
    if let Some(position) = layout::SYNC_MANAGERS.iter().position(|sm| Some(sm.usage) == manager) {
        element = element.with_attribute(("Sm", position.to_string().as_str()));
    }
    element.write_text_content(BytesText::new(name))?;
    Ok(())
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
                .with_attribute(("DiagHistory", "true"))
                .write_inner_content(|xml| layout::INIT_COMMANDS.iter().try_for_each(|command| init_command(xml, command)))?;
            xml.create_element("FoE").write_empty()?;
            Ok(())
        })?;
    Ok(())
}

fn init_command(xml: &mut Xml, command: &InitCommand) -> io::Result<()> {
    element(xml, "InitCmd", |xml| {
        text(xml, "Transition", command.transition)?;
        text(xml, "Index", &hex(command.index.into()))?;
        text(xml, "SubIndex", &command.sub.to_string())?;
        text(xml, "Data", &digits(command.data))?;
        text(xml, "Comment", command.comment)
    })
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
