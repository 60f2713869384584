//! SII, ESI and what the drive answers say the same of sync managers, PDOs, clocks and mailbox.

use device::{layout, sii};
use ethercrab::{SubDevice, SubDeviceRef};
use rig::Rig;
use rig::esi::Element;
use usr2556e::drive::DriveConfig;
use usr2556e::master::sdo::{self, Address};
use wire::sii::{category, word};

use crate::dictionaries::type_code;
use crate::image::{Image, Pdo};

/// The unit for which the ESI is written: serial number 0.
pub fn rig() -> Rig {
    Rig::with([DriveConfig {
        serial: 0,
        ..DriveConfig::numbered(0)
    }])
}

fn in_preop(test: impl AsyncFnOnce(&SubDeviceRef<'_, &SubDevice>)) {
    rig().in_preop(async |main, _, group| test(&group.subdevice(main, 0).unwrap()).await);
}

async fn read(drive: &SubDeviceRef<'_, &SubDevice>, index: u16, sub: u8) -> u32 {
    let bytes = sdo::read(drive, Address { index, sub }).await.unwrap();
    bytes.iter().rev().fold(0, |value, byte| value << 8 | u32::from(*byte))
}

fn image() -> Image {
    Image(sii::image(0, 0).to_vec())
}

fn device(esi: &Element) -> &Element {
    esi.find("Descriptions/Devices/Device").unwrap()
}

#[test]
fn all_three_tell_the_same_identity() {
    let (esi, image) = (Element::document(), image());
    let kind = device(&esi).find("Type").unwrap();
    let numbers = [
        esi.number("Vendor/Id"),
        kind.attribute_number("ProductCode"),
        kind.attribute_number("RevisionNo"),
        0,
    ];
    assert_eq!(numbers, [0, 2, 4, 6].map(|at| image.double_word(word::IDENTITY + at)));
    let general = &image.categories()[&category::GENERAL];
    assert_eq!(image.string(general[0]), device(&esi).text("GroupType"));
    assert_eq!(
        [general[2], general[3]].map(|number| image.string(number)),
        [&kind.text, device(&esi).text("Name")]
    );
    in_preop(async |drive| {
        for (sub, number) in (1..).zip(numbers) {
            assert_eq!(read(drive, 0x1018, sub).await, number, "0x1018:{sub:02X}");
        }
    });
}

#[test]
fn all_three_set_up_sync_managers_and_fmmus_alike() {
    let (esi, image) = (Element::document(), image());
    let categories = image.categories();
    let in_sii: Vec<_> = categories[&category::SYNC_MANAGERS]
        .chunks(8)
        .map(|sm| {
            [
                u16::from_le_bytes([sm[0], sm[1]]).into(),
                u16::from_le_bytes([sm[2], sm[3]]).into(),
                sm[4].into(),
                sm[6].into(),
                u32::from(sm[7]),
            ]
        })
        .collect();
    let usages = ["", "MBoxOut", "MBoxIn", "Outputs", "Inputs"];
    let usage = |name: &str| usages.iter().position(|usage| *usage == name).unwrap() as u32;
    let managers = device(&esi).all("Sm");
    let in_esi: Vec<_> = managers
        .iter()
        .map(|sm| {
            let [start, length, control, enable] =
                ["StartAddress", "DefaultSize", "ControlByte", "Enable"].map(|name| sm.attribute_number(name));
            [start, length, control, enable, usage(&sm.text)]
        })
        .collect();
    assert_eq!(in_esi, in_sii);
    for mailbox in &managers[..2] {
        let limits = ["MinSize", "MaxSize"].map(|name| mailbox.attribute_number(name));
        assert_eq!(limits, [layout::MAILBOX_MIN.into(), layout::MAILBOX_MAX.into()]);
    }

    let names = ["", "Outputs", "Inputs", "MBoxState"];
    let fmmus = device(&esi).all("Fmmu");
    let codes: Vec<u8> = fmmus
        .iter()
        .map(|fmmu| names.iter().position(|name| *name == fmmu.text).unwrap() as u8)
        .collect();
    assert_eq!(codes[..], categories[&category::FMMU][..codes.len()]);
    for fmmu in fmmus.iter().filter(|fmmu| fmmu.attribute("Sm").is_some()) {
        assert_eq!(managers[fmmu.attribute_number("Sm") as usize].text, fmmu.text);
    }
    in_preop(async |drive| {
        assert_eq!(read(drive, 0x1C00, 0).await as usize, in_esi.len());
        for (sub, [.., usage]) in (1..).zip(&in_esi) {
            assert_eq!(read(drive, 0x1C00, sub).await, *usage, "0x1C00:{sub:02X}");
        }
        // The chip that the drive has says how many there are at most: registers 0x0004 to 0x0006.
        let counts: [u8; 3] = drive.register_read(0x0004_u16).await.unwrap();
        let controller = device(&esi).find("Info/EtherCATController").unwrap();
        let in_esi = ["FmmuCount", "SmCount", "DpramSize"].map(|name| controller.number(name));
        assert_eq!(in_esi, [counts[0].into(), counts[1].into(), 1024 * u32::from(counts[2])]);
    });
}

fn pdo(element: &Element) -> Pdo {
    let entry = |entry: &&Element| {
        let mapping = entry.number("Index") << 16 | entry.number("SubIndex") << 8 | entry.number("BitLen");
        (mapping, entry.text("Name").to_owned(), type_code(entry.text("DataType")))
    };
    Pdo {
        index: element.number("Index") as u16,
        name: element.text("Name").to_owned(),
        manager: element.attribute("Sm").map(|manager| manager.parse().unwrap()),
        entries: element.all("Entry").iter().map(entry).collect(),
    }
}

#[test]
fn all_three_have_the_same_pdos_and_assignment() {
    let (esi, image) = (Element::document(), image());
    in_preop(async |drive| {
        for (tag, kind, assignment) in [("RxPdo", category::RX_PDO, 0x1C12), ("TxPdo", category::TX_PDO, 0x1C13)] {
            let pdos: Vec<Pdo> = device(&esi).all(tag).into_iter().map(pdo).collect();
            assert_eq!(pdos, image.pdos(kind));
            let mut assigned = Vec::new();
            for sub in 1..=read(drive, assignment, 0).await {
                assigned.push(read(drive, assignment, sub as u8).await);
            }
            for pdo in &pdos {
                let mut mapped = Vec::new();
                for sub in 1..=read(drive, pdo.index, 0).await {
                    mapped.push(read(drive, pdo.index, sub as u8).await);
                }
                let described: Vec<u32> = pdo.entries.iter().map(|(mapping, ..)| *mapping).collect();
                assert_eq!(described, mapped, "{:#06x}", pdo.index);
                assert_eq!(pdo.manager.is_some(), assigned.contains(&pdo.index.into()), "{:#06x}", pdo.index);
            }
        }
    });
}

#[test]
fn pdos_that_exclude_each_other_do_so_both_ways_and_are_not_assigned_together() {
    let esi = Element::document();
    for tag in ["RxPdo", "TxPdo"] {
        let pdos = device(&esi).all(tag);
        let excluded = |pdo: &Element| -> Vec<u32> { pdo.all("Exclude").iter().map(|exclude| exclude.number_here()).collect() };
        for one in &pdos {
            for index in excluded(one) {
                let other = pdos
                    .iter()
                    .find(|pdo| pdo.number("Index") == index)
                    .expect("one of the same direction");
                assert!(excluded(other).contains(&one.number("Index")), "{index:#06x}");
                assert!(one.attribute("Sm").is_none() || other.attribute("Sm").is_none(), "{index:#06x}");
            }
        }
    }
}

#[test]
fn esi_and_sii_offer_the_same_clock_modes() {
    let (esi, image) = (Element::document(), image());
    let modes = device(&esi).all("Dc/OpMode");
    let in_sii = &image.categories()[&category::DC];
    assert_eq!(in_sii.len(), 24 * modes.len());
    for (mode, bytes) in modes.iter().zip(in_sii.chunks(24)) {
        assert_eq!(mode.number("AssignActivate"), u16::from_le_bytes([bytes[14], bytes[15]]).into());
        assert_eq!(
            [mode.text("Name"), mode.text("Desc")],
            [bytes[18], bytes[19]].map(|number| image.string(number)).each_ref()
        );
        let Some(cycle) = mode.find("CycleTimeSync0") else {
            assert_eq!(mode.number("AssignActivate"), 0, "without SYNC0");
            continue;
        };
        let times = [cycle.text.as_str(), mode.text("ShiftTimeSync0")];
        let [cycle_in_sii, shift_in_sii] = [0, 4].map(|at| i32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()));
        assert_eq!(times.map(|time| time.parse::<i32>().unwrap()), [cycle_in_sii, shift_in_sii]);
        assert_eq!(cycle.attribute_number("Factor"), u16::from_le_bytes([bytes[16], bytes[17]]).into());
    }
}

#[test]
fn esi_and_sii_announce_the_same_mailbox_and_eeprom() {
    let (esi, image) = (Element::document(), image());
    let general = &image.categories()[&category::GENERAL];
    let mailbox = device(&esi).find("Mailbox").unwrap();
    let protocols = image.word(word::MAILBOX_PROTOCOLS);
    for (tag, bit) in [("AoE", 0), ("EoE", 1), ("CoE", 2), ("FoE", 3), ("SoE", 4), ("VoE", 5)] {
        assert_eq!(mailbox.find(tag).is_some(), protocols >> bit & 1 != 0, "{tag}");
    }
    assert_eq!(general[6] != 0, mailbox.find("FoE").is_some());
    assert_eq!(general[7] != 0, mailbox.find("EoE").is_some());
    let coe = mailbox.find("CoE").unwrap();
    for (name, bit) in [
        ("SdoInfo", 1),
        ("PdoAssign", 2),
        ("PdoConfig", 3),
        ("PdoUpload", 4),
        ("CompleteAccess", 5),
    ] {
        assert_eq!(coe.is_true(name), general[5] >> bit & 1 != 0, "{name}");
    }
    assert_eq!(mailbox.is_true("DataLinkLayer"), general[11] >> 2 & 1 != 0);
    let identifies = device(&esi)
        .find("Info/IdentificationReg134")
        .is_some_and(|element| element.text == "true");
    assert_eq!(identifies, general[11] >> 3 & 1 != 0);

    let eeprom = device(&esi).find("Eeprom").unwrap();
    assert_eq!(eeprom.number("ByteSize"), 128 * (u32::from(image.word(word::SIZE)) + 1));
    let configuration: String = image.0[..14].iter().map(|byte| format!("{byte:02X}")).collect();
    assert_eq!(eeprom.text("ConfigData"), configuration);
}

#[test]
fn init_commands_are_taken_in_preop() {
    let esi = Element::document();
    in_preop(async |drive| {
        let commands = device(&esi).all("Mailbox/CoE/InitCmd");
        assert!(!commands.is_empty());
        for command in commands {
            assert_eq!(command.text("Transition"), "PS");
            let address = Address {
                index: command.number("Index") as u16,
                sub: command.number("SubIndex") as u8,
            };
            let data = command.text("Data");
            let data: Vec<u8> = (0..data.len())
                .step_by(2)
                .map(|at| u8::from_str_radix(&data[at..at + 2], 16).unwrap())
                .collect();
            sdo::write(drive, address, &data).await.unwrap();
            assert_eq!(sdo::read(drive, address).await.unwrap(), data, "{address}");
        }
    });
}
