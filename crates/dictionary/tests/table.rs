//! What a table made with `object_dictionary!` does, seen from outside.

use dictionary::{AbortCode, Access, DataType, Lookup, MAX_VALUE_SIZE, Objects, lookup, object_dictionary};

object_dictionary! {
    /// A small device.
    pub struct Small in small {
        /// First line.
        /// Second line.
        0x2000:0 current: u16 = 3000, RW | RX_PDO | TX_PDO | SAVED, in 100..=6000, unit "mA", "Peak Current";
        /// One.
        0x2005:1 first: u16 = 1, RW, in 0..=3, "First" of "Pair";
        /// Two.
        0x2005:2 second: i8 = -2, RO, in -3..=3, "Second" of "Pair";
        /// Wide.
        0x6064:0 position: i32 = 0, RO | TX_PDO, "Position Actual Value";
        /// Time.
        0x6100:0 time: u64 = 0, RW, "Time";
        /// Flag.
        0x6101:0 flag: bool = false, RW, "Flag";
    }
}

fn stored(objects: &Small, slot: usize) -> Vec<u8> {
    let mut out = [0; MAX_VALUE_SIZE];
    let size = objects.load(slot, &mut out);
    out[..size].to_vec()
}

#[test]
fn a_row_becomes_an_entry_with_everything_the_row_says() {
    let entry = &Small::ENTRIES[small::current];
    assert_eq!(
        (entry.index, entry.sub, entry.name, entry.object),
        (0x2000, 0, "Peak Current", "Peak Current")
    );
    assert_eq!(
        (entry.data_type, entry.bits, entry.mapping()),
        (DataType::Unsigned16, 16, 0x2000_0010)
    );
    assert_eq!((entry.default, entry.min, entry.max, entry.unit), (3000, 100, 6000, "mA"));
    assert_eq!(entry.access.bits(), 0x01FF);
    assert_eq!(entry.doc, " First line.\n Second line.\n");
    assert_eq!(Small::ENTRIES[small::second].object, "Pair");
    assert_eq!(
        (Small::ENTRIES[small::position].min, Small::ENTRIES[small::position].max),
        (i64::from(i32::MIN), i64::from(i32::MAX))
    );
}

#[test]
fn values_outside_of_the_range_are_refused_and_the_old_value_stays() {
    let mut objects = Small::new();
    for (bytes, refusal) in [
        (&[0x71, 0x17][..], AbortCode::ValueTooHigh),
        (&[99, 0], AbortCode::ValueTooLow),
        (&[1], AbortCode::LengthMismatch),
        (&[1, 2, 3, 4], AbortCode::LengthMismatch),
        (&[], AbortCode::LengthMismatch),
    ] {
        assert_eq!(objects.store(small::current, bytes), Err(refusal));
        assert_eq!(objects, Small::new());
    }
    assert_eq!(objects.store(small::second, &[0xFC]), Err(AbortCode::ValueTooLow));
    assert_eq!(objects.store(small::second, &[0xFD]), Ok(()));
    assert_eq!(objects.second, -3);
}

#[test]
fn every_slot_loads_what_was_stored() {
    let mut objects = Small::new();
    for (slot, bytes) in [
        (small::current, &[0x70, 0x17][..]),
        (small::first, &[3, 0]),
        (small::second, &[0xFF]),
        (small::position, &[1, 2, 3, 0x84]),
        (small::time, &[1, 2, 3, 4, 5, 6, 7, 0xF8]),
        (small::flag, &[1]),
    ] {
        objects.store(slot, bytes).unwrap();
        assert_eq!(stored(&objects, slot), bytes);
        assert_eq!(stored(&objects, slot).len(), Small::ENTRIES[slot].size());
    }
    assert_eq!(objects.load(Small::ENTRIES.len(), &mut [0; MAX_VALUE_SIZE]), 0);
    assert_eq!(objects.store(Small::ENTRIES.len(), &[0]), Err(AbortCode::ObjectNotFound));
}

#[test]
fn lookup_tells_a_missing_object_from_a_missing_sub_index() {
    assert_eq!(lookup(Small::ENTRIES, 0x2005, 2), Ok(Lookup::Slot(small::second)));
    assert_eq!(lookup(Small::ENTRIES, 0x2005, 0), Ok(Lookup::Count(2)));
    assert_eq!(lookup(Small::ENTRIES, 0x2005, 3), Err(AbortCode::SubIndexNotFound));
    assert_eq!(lookup(Small::ENTRIES, 0x2000, 1), Err(AbortCode::SubIndexNotFound));
    for absent in [0, 0x1FFF, 0x2001, 0x6102, 0xFFFF] {
        assert_eq!(lookup(Small::ENTRIES, absent, 0), Err(AbortCode::ObjectNotFound));
    }
}

#[test]
fn a_table_is_walked_object_by_object() {
    let sizes: Vec<_> = lookup::objects(Small::ENTRIES)
        .map(|object| (object[0].index, object.len()))
        .collect();
    assert_eq!(sizes, [(0x2000, 1), (0x2005, 2), (0x6064, 1), (0x6100, 1), (0x6101, 1)]);
}

#[test]
fn access_words_tell_states_and_directions() {
    assert!(Access::RW.is_writable_everywhere() && !Access::RW.is_writable_in_preop_only());
    assert!(Access::RW_PREOP.is_writable() && Access::RW_PREOP.is_writable_in_preop_only());
    assert!(!Access::RO.is_writable() && Access::RO.is_readable());
    assert_eq!(Access::RW.with(Access::RX_PDO).with(Access::TX_PDO).bits(), 0x00FF);
}

#[test]
fn abort_codes_survive_the_wire() {
    for &code in AbortCode::ALL {
        assert_eq!(AbortCode::from_code(code.code()), Some(code));
    }
    assert_eq!(AbortCode::from_code(0x1234_5678), None);
    assert_eq!(AbortCode::ValueTooLow.to_string(), "0x06090032: value of the parameter too low");
}
