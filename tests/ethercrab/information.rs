//! SDO information: the lists as `ethercrab` reads them, and every description beside the listing of a real unit of the family.
//!
//! `family.txt` holds what `slaveinfo -sdo` printed of an ECR60 with firmware 101A: a line for an object (index, data type, object code,
//! name), and below it a line for each entry (sub-index, data type, bits, access, name).

use std::collections::BTreeMap;

use dictionary::lookup::objects;
use dictionary::{AbortCode, Entry};
use drive::DriveObjects;
use ethercrab::{ObjectDescriptionListQuery, SubDevice, SubDeviceRef};
use rig::Rig;
use usr2556e::master::sdo::{self, abort_code};

use crate::differences::{ADDED, DIFFERENCES};
use crate::raw_mailbox::inform;

type Drive<'a> = SubDeviceRef<'a, &'a SubDevice>;

/// Everything a listing says of an object or an entry: the sub-index is `None` for the object itself.
type Listing = BTreeMap<(u16, Option<u8>), BTreeMap<&'static str, String>>;

fn in_preop<T>(test: impl AsyncFnOnce(&Drive<'_>) -> T) -> T {
    Rig::new(1).in_preop(async |main, _, group| {
        let drive = group.subdevice(main, 0).unwrap();
        test(&drive).await
    })
}

fn table() -> impl Iterator<Item = &'static [Entry]> {
    objects(slave::objects::ENTRIES).chain(objects(DriveObjects::ENTRIES))
}

/// What `ethercrab` 0.7.1 keeps of a list: it takes the list's type for a part of every message, which it is of the first only, and
/// so leaves out the last index of each further one. All indices come in `listing`, taken apart below.
fn ethercrab_keeps(list: &[u16]) -> Vec<u16> {
    const FIRST: usize = 57;
    const FURTHER: usize = 58;
    let (first, rest) = list.split_at(list.len().min(FIRST));
    let further = rest.chunks(FURTHER).flat_map(|message| &message[..message.len() - 1]);
    first.iter().chain(further).copied().collect()
}

#[test]
fn ethercrab_lists_and_counts_the_objects_of_the_dictionary() {
    in_preop(async |drive| {
        let counts = drive.sdo_info_object_quantities().await.unwrap().unwrap();
        let counts = [
            counts.all,
            counts.rx_pdo_mappable,
            counts.tx_pdo_mappable,
            counts.stored_for_device_replacement,
            counts.startup_parameters,
        ];
        let lists = [
            (ObjectDescriptionListQuery::All, 0xFFFF),
            (ObjectDescriptionListQuery::RxPdoMappable, 0x0040),
            (ObjectDescriptionListQuery::TxPdoMappable, 0x0080),
            (ObjectDescriptionListQuery::StoredForDeviceReplacement, 0x0100),
            (ObjectDescriptionListQuery::StartupParameters, 0x0200),
        ];
        for ((query, mask), count) in lists.into_iter().zip(counts) {
            let expected: Vec<u16> = table()
                .filter(|entries| entries.iter().any(|entry| entry.access.bits() & mask != 0))
                .map(|entries| entries[0].index)
                .collect();
            let list = drive.sdo_info_object_description_list(query).await.unwrap().unwrap();
            assert_eq!(list[..], ethercrab_keeps(&expected)[..], "{query:?}");
            assert_eq!(usize::from(count), expected.len(), "{query:?}");
        }
    });
}

fn word(bytes: &[u8]) -> u16 {
    u16::from_le_bytes([bytes[0], bytes[1]])
}

fn facts<const N: usize>(facts: [(&'static str, String); N]) -> BTreeMap<&'static str, String> {
    facts.into_iter().collect()
}

fn name(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap().trim().to_owned()
}

/// All that a master learns by SDO information.
async fn listing(drive: &Drive<'_>) -> Listing {
    let mut listing = Listing::new();
    let messages = inform(drive, &[1, 0, 0, 0, 1, 0]).await;
    let words: Vec<u16> = messages.iter().flat_map(|message| message[4..].chunks(2).map(word)).collect();
    for &index in &words[1..] {
        let [low, high] = index.to_le_bytes();
        let object = inform(drive, &[3, 0, 0, 0, low, high]).await.remove(0);
        assert_eq!(object[..6], [4, 0, 0, 0, low, high]);
        let about = facts([
            ("type", format!("{:04X}", word(&object[6..]))),
            ("code", object[9].to_string()),
            ("name", name(&object[10..])),
        ]);
        listing.insert((index, None), about);
        for sub in 0..=object[8] {
            let entry = inform(drive, &[5, 0, 0, 0, low, high, sub, 0]).await.remove(0);
            if entry[0] == 7 {
                assert_eq!(entry[4..], 0x0609_0011_u32.to_le_bytes(), "{index:04X}:{sub:02X}");
                continue;
            }
            let about = facts([
                ("type", format!("{:04X}", word(&entry[8..]))),
                ("bits", word(&entry[10..]).to_string()),
                ("access", format!("{:04X}", word(&entry[12..]))),
                ("name", name(&entry[14..])),
            ]);
            listing.insert((index, Some(sub)), about);
        }
    }
    listing
}

/// The listing of the real unit.
fn family() -> Listing {
    let mut listing = Listing::new();
    let mut index = 0;
    for line in include_str!("family.txt").lines() {
        let mut fields = line
            .trim()
            .splitn(if line.starts_with(' ') { 5 } else { 4 }, ' ')
            .map(str::to_owned);
        let mut next = || fields.next().unwrap_or_default();
        let number = u16::from_str_radix(&next(), 16).unwrap();
        if line.starts_with(' ') {
            let about = facts([("type", next()), ("bits", next()), ("access", next()), ("name", next())]);
            listing.insert((index, Some(number as u8)), about);
        } else {
            index = number;
            listing.insert((index, None), facts([("type", next()), ("code", next()), ("name", next())]));
        }
    }
    listing
}

#[test]
fn objects_are_listed_as_a_real_unit_lists_them_but_for_known_differences() {
    let ours = in_preop(listing);
    let family = family();
    let mut used = vec![false; DIFFERENCES.len()];
    for ((index, sub), about) in &ours {
        let Some(theirs) = family.get(&(*index, *sub)) else {
            assert!(ADDED.iter().any(|(added, _)| added == index), "{index:04X}:{sub:?} is not known");
            continue;
        };
        assert_eq!(about.len(), theirs.len());
        for (what, value) in about.iter().filter(|(what, value)| theirs[*what] != **value) {
            let justified = DIFFERENCES.iter().position(|(indices, fact, before, after, _)| {
                indices.contains(index) && fact == what && *before == theirs[what] && after == value
            });
            let row = justified.unwrap_or_else(|| panic!("{index:04X}:{sub:?} {what}: {:?} there, {value:?} here", theirs[what]));
            used[row] = true;
        }
    }
    let missing: Vec<_> = family.keys().filter(|key| !ours.contains_key(key)).collect();
    assert!(missing.is_empty(), "{missing:04X?}");
    for (row, used) in DIFFERENCES.iter().zip(used) {
        assert!(used, "a difference that is none: {row:04X?}");
    }
}

#[test]
fn every_entry_that_is_listed_has_a_value_or_lies_behind_its_count() {
    in_preop(async |drive| {
        for ((index, sub), about) in listing(drive).await {
            let Some(sub) = sub else { continue };
            let address = sdo::Address { index, sub };
            match sdo::read(drive, address).await {
                Ok(value) => assert_eq!(value.len(), about["bits"].parse::<usize>().unwrap().div_ceil(8), "{address}"),
                Err(error) => {
                    assert_eq!(abort_code(&error), Some(AbortCode::SubIndexNotFound), "{address}");
                    let count = sdo::read(drive, sdo::Address { index, sub: 0 }).await.unwrap();
                    assert!(sub > count[0], "{address}");
                }
            }
        }
    });
}

#[test]
fn values_asked_for_are_those_of_the_dictionary() {
    in_preop(async |drive| {
        for entry in DriveObjects::ENTRIES {
            let [low, high] = entry.index.to_le_bytes();
            let message = inform(drive, &[5, 0, 0, 0, low, high, entry.sub, 0x70]).await.remove(0);
            assert_eq!(message[7], 0x70);
            let values = [entry.default, entry.min, entry.max].map(|value| value.to_le_bytes()[..entry.size()].to_vec());
            let expected = [&values.concat()[..], entry.name.as_bytes()].concat();
            assert_eq!(message[14..], expected, "{:04X}:{:02X}", entry.index, entry.sub);
        }
    });
}
