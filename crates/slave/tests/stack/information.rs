//! SDO information: lists, descriptions, fragments and errors.

use dictionary::Objects;
use dictionary::lookup::objects;
use slave::Configuration;

use crate::workbench::{Bench, NAME, configuration};

/// The words of a list, and the messages it came in.
fn list(bench: &mut Bench, kind: u8) -> (Vec<u16>, Vec<Vec<u8>>) {
    let messages = bench.inform(&[1, 0, 0, 0, kind, 0]);
    let words: Vec<u16> = messages
        .iter()
        .flat_map(|message| message[4..].chunks(2))
        .map(|word| u16::from_le_bytes([word[0], word[1]]))
        .collect();
    assert_eq!(words[0], kind.into(), "the list says which it is");
    (words[1..].to_vec(), messages)
}

fn error(messages: &[Vec<u8>]) -> u32 {
    let [message] = messages else { panic!("{messages:02X?}") };
    assert_eq!(message[..4], [7, 0, 0, 0]);
    u32::from_le_bytes(message[4..].try_into().unwrap())
}

/// Indices of all objects of the table with an entry whose access word has a bit of `mask`.
fn expected(bench: &Bench, mask: u16) -> Vec<u16> {
    objects(slave::objects::ENTRIES)
        .chain(objects(bench.lamp.entries()))
        .filter(|entries| entries.iter().any(|entry| entry.access.bits() & mask != 0))
        .map(|entries| entries[0].index)
        .collect()
}

#[test]
fn lists_hold_the_objects_they_are_of_and_are_counted() {
    let mut bench = Bench::preop();
    let (counts, _) = list(&mut bench, 0);
    assert_eq!(counts.len(), 5);
    for (kind, mask) in [(1, 0xFFFF), (2, 0x0040), (3, 0x0080), (4, 0x0100), (5, 0x0200)] {
        let (indices, _) = list(&mut bench, kind);
        assert_eq!(indices, expected(&bench, mask), "list {kind}");
        assert!(indices.is_sorted());
        assert_eq!(usize::from(counts[usize::from(kind) - 1]), indices.len(), "list {kind}");
    }
    assert!(list(&mut bench, 2).0.contains(&0x2005), "one mappable entry is enough");
    assert_eq!(list(&mut bench, 4).0, [0x2000]);
}

#[test]
fn lists_come_in_as_many_messages_as_the_mailbox_needs() {
    for mailbox in 36..=128 {
        let mut bench = Bench::preop_with(configuration(), mailbox);
        let all = expected(&bench, 0xFFFF);
        let (indices, messages) = list(&mut bench, 1);
        assert_eq!(indices, all, "through {mailbox}");
        let room = usize::from(mailbox - 12) & !1;
        assert_eq!(messages.len(), (2 + 2 * all.len()).div_ceil(room));
        for (position, message) in messages.iter().enumerate() {
            let left = (messages.len() - 1 - position) as u16;
            assert_eq!(message[0], if left == 0 { 2 } else { 0x82 });
            assert_eq!(message[2..4], left.to_le_bytes());
            assert!(left == 0 || message.len() - 4 == room, "only the last is not full");
        }
        assert_eq!(list(&mut bench, 0).1.len(), 1, "counts always fit");
    }
}

#[test]
fn a_request_before_the_end_of_a_list_ends_it() {
    let mut bench = Bench::preop_with(configuration(), 36);
    let request = [0, 0x80, 1, 0, 0, 0, 1, 0];
    let first = bench.exchange(3, &request).unwrap();
    assert_eq!(first[8], 0x82);
    assert_eq!(bench.upload(0x2000, 0), Ok(vec![50, 0]));
    bench.poll();
    assert_eq!(bench.chip.receive(), None, "nothing of the list is left");
    assert!(list(&mut bench, 1).1.len() > 1, "and the next begins anew");
}

#[test]
fn a_list_ends_with_the_state() {
    let mut bench = Bench::preop_with(configuration(), 36);
    bench.exchange(3, &[0, 0x80, 1, 0, 0, 0, 1, 0]).unwrap();
    bench.request(0x11);
    bench.request(0x12);
    bench.poll();
    assert_eq!(bench.chip.receive(), None);
}

#[test]
fn a_lost_message_of_a_list_is_repeated() {
    let mut bench = Bench::preop_with(configuration(), 36);
    let first = bench.exchange(3, &[0, 0x80, 1, 0, 0, 0, 1, 0]).unwrap();
    bench.poll();
    bench.chip.toggle_repeat();
    bench.poll();
    assert_eq!(bench.chip.receive(), Some(first.clone()));
    bench.poll();
    let second = bench.chip.receive().unwrap();
    assert_eq!(
        u16::from_le_bytes([second[10], second[11]]) + 1,
        u16::from_le_bytes([first[10], first[11]])
    );
    assert_eq!(second[5] >> 4, (first[5] >> 4) + 1, "no counter is left out");
}

#[test]
fn objects_are_described_with_type_code_highest_sub_index_and_name() {
    let mut bench = Bench::preop();
    for (index, data_type, highest, code, name) in [
        (0x1000, 0x07, 0, 7, "Device type"),
        (0x1008, 0x09, 0, 7, "Device name"),
        (0x1010, 0x2A, 1, 9, "Save parameters"),
        (0x1018, 0x23, 4, 9, "Identity"),
        (0x10F1, 0x2A, 2, 9, "Error Settings"),
        (0x10F8, 0x1B, 0, 7, "Timestamp Object"),
        (0x1602, 0x21, 12, 9, "RXPDO 3 Mapping Parameter"),
        (0x1A00, 0x21, 12, 9, "TXPDO 1 Mapping Parameter"),
        (0x1C00, 0x05, 4, 8, "Sync manager type"),
        (0x1C12, 0x06, 3, 8, "RxPDO assign"),
        (0x1C13, 0x06, 3, 8, "TxPDO assign"),
        (0x1C32, 0x29, 32, 9, "SM output parameter"),
        (0x2006, 0x01, 0, 7, "On"),
        (0x2008, 0x2A, 4, 9, "Mixed"),
    ] {
        let [low, high] = u16::to_le_bytes(index);
        let expected = [&[4, 0, 0, 0, low, high, data_type, 0, highest, code], name.as_bytes()].concat();
        assert_eq!(bench.inform(&[3, 0, 0, 0, low, high]), [expected], "{index:04X}");
    }
}

fn entry_request(index: u16, sub: u8, values: u8) -> [u8; 8] {
    let [low, high] = index.to_le_bytes();
    [5, 0, 0, 0, low, high, sub, values]
}

#[test]
fn entries_are_described_with_type_length_access_and_name() {
    let mut bench = Bench::preop();
    for (index, sub, data_type, bits, access, name) in [
        (0x1000, 0, 0x07, 32, 0x0007, "Device type"),
        (0x1008, 0, 0x09, 32, 0x0007, "Device name"),
        (0x100A, 0, 0x09, 512, 0x0007, "Software version"),
        (0x1018, 0, 0x05, 8, 0x0007, "SubIndex 000"),
        (0x1018, 4, 0x07, 32, 0x0007, "Serial number"),
        (0x1600, 0, 0x05, 8, 0x000F, "SubIndex 000"),
        (0x1600, 12, 0x07, 32, 0x000F, "SubIndex 012"),
        (0x1C32, 0, 0x05, 8, 0x0007, "SubIndex 000"),
        (0x1C32, 0x20, 0x01, 1, 0x0007, "Sync Error"),
        (0x2000, 0, 0x06, 16, 0x01FF, "Brightness"),
        (0x2005, 0, 0x05, 8, 0x0007, "SubIndex 000"),
        (0x2005, 2, 0x04, 32, 0x00FF, "Green"),
        (0x6041, 0, 0x06, 16, 0x0087, "Statusword"),
    ] {
        let [low, high] = u16::to_le_bytes(index);
        let numbers = [data_type, bits, access].map(u16::to_le_bytes).concat();
        let expected = [&[6, 0, 0, 0, low, high, sub, 0], &numbers[..], name.as_bytes()].concat();
        assert_eq!(bench.inform(&entry_request(index, sub, 0)), [expected], "{index:04X}:{sub:02X}");
    }
}

#[test]
fn values_asked_for_come_between_access_and_name() {
    let mut bench = Bench::preop();
    let mut values = |index, sub, asked| {
        let message = bench.inform(&entry_request(index, sub, asked)).remove(0);
        (message[7], message[14..].to_vec())
    };
    for (index, sub, asked, answered, expected) in [
        (0x2000, 0, 0x10, 0x10, &[&[50, 0][..], b"Brightness"][..]),
        (0x2000, 0, 0x70, 0x70, &[&[50, 0, 0, 0, 100, 0], b"Brightness"]),
        (0x2000, 0, 0x40, 0x40, &[&[100, 0], b"Brightness"]),
        (0x2008, 4, 0x77, 0x75, &[&[0xFD, 0xFF, 0xF6, 0xFF, 10, 0], b"Last"]),
        // No unit.
        (0x2000, 0, 0x08, 0x00, &[b"Brightness"]),
        // The unit goes first: 10^-9 seconds.
        (0x10F8, 0, 0x08, 0x08, &[&[0, 0, 3, 0xF7], b"Timestamp Object"]),
        (0x10F8, 0, 0x18, 0x18, &[&[0, 0, 3, 0xF7], &[0; 8], b"Timestamp Object"]),
        (0x1C32, 2, 0x08, 0x08, &[&[0, 0, 3, 0xF7], b"Cycle Time"]),
        (0x1C32, 1, 0x08, 0x00, &[b"Synchronization Type"]),
        // Values of strings are not limited.
        (0x1008, 0, 0x70, 0x00, &[b"Device name"]),
        (0x2006, 0, 0x70, 0x70, &[&[0, 0, 1], b"On"]),
        (0x2005, 0, 0x70, 0x70, &[&[2, 2, 2], b"SubIndex 000"]),
        // What the configuration says, not what the master has written.
        (0x1C12, 1, 0x10, 0x10, &[&[0x00, 0x16], b"SubIndex 001"]),
        (0x1C12, 2, 0x10, 0x10, &[&[0, 0], b"SubIndex 002"]),
        (0x1C12, 0, 0x50, 0x50, &[&[1, 3], b"SubIndex 000"]),
        (0x1018, 4, 0x10, 0x10, &[&[77, 0, 0, 0], b"Serial number"]),
        (0x10F8, 0, 0x50, 0x50, &[&[0; 8], &[0xFF; 8], b"Timestamp Object"]),
    ] {
        assert_eq!(
            values(index, sub, asked),
            (answered, expected.concat()),
            "{index:04X}:{sub:02X} {asked:02X}"
        );
    }
    bench.download(0x1C12, 0, &[0]).unwrap();
    assert_eq!(bench.inform(&entry_request(0x1C12, 0, 0x10))[0][14], 1, "a default does not change");
}

#[test]
fn what_does_not_fit_a_short_mailbox_is_left_out_from_behind() {
    let mut bench = Bench::preop_with(configuration(), 36);
    // 36 bytes: 12 of headers, 10 of the entry, 14 left.
    let timestamp = bench.inform(&entry_request(0x10F8, 0, 0x70)).remove(0);
    assert_eq!((timestamp[7], timestamp.len()), (0x10, 4 + 24));
    assert_eq!(timestamp[22..], *b"Timest");
    let supported = bench.inform(&entry_request(0x1C32, 4, 0)).remove(0);
    assert_eq!(supported[14..], *b"Synchronizatio");
    let mapping = bench.inform(&[3, 0, 0, 0, 0x00, 0x16]).remove(0);
    assert_eq!(mapping[10..], *b"RXPDO 1 Mapping Pa");
}

#[test]
fn every_entry_of_the_table_is_described_and_gaps_are_not() {
    let mut bench = Bench::preop_with(
        Configuration {
            device_name: NAME,
            ..configuration()
        },
        128,
    );
    for entry in slave::objects::ENTRIES.iter().chain(bench.lamp.entries()) {
        let message = bench.inform(&entry_request(entry.index, entry.sub, 0)).remove(0);
        assert_eq!(message[0], 6, "{:04X}:{:02X}", entry.index, entry.sub);
        assert_eq!(message[14..], *entry.name.as_bytes());
    }
}

#[test]
fn what_does_not_exist_is_answered_with_an_error() {
    let mut bench = Bench::preop();
    for (request, code) in [
        (&[1, 0, 0, 0, 6, 0][..], 0x0601_0000),
        (&[1, 0, 0, 0, 1, 1], 0x0601_0000),
        (&[3, 0, 0, 0, 0x03, 0x10], 0x0602_0000),
        (&[3, 0, 0, 0, 0x05, 0x00], 0x0602_0000),
        (&entry_request(0x1003, 0, 0), 0x0602_0000),
        (&entry_request(0x1C32, 3, 0), 0x0609_0011),
        (&entry_request(0x2000, 1, 0), 0x0609_0011),
        (&entry_request(0x1600, 13, 0), 0x0609_0011),
        (&[0, 0, 0, 0], 0x0504_0001),
        (&[2, 0, 0, 0, 1, 0], 0x0504_0001),
        (&[7, 0, 0, 0, 1, 0], 0x0504_0001),
        (&[0x7F, 0, 0, 0, 1, 0], 0x0504_0001),
    ] {
        assert_eq!(error(&bench.inform(request)), code, "{request:02X?}");
    }
}

#[test]
fn information_does_not_disturb_a_transfer_in_segments() {
    let mut bench = Bench::preop_with(configuration(), 36);
    bench.sdo(&[0x40, 0x0A, 0x10, 0, 0, 0, 0, 0]);
    assert_eq!(list(&mut bench, 0).0.len(), 5);
    assert_eq!(bench.sdo(&[0x60, 0, 0, 0, 0, 0, 0, 0])[0], 0x00);
}
