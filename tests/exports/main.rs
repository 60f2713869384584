//! SII, ESI and object dictionary: each as it was when it was last looked at, and all three of one mind.

mod agreement;
mod dictionaries;
mod image;
#[path = "../ethercrab/raw_mailbox.rs"]
mod raw_mailbox;

use std::fs;
use std::path::PathBuf;

use device::{identity, layout, sii};
use dictionary::DataType;
use drive::DriveObjects;
use wire::sii::{category, word};

use self::image::Image;

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

#[test]
fn the_sii_says_who_the_device_is() {
    let image = Image(sii::image(SERIAL, ALIAS).to_vec());
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
    let image = Image(sii::image(SERIAL, ALIAS).to_vec());
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
