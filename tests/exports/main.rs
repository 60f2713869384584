//! SII, ESI and object dictionary: each as it was when it was last looked at, and all three of one mind.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use device::{identity, layout, sii};
use dictionary::DataType;
use drive::DriveObjects;
use wire::sii::{category, word};

const SERIAL: u32 = 0x0102_0304;
const ALIAS: u16 = 0x0506;

/// Compares with a file of `tests/golden`; `UPDATE_GOLDEN=1` writes it instead, for a change that is meant.
fn assert_golden(name: &str, contents: &[u8]) {
    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("golden").join(name);
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        fs::write(&file, contents).unwrap();
    }
    let golden = fs::read(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    assert!(
        golden == contents,
        "{} is no longer what is generated; if that is meant, run the tests with UPDATE_GOLDEN=1 and look at the difference",
        file.display()
    );
}

#[test]
fn the_esi_is_the_one_last_looked_at() {
    assert_golden("usr2556e.xml", usr2556e::esi::document().unwrap().as_bytes());
}

#[test]
fn the_sii_is_the_one_last_looked_at() {
    assert_golden("usr2556e.sii", &sii::image(1, 0));
}

/// An image taken apart without the code that made it.
struct Image(Vec<u8>);

impl Image {
    fn new() -> Self {
        Self(sii::image(SERIAL, ALIAS).to_vec())
    }

    fn word(&self, at: usize) -> u16 {
        u16::from_le_bytes([self.0[2 * at], self.0[2 * at + 1]])
    }

    fn double_word(&self, at: usize) -> u32 {
        u32::from(self.word(at)) | u32::from(self.word(at + 1)) << 16
    }

    fn categories(&self) -> BTreeMap<u16, Vec<u8>> {
        let mut categories = BTreeMap::new();
        let mut at = word::CATEGORIES;
        while self.word(at) != category::END {
            let length = usize::from(self.word(at + 1));
            let contents = self.0[2 * (at + 2)..2 * (at + 2 + length)].to_vec();
            assert!(categories.insert(self.word(at), contents).is_none(), "a category comes twice");
            at += 2 + length;
        }
        categories
    }

    fn strings(&self) -> Vec<String> {
        let bytes = &self.categories()[&category::STRINGS];
        let mut rest = &bytes[1..];
        (0..bytes[0])
            .map(|_| {
                let (text, behind) = rest[1..].split_at(usize::from(rest[0]));
                rest = behind;
                String::from_utf8(text.to_vec()).unwrap()
            })
            .collect()
    }

    /// PDOs of a category: index, sync manager, entries as mapping words, data types.
    fn pdos(&self, kind: u16) -> Vec<(u16, u8, Vec<u32>, Vec<u8>)> {
        let bytes = &self.categories()[&kind];
        let mut pdos = Vec::new();
        let mut rest = bytes.as_slice();
        while rest.len() >= 8 {
            let (head, behind) = rest.split_at(8);
            let (entries, behind) = behind.split_at(8 * usize::from(head[2]));
            let mapping = |e: &[u8]| u32::from(u16::from_le_bytes([e[0], e[1]])) << 16 | u32::from(e[2]) << 8 | u32::from(e[5]);
            pdos.push((
                u16::from_le_bytes([head[0], head[1]]),
                head[3],
                entries.chunks(8).map(mapping).collect(),
                entries.chunks(8).map(|e| e[4]).collect(),
            ));
            rest = behind;
        }
        pdos
    }
}

#[test]
fn the_sii_says_who_the_device_is() {
    let image = Image::new();
    assert!(wire::sii::is_intact(&image.0));
    let numbers = [0, 2, 4, 6].map(|at| image.double_word(word::IDENTITY + at));
    assert_eq!(numbers, [identity::VENDOR, identity::PRODUCT, identity::REVISION, SERIAL]);
    assert_eq!(image.word(word::STATION_ALIAS), ALIAS);
    assert_eq!(image.word(word::SIZE), 15, "2 kB are 16 kbit");
    assert_eq!(image.strings()[0], "USR2556E", "masters show string 1 as the name");
    assert!(image.strings().iter().all(|text| !text.is_empty() && text.len() <= 40));
}

#[test]
fn the_sii_names_mailboxes_sync_managers_and_fmmus_alike() {
    let image = Image::new();
    let managers = &image.categories()[&category::SYNC_MANAGERS];
    let manager = |n: usize| {
        (
            u16::from_le_bytes([managers[8 * n], managers[8 * n + 1]]),
            u16::from_le_bytes([managers[8 * n + 2], managers[8 * n + 3]]),
        )
    };
    for n in 0..2 {
        assert_eq!(
            manager(n),
            (image.word(word::MAILBOXES + 2 * n), image.word(word::MAILBOXES + 2 * n + 1))
        );
    }
    assert_eq!([0, 1, 2, 3].map(|n| managers[8 * n + 4]), [0x26, 0x22, 0x64, 0x20], "control bytes");
    assert_eq!([0, 1, 2, 3].map(|n| managers[8 * n + 7]), [1, 2, 3, 4], "types");
    assert_eq!((manager(2), manager(3)), ((0x1100, 7), (0x1400, 11)), "the default process data");
    assert_eq!(image.categories()[&category::FMMU], [3, 1, 2, 0]);
    let general = &image.categories()[&category::GENERAL];
    assert_eq!(general.len(), 32);
    assert_eq!(
        general[5], 0x2F,
        "SDO, SDO information, PDO assignment, PDO configuration, complete access"
    );
    assert_eq!(general[6], 1, "FoE");
    assert_eq!(image.word(word::MAILBOX_PROTOCOLS), 0x000C, "CoE and FoE");
    assert_eq!(
        general[11], 0x0C,
        "mailbox messages are repeated, the device identifies itself in the AL status code"
    );
}

#[test]
fn the_pdos_of_the_sii_are_those_of_the_object_dictionary() {
    let image = Image::new();
    let mut device = device::Device::new(SERIAL);
    let mut read = |index: u16, sub: u8| {
        let mut bytes = [0; device::MAX_OBJECT_SIZE];
        let length = device.read_object(index, sub, wire::Nanos(0), &mut bytes).unwrap();
        bytes[..length]
            .iter()
            .rev()
            .fold(0_u32, |value, byte| value << 8 | u32::from(*byte))
    };
    for (kind, assignment, manager) in [(category::RX_PDO, 0x1C12, 2), (category::TX_PDO, 0x1C13, 3)] {
        let assigned: Vec<u32> = (1..=read(assignment, 0)).map(|sub| read(assignment, sub as u8)).collect();
        let pdos = image.pdos(kind);
        assert_eq!(pdos.len(), 3);
        for (index, sync_manager, entries, types) in pdos {
            let mapped: Vec<u32> = (1..=read(index, 0)).map(|sub| read(index, sub as u8)).collect();
            assert_eq!(entries, mapped, "{index:#06x}");
            assert_eq!(sync_manager == manager, assigned.contains(&index.into()), "{index:#06x}");
            for (mapping, data_type) in entries.iter().zip(types) {
                let entry = DriveObjects::ENTRIES.iter().find(|entry| entry.mapping() == *mapping).unwrap();
                assert_eq!(entry.data_type.code(), data_type.into(), "{mapping:#010x}");
            }
        }
    }
}

#[test]
fn the_esi_holds_every_object_of_the_dictionary() {
    let esi = usr2556e::esi::document().unwrap();
    let start = esi.find("<Objects>").unwrap();
    let objects = &esi[start..];
    for entry in slave::objects::ENTRIES.iter().chain(DriveObjects::ENTRIES) {
        assert!(
            objects.contains(&format!("<Index>#x{:04X}</Index>", entry.index)),
            "{:#06x}",
            entry.index
        );
    }
    for expected in [
        "<Id>#x0A88</Id>",
        "ProductCode=\"#xA880001\" RevisionNo=\"#x0204\"",
        "<AssignActivate>#x0300</AssignActivate>",
        "DefaultSize=\"7\" StartAddress=\"#x1100\" ControlByte=\"#x0064\"",
        "<FoE/>",
        "DefaultSize=\"11\" StartAddress=\"#x1400\" ControlByte=\"#x0020\"",
    ] {
        assert!(esi.contains(expected), "{expected}");
    }
}

#[test]
fn the_esi_has_the_text_of_every_diagnosis_message() {
    let esi = usr2556e::esi::document().unwrap();
    for message in slave::event_log::MESSAGES {
        let (_, behind) = esi.split_once(&format!("<TextId>#x{:04X}</TextId>", message.id)).unwrap();
        let expected = format!("<MessageText>{}</MessageText>", message.text);
        assert!(behind.trim_start().starts_with(&expected), "{expected}");
    }
}

#[test]
fn every_mapped_object_may_be_mapped() {
    for (pdos, mappable) in [
        (layout::RX_PDOS, dictionary::Access::is_rx_mappable as fn(_) -> _),
        (layout::TX_PDOS, dictionary::Access::is_tx_mappable),
    ] {
        for mapping in pdos.iter().flat_map(|pdo| pdo.entries) {
            let entry = DriveObjects::ENTRIES.iter().find(|entry| entry.mapping() == *mapping).unwrap();
            assert!(
                mappable(entry.access) && entry.data_type != DataType::VisibleString,
                "{mapping:#010x}"
            );
        }
    }
}
