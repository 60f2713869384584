//! The saved parameters as bytes: a version, then for each object index, sub-index, size and value, little-endian.
//!
//! What is saved are the rows of the object table with the flag `SAVED`, "S" in the manual's tables. A set is read by its keys, so that it
//! still loads after objects have been added or taken away.

use dictionary::{Entry, Lookup, MAX_VALUE_SIZE, Objects, lookup};
use drive::DriveObjects;
use heapless::Vec;

/// The layout described above.
const VERSION: u8 = 1;
/// Index, sub-index and size before each value.
const KEY_SIZE: usize = 4;
/// Bytes for which there is room: twice today's set, so that one saved by a later firmware can be read too.
pub(crate) const CAPACITY: usize = 512;

/// A set of parameters.
pub(crate) type Bytes = Vec<u8, CAPACITY>;

/// The bytes are no set of parameters that this firmware knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Unreadable;

/// Length of a set with all saved objects.
pub(crate) const FULL_SIZE: usize = {
    let mut size = 1;
    let mut slot = 0;
    while slot < DriveObjects::ENTRIES.len() {
        let entry = &DriveObjects::ENTRIES[slot];
        if entry.access.is_saved() {
            size += KEY_SIZE + entry.size();
        }
        slot += 1;
    }
    size
};

const _: () = assert!(FULL_SIZE <= CAPACITY, "parameter_set::CAPACITY is too small for the saved objects");

/// The saved objects with their present values.
pub(crate) fn of(objects: &DriveObjects) -> Bytes {
    let mut set = delivery();
    for (slot, entry) in DriveObjects::ENTRIES
        .iter()
        .enumerate()
        .filter(|(_, entry)| entry.access.is_saved())
    {
        let mut value = [0; MAX_VALUE_SIZE];
        let size = objects.load(slot, &mut value);
        let [low, high] = entry.index.to_le_bytes();
        let written = set
            .extend_from_slice(&[low, high, entry.sub, size as u8])
            .and_then(|()| set.extend_from_slice(&value[..size]));
        debug_assert!(written.is_ok(), "FULL_SIZE counts every saved object");
    }
    set
}

/// The set that leaves every object at its default.
pub(crate) fn delivery() -> Bytes {
    let mut set = Bytes::new();
    // There is room for one byte.
    let _ = set.push(VERSION);
    set
}

/// The objects as a set leaves them: objects that it does not name, or names with a value out of their range, keep their defaults; what
/// it names beyond the saved objects is ignored.
pub(crate) fn read(set: &[u8]) -> Result<DriveObjects, Unreadable> {
    let mut objects = DriveObjects::new();
    let Some((&VERSION, mut rest)) = set.split_first() else {
        return Err(Unreadable);
    };
    while let Some((&[low, high, sub, size], behind)) = rest.split_first_chunk::<KEY_SIZE>() {
        let (value, behind) = behind.split_at_checked(size.into()).ok_or(Unreadable)?;
        if let Some(slot) = saved_slot(u16::from_le_bytes([low, high]), sub) {
            // A refused value is one out of range, which leaves the default.
            let _ = objects.store(slot, value);
        }
        rest = behind;
    }
    if rest.is_empty() { Ok(objects) } else { Err(Unreadable) }
}

fn saved_slot(index: u16, sub: u8) -> Option<usize> {
    let entries: &[Entry] = DriveObjects::ENTRIES;
    match lookup(entries, index, sub) {
        Ok(Lookup::Slot(slot)) if entries[slot].access.is_saved() => Some(slot),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dictionary::AbortCode;
    use proptest::prelude::*;

    /// Every writable object away from its default, as far as its range allows.
    fn changed() -> DriveObjects {
        let mut objects = DriveObjects::new();
        for (slot, entry) in DriveObjects::ENTRIES.iter().enumerate() {
            let value = if entry.default == entry.max { entry.min } else { entry.max };
            objects.store(slot, &value.to_le_bytes()[..entry.size()]).unwrap();
        }
        objects
    }

    fn value(objects: &DriveObjects, slot: usize) -> ([u8; MAX_VALUE_SIZE], usize) {
        let mut out = [0; MAX_VALUE_SIZE];
        let size = objects.load(slot, &mut out);
        (out, size)
    }

    fn record(index: u16, sub: u8, value: &[u8]) -> std::vec::Vec<u8> {
        let [low, high] = index.to_le_bytes();
        [&[low, high, sub, value.len() as u8], value].concat()
    }

    #[test]
    fn a_set_brings_back_every_saved_object_and_no_other() {
        let (before, new) = (changed(), DriveObjects::new());
        let set = of(&before);
        assert_eq!(set.len(), FULL_SIZE);
        let after = read(&set).unwrap();
        let mut saved = 0;
        for (slot, entry) in DriveObjects::ENTRIES.iter().enumerate() {
            saved += usize::from(entry.access.is_saved());
            let expected = if entry.access.is_saved() { &before } else { &new };
            assert_eq!(value(&after, slot), value(expected, slot), "{:04X}:{}", entry.index, entry.sub);
        }
        assert!(saved > 30, "{saved}");
    }

    #[test]
    fn sets_of_older_and_newer_firmware_load() {
        let older = [&[VERSION][..], &record(0x2001, 0, &[0x10, 0x27]), &record(0x2000, 0, &[0xE8, 3])].concat();
        let expected = DriveObjects {
            peak_current: 1000,
            ..DriveObjects::new()
        };
        assert_eq!(read(&older), Ok(expected.clone()));
        // Objects that there are no more, that are not saved any more, that have become wider, and nothing where they stand alone.
        for gone in [
            record(0x2999, 0, &[1, 2, 3, 4]),
            record(0x2000, 7, &[1, 0]),
            record(0x6040, 0, &[0x0F, 0]),
            record(0x2002, 0, &[7]),
            record(0x2150, 0, &[]),
        ] {
            assert_eq!(read(&[older.as_slice(), &gone].concat()), Ok(expected.clone()), "{gone:X?}");
        }
        assert_eq!(read(&delivery()), Ok(DriveObjects::new()));
    }

    #[test]
    fn a_value_out_of_its_range_leaves_the_default() {
        let set = [&[VERSION][..], &record(0x2000, 0, &[99, 0]), &record(0x2003, 0, &[101, 0])].concat();
        assert_eq!(read(&set), Ok(DriveObjects::new()));
        assert_eq!(
            DriveObjects::new().store(drive::slots::peak_current, &[99, 0]),
            Err(AbortCode::ValueTooLow)
        );
    }

    #[test]
    fn what_is_no_set_is_refused() {
        let set = of(&changed());
        assert_eq!(read(&[]), Err(Unreadable));
        assert_eq!(read(&[VERSION + 1]), Err(Unreadable), "another layout");
        let mut whole = 0;
        for length in 1..set.len() {
            // A set that ends between two objects is one of fewer objects; the store's checksum tells the difference.
            whole += usize::from(read(&set[..length]).is_ok());
        }
        let saved = DriveObjects::ENTRIES.iter().filter(|entry| entry.access.is_saved()).count();
        assert_eq!(whole, saved);
    }

    proptest! {
        #[test]
        fn any_bytes_leave_every_object_in_its_range(bytes in proptest::collection::vec(any::<u8>(), 0..CAPACITY)) {
            let set = [&[VERSION][..], &bytes].concat();
            if let Ok(objects) = read(&set) {
                for (slot, entry) in DriveObjects::ENTRIES.iter().enumerate() {
                    let (value, size) = value(&objects, slot);
                    let mut checked = DriveObjects::new();
                    prop_assert_eq!(checked.store(slot, &value[..size]), Ok(()), "{:04X}", entry.index);
                }
            }
        }
    }
}
