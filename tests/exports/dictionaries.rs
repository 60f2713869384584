//! The dictionary in the ESI beside that which the drive itself describes by SDO information.

use std::collections::BTreeMap;

use ethercrab::{SubDevice, SubDeviceRef};
use rig::esi::Element;
use usr2556e::master::sdo::{self, Address};
use wire::coe::information::value_info::{DEFAULT, MAXIMUM, MINIMUM, UNIT};

use crate::agreement::rig;
use crate::raw_mailbox::inform;

const VISIBLE_STRING: u16 = 9;
const OCTET_STRING: u16 = 10;

/// The data type with this name in an ESI (ETG.2000; ETG.1000.6, basic data types).
pub fn type_code(name: &str) -> u16 {
    match name {
        "BOOL" => 1,
        "SINT" => 2,
        "INT" => 3,
        "DINT" => 4,
        "USINT" => 5,
        "UINT" => 6,
        "UDINT" => 7,
        "ULINT" => 0x1B,
        name if name.starts_with("STRING(") => VISIBLE_STRING,
        name if name.ends_with("] OF BYTE") => OCTET_STRING,
        name => panic!("{name} is no basic type"),
    }
}

/// What a dictionary says of one entry.
#[derive(Debug, Default, PartialEq, Eq)]
struct Facts {
    object: String,
    name: String,
    data_type: u16,
    bits: u32,
    access: &'static str,
    /// Into RxPDOs, into TxPDOs.
    mappable: [bool; 2],
    backup: bool,
    setting: bool,
    unit: Option<u32>,
    default: String,
    limits: [String; 2],
}

type Dictionary = BTreeMap<(u32, u32), Facts>;

fn digits(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02X}")).collect()
}

/// The limits of a type: what an ESI does not repeat.
fn limits_of_type(data_type: u16, bits: u32) -> [String; 2] {
    let bytes = bits.div_ceil(8) as usize;
    let all = vec![0xFF; bytes];
    let mut most = all.clone();
    let mut least = vec![0; bytes];
    match data_type {
        VISIBLE_STRING | OCTET_STRING => return Default::default(),
        1 => most = vec![1],
        2..=4 => (most[bytes - 1], least[bytes - 1]) = (0x7F, 0x80),
        _ => {}
    }
    [digits(&least), digits(&most)]
}

fn described(flags: &Element, facts: Facts) -> Facts {
    let access = flags.find("Access").unwrap();
    let text = |tag| flags.find(tag).map(|element| element.text.as_str());
    let mapping = text("PdoMapping").unwrap_or_default();
    Facts {
        access: match (access.text.as_str(), access.attribute("WriteRestrictions")) {
            ("ro", None) => "ro",
            ("rw", None) => "rw",
            ("rw", Some("PreOP")) => "rw in PREOP",
            other => panic!("{other:?}"),
        },
        mappable: ["R", "T"].map(|direction| mapping.contains(direction)),
        backup: text("Backup") == Some("1"),
        setting: text("Setting") == Some("1"),
        ..facts
    }
}

fn with_values(info: &Element, facts: Facts) -> Facts {
    let text = |tag| info.find(tag).map(|element| element.text.clone());
    let default = text("DefaultData").unwrap();
    let limits = match (text("MinData"), text("MaxData")) {
        (Some(least), Some(most)) => [least, most],
        (None, None) if facts.access == "ro" && facts.name == "SubIndex 000" => [default.clone(), default.clone()],
        (None, None) => limits_of_type(facts.data_type, facts.bits),
        one => panic!("{one:?}"),
    };
    Facts {
        unit: info.find("Unit").map(|_| info.number("Unit")),
        default,
        limits,
        ..facts
    }
}

/// The dictionary of the ESI, entry by entry.
fn in_esi() -> Dictionary {
    let esi = Element::document();
    let dictionary = esi.find("Descriptions/Devices/Device/Profile/Dictionary").unwrap();
    let types: BTreeMap<&str, &Element> = dictionary
        .all("DataTypes/DataType")
        .into_iter()
        .map(|kind| (kind.text("Name"), kind))
        .collect();
    let mut entries = Dictionary::new();
    for object in dictionary.all("Objects/Object") {
        let (index, kind) = (object.number("Index"), types[object.text("Type")]);
        assert_eq!(object.text("BitSize"), kind.text("BitSize"), "{index:04X}");
        let facts = |name: &str, kind: &Element| Facts {
            object: object.text("Name").to_owned(),
            name: name.to_owned(),
            data_type: type_code(kind.text("Name")),
            bits: kind.number("BitSize"),
            ..Facts::default()
        };
        let values = object.all("Info/SubItem");
        if values.is_empty() {
            let entry = described(object.find("Flags").unwrap(), facts(object.text("Name"), kind));
            entries.insert((index, 0), with_values(object.find("Info").unwrap(), entry));
            continue;
        }
        let mut values = values.into_iter();
        let mut add = |sub, flags: &Element, kind: &Element| {
            let value = values.next().unwrap();
            let entry = described(flags, facts(value.text("Name"), kind));
            entries.insert((index, sub), with_values(value.find("Info").unwrap(), entry));
        };
        let mut offset = 0;
        for item in kind.all("SubItem") {
            let (member, flags) = (types[item.text("Type")], item.find("Flags").unwrap());
            assert_eq!(
                (item.number("BitOffs"), item.text("BitSize")),
                (offset, member.text("BitSize")),
                "{index:04X}"
            );
            offset = if offset == 0 { 16 } else { offset + member.number("BitSize") };
            if item.find("SubIdx").is_some() {
                add(item.number("SubIdx"), flags, member);
            } else {
                let first = member.number("ArrayInfo/LBound");
                let elements = first..first + member.number("ArrayInfo/Elements");
                elements.for_each(|sub| add(sub, flags, types[member.text("BaseType")]));
            }
        }
        assert!(values.next().is_none(), "{index:04X}");
        assert_eq!(offset.next_multiple_of(8), kind.number("BitSize"), "{index:04X}");
    }
    entries
}

fn word(bytes: &[u8]) -> u16 {
    u16::from_le_bytes([bytes[0], bytes[1]])
}

/// One entry as the drive describes it; `None` for a sub-index that does not exist.
async fn from_drive(drive: &SubDeviceRef<'_, &SubDevice>, index: u16, sub: u8, object: &str) -> Option<Facts> {
    let [low, high] = index.to_le_bytes();
    let answer = inform(drive, &[5, 0, 0, 0, low, high, sub, UNIT | DEFAULT | MINIMUM | MAXIMUM])
        .await
        .remove(0);
    if answer[0] == 7 {
        return None;
    }
    let (sent, data_type, bits, access) = (answer[7], word(&answer[8..]), word(&answer[10..]), word(&answer[12..]));
    let mut rest = &answer[14..];
    let mut take = |flag: u8, size: usize| {
        let (value, behind) = rest.split_at(if sent & flag == 0 { 0 } else { size });
        rest = behind;
        value.to_vec()
    };
    let unit = take(UNIT, 4);
    let mut default = take(DEFAULT, usize::from(bits).div_ceil(8));
    let limits = [MINIMUM, MAXIMUM].map(|flag| digits(&take(flag, usize::from(bits).div_ceil(8))));
    match data_type {
        VISIBLE_STRING => default = sdo::read(drive, Address { index, sub }).await.unwrap(),
        // A message that is not there yet has no value; the ESI fills its place with zeros.
        OCTET_STRING => default = vec![0; usize::from(bits) / 8],
        _ => {}
    }
    Some(Facts {
        object: object.to_owned(),
        name: String::from_utf8(rest.to_vec()).unwrap(),
        data_type,
        bits: bits.into(),
        access: match access & 0x3F {
            0x07 => "ro",
            0x0F => "rw in PREOP",
            0x3F => "rw",
            other => panic!("{other:#04x}"),
        },
        mappable: [6, 7].map(|bit| access >> bit & 1 != 0),
        backup: access >> 8 & 1 != 0,
        setting: access >> 9 & 1 != 0,
        unit: unit.try_into().ok().map(u32::from_le_bytes),
        default: digits(&default),
        limits,
    })
}

#[test]
fn the_esi_describes_every_entry_as_the_drive_does() {
    let mut esi = in_esi();
    rig().in_preop(async |main, _, group| {
        let drive = group.subdevice(main, 0).unwrap();
        let lists = inform(&drive, &[1, 0, 0, 0, 1, 0]).await;
        let words: Vec<u16> = lists.iter().flat_map(|message| message[4..].chunks(2).map(word)).collect();
        for &index in &words[1..] {
            let [low, high] = index.to_le_bytes();
            let object = inform(&drive, &[3, 0, 0, 0, low, high]).await.remove(0);
            let name = String::from_utf8(object[10..].to_vec()).unwrap();
            for sub in 0..=object[8] {
                let of_drive = from_drive(&drive, index, sub, &name).await;
                assert_eq!(esi.remove(&(index.into(), sub.into())), of_drive, "{index:04X}:{sub:02X}");
            }
        }
    });
    assert!(esi.is_empty(), "the drive does not have {:04X?}", esi.keys());
}
