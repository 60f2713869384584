//! The SII image of the device, made from identity, layout and object table (ETG.1000.6, ETG.2010).

use drive::DriveObjects;
use heapless::Vec;
use wire::sii::{PROTOCOL_COE, PROTOCOL_FOE, Writer, category, is_intact, word};

use crate::{identity, layout};

/// Size of the EEPROM in bytes.
pub const SIZE: usize = 2048;

/// PDI control 0x05 (SPI) and ESC configuration 0x0C (SYNC and latch units on).
const PDI_AND_ESC_CONFIGURATION: u16 = 0x0C05;
/// SPI mode and SYNC outputs that raise AL events.
const PDI_CONFIGURATION: u16 = 0xEE03;
/// 10 us in units of 10 ns.
const SYNC_PULSE_LENGTH: u16 = 1000;
/// CoE details: SDO (bit 0), SDO information (bit 1), PDO assignment (bit 2), PDO configuration (bit 3), complete access (bit 5).
pub const COE_DETAILS: u8 = 0x01 | 0x02 | 0x04 | 0x08 | 0x20;
/// FoE details: there is FoE.
pub const FOE_DETAILS: u8 = 1;
/// General flags: the data link layer of the mailbox repeats lost messages (bit 2), the device identifies itself in the AL status code
/// (bit 3).
const GENERAL_FLAGS: u8 = 0x04 | 0x08;
/// Ports 0 and 1 are MII, one nibble each.
const PHYSICAL_PORTS: u16 = 0x0011;

/// Strings of the image; a string's number is its position here plus one, 0 is none.
struct Strings(Vec<&'static str, 40>);

impl Strings {
    fn number(&self, text: &str) -> u8 {
        self.0.iter().position(|known| *known == text).map_or(0, |at| at as u8 + 1)
    }

    fn add(&mut self, text: &'static str) {
        if self.number(text) == 0 {
            // A string that finds no place is left out, and its number reads 0: none.
            let _ = self.0.push(text);
        }
    }

    /// All strings the image names. The device's name comes first: some masters show string 1.
    fn collect() -> Self {
        let mut strings = Self(Vec::new());
        strings.add(identity::NAME);
        strings.add(identity::GROUP);
        for mode in layout::CLOCK_MODES {
            strings.add(mode.name);
            strings.add(mode.description);
        }
        for pdo in layout::RX_PDOS.iter().chain(&layout::TX_PDOS) {
            strings.add(pdo.name);
            for entry in pdo.entries.iter().filter_map(|mapping| entry(*mapping)) {
                strings.add(entry.name);
            }
        }
        strings
    }
}

/// The object dictionary's entry that a mapping names.
fn entry(mapping: u32) -> Option<&'static dictionary::Entry> {
    DriveObjects::ENTRIES.iter().find(|entry| entry.mapping() == mapping)
}

/// The image of a unit with this serial number and station alias, as it leaves the factory.
pub fn image(serial: u32, alias: u16) -> [u8; SIZE] {
    let mut image = [0; SIZE];
    // All contents are constants but for two numbers of fixed length, and a test writes them.
    let fits = write(&mut image, serial, alias);
    debug_assert!(fits.is_ok() && is_intact(&image));
    image
}

fn write(image: &mut [u8; SIZE], serial: u32, alias: u16) -> Result<(), wire::sii::ImageFull> {
    let mut writer = Writer::new(image)?;
    write_fixed_area(&mut writer, serial, alias);
    let strings = Strings::collect();
    writer.category(category::STRINGS, |w| {
        w.u8(strings.0.len() as u8);
        for text in &strings.0 {
            w.u8(text.len() as u8);
            w.bytes(text.as_bytes());
        }
    });
    writer.category(category::GENERAL, |w| write_general(w, &strings));
    writer.category(category::FMMU, |w| w.bytes(&layout::FMMUS));
    writer.category(category::SYNC_MANAGERS, write_sync_managers);
    writer.category(category::TX_PDO, |w| {
        write_pdos(w, &layout::TX_PDOS, &layout::TX_ASSIGNMENT, 3, &strings)
    });
    writer.category(category::RX_PDO, |w| {
        write_pdos(w, &layout::RX_PDOS, &layout::RX_ASSIGNMENT, 2, &strings)
    });
    writer.category(category::DC, |w| write_clock_modes(w, &strings));
    writer.finish()
}

fn write_fixed_area(writer: &mut Writer, serial: u32, alias: u16) {
    writer.set_word(word::PDI_CONTROL, PDI_AND_ESC_CONFIGURATION);
    writer.set_word(word::PDI_CONFIGURATION, PDI_CONFIGURATION);
    writer.set_word(word::SYNC_PULSE_LENGTH, SYNC_PULSE_LENGTH);
    writer.set_word(word::STATION_ALIAS, alias);
    for (i, number) in [identity::VENDOR, identity::PRODUCT, identity::REVISION, serial]
        .into_iter()
        .enumerate()
    {
        writer.set_double_word(word::IDENTITY + 2 * i, number);
    }
    for (i, mailbox) in layout::SYNC_MANAGERS[..2].iter().enumerate() {
        writer.set_word(word::MAILBOXES + 2 * i, mailbox.start);
        writer.set_word(word::MAILBOXES + 2 * i + 1, mailbox.length);
    }
    writer.set_word(word::MAILBOX_PROTOCOLS, PROTOCOL_COE | PROTOCOL_FOE);
}

/// The general category: 32 bytes, neither more nor fewer (IgH checks).
fn write_general(w: &mut Writer, strings: &Strings) {
    let name = strings.number(identity::NAME);
    let group = strings.number(identity::GROUP);
    w.bytes(&[group, 0, name, name, 0, COE_DETAILS, FOE_DETAILS, 0, 0, 1, 0, GENERAL_FLAGS]);
    w.u16(0); // no current is drawn from an E-bus
    w.bytes(&[group, 0]);
    w.u16(PHYSICAL_PORTS);
    w.bytes(&[0; 14]);
}

fn write_sync_managers(w: &mut Writer) {
    const ENABLED: u8 = 1;
    for manager in layout::SYNC_MANAGERS {
        w.u16(manager.start);
        w.u16(manager.length);
        w.bytes(&[manager.control, 0, ENABLED, manager.usage as u8]);
    }
}

fn write_pdos(w: &mut Writer, pdos: &[layout::Pdo], assigned: &[u16], sync_manager: u8, strings: &Strings) {
    const UNASSIGNED: u8 = 0xFF;
    for pdo in pdos {
        let manager = if assigned.contains(&pdo.index) { sync_manager } else { UNASSIGNED };
        w.u16(pdo.index);
        w.bytes(&[pdo.entries.len() as u8, manager, 0, strings.number(pdo.name), 0, 0]);
        for &mapping in pdo.entries {
            let (name, data_type) = entry(mapping).map_or((0, 0), |entry| (strings.number(entry.name), entry.data_type.code()));
            w.u16((mapping >> 16) as u16);
            w.bytes(&[(mapping >> 8) as u8, name, data_type as u8, mapping as u8, 0, 0]);
        }
    }
}

fn write_clock_modes(w: &mut Writer, strings: &Strings) {
    for mode in layout::CLOCK_MODES {
        w.u32(0); // SYNC0 cycle: the bus cycle times the factor
        w.bytes(&[0; 8]); // no shifts
        w.u16(0); // factor of SYNC1
        w.u16(mode.assign_activate);
        w.u16(1); // factor of SYNC0
        w.bytes(&[strings.number(mode.name), strings.number(mode.description), 0, 0, 0, 0]);
    }
}
