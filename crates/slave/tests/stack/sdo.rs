//! SDO uploads and downloads: every form at every mailbox size, every abort code.

use dictionary::AbortCode;
use slave::Configuration;

use crate::workbench::{Bench, MILLISECOND, NAME, aborted, configuration, segment};

#[test]
fn short_values_are_uploaded_expedited_with_their_size() {
    let mut bench = Bench::preop();
    for (request, response) in [
        ([0x40, 0x01, 0x10, 0], [0x4F, 0x01, 0x10, 0, 0x21, 0, 0, 0]),
        ([0x40, 0x00, 0x20, 0], [0x4B, 0x00, 0x20, 0, 50, 0, 0, 0]),
        ([0x40, 0x18, 0x10, 1], [0x43, 0x18, 0x10, 1, 0x88, 0x0A, 0, 0]),
        ([0x40, 0x18, 0x10, 0], [0x4F, 0x18, 0x10, 0, 4, 0, 0, 0]),
        ([0x40, 0x06, 0x20, 0], [0x4F, 0x06, 0x20, 0, 0, 0, 0, 0]),
        ([0x40, 0x08, 0x10, 0], [0x43, 0x08, 0x10, 0, b'L', b'a', b'm', b'p']),
    ] {
        assert_eq!(bench.sdo(&[&request[..], &[0; 4]].concat()), response);
    }
}

#[test]
fn values_of_every_length_come_whole_through_mailboxes_of_every_size() {
    for mailbox in 36..=128 {
        for length in 0..=NAME.len() {
            let mut bench = Bench::preop_with(
                Configuration {
                    device_name: &NAME[..length],
                    ..configuration()
                },
                mailbox,
            );
            assert_eq!(
                bench.upload(0x1008, 0).unwrap(),
                &NAME.as_bytes()[..length],
                "{length} bytes through {mailbox}"
            );
        }
    }
}

#[test]
fn the_first_response_fills_the_mailbox_and_segments_follow() {
    let mut bench = Bench::preop_with(configuration(), 36);
    let first = bench.sdo(&[0x40, 0x0A, 0x10, 0, 0, 0, 0, 0]);
    assert_eq!(first.len() - 8, 36 - 16);
    assert_eq!(first[..8], [0x41, 0x0A, 0x10, 0, 64, 0, 0, 0]);
    // 64 = 20 + 27 + 17.
    assert_eq!(bench.sdo(&[0x60, 0, 0, 0, 0, 0, 0, 0]).len() - 1, 27);
    let last = bench.sdo(&[0x70, 0, 0, 0, 0, 0, 0, 0]);
    assert_eq!((last[0], last.len() - 1), (0x11, 17));
    // Nothing is left.
    assert_eq!(aborted(&bench.sdo(&[0x60, 0, 0, 0, 0, 0, 0, 0])), Some(0x0504_0001));
}

#[test]
fn downloads_reach_the_object_in_every_form() {
    let mut bench = Bench::preop();
    let value = 0x0102_0304_0506_0708_u64.to_le_bytes();
    bench.download(0x2000, 0, &[99, 0]).unwrap();
    bench.download(0x2005, 2, &(-77_i32).to_le_bytes()).unwrap();
    bench.download(0x2007, 0, &value).unwrap();
    let objects = &bench.lamp.objects;
    assert_eq!((objects.brightness, objects.green, objects.wide), (99, -77, 0x0102_0304_0506_0708));
    // A short value in a normal download, and one without a size indication.
    bench.sdo(&[0x21, 0x00, 0x20, 0, 2, 0, 0, 0, 12, 0]);
    assert_eq!(bench.lamp.objects.brightness, 12);
    bench.sdo(&[0x20, 0x00, 0x20, 0, 0, 0, 0, 0, 13, 0]);
    assert_eq!(bench.lamp.objects.brightness, 13);
    // Expedited without a size indication means four bytes.
    bench.sdo(&[0x22, 0x05, 0x20, 2, 9, 0, 0, 0]);
    assert_eq!(bench.lamp.objects.green, 9);
}

#[test]
fn segmented_downloads_take_any_split() {
    let value = 0x8877_6655_4433_2211_u64.to_le_bytes();
    for first in 0..8 {
        for second in 0..=8 - first {
            let mut bench = Bench::preop();
            let begin = [&[0x21, 0x07, 0x20, 0, 8, 0, 0, 0], &value[..first]].concat();
            assert_eq!(bench.sdo(&begin), [0x60, 0x07, 0x20, 0, 0, 0, 0, 0]);
            let (data, rest) = value[first..].split_at(second);
            if !rest.is_empty() {
                assert_eq!(bench.sdo(&segment(0x00, data)), [0x20, 0, 0, 0, 0, 0, 0, 0]);
                assert_eq!(bench.lamp.objects.wide, 0x1122_3344_5566_7788, "nothing before the last segment");
                assert_eq!(bench.sdo(&segment(0x11, rest)), [0x30, 0, 0, 0, 0, 0, 0, 0]);
            } else {
                assert_eq!(bench.sdo(&segment(0x01, data)), [0x20, 0, 0, 0, 0, 0, 0, 0]);
            }
            assert_eq!(bench.lamp.objects.wide.to_le_bytes(), value, "{first} + {second}");
        }
    }
}

#[test]
fn segments_out_of_turn_end_the_transfer() {
    let begin_download = [0x21, 0x07, 0x20, 0, 8, 0, 0, 0];
    let begin_upload = [0x40, 0x0A, 0x10, 0, 0, 0, 0, 0];
    let zeros = |command: u8| [command, 0, 0, 0, 0, 0, 0, 0];
    let cases: [(&str, &[u8], &[u8], u32); 8] = [
        ("upload toggle", &begin_upload, &zeros(0x70), 0x0503_0000),
        ("download toggle", &begin_download, &zeros(0x10), 0x0503_0000),
        ("upload segment of a download", &begin_download, &zeros(0x60), 0x0504_0001),
        ("download segment of an upload", &begin_upload, &zeros(0x00), 0x0504_0001),
        ("too much data", &begin_download, &[0x00, 1, 2, 3, 4, 5, 6, 7, 8, 9], 0x0607_0010),
        ("too little data", &begin_download, &zeros(0x01), 0x0607_0010),
        ("no such command", &begin_download, &zeros(0xA0), 0x0504_0001),
        ("no such command", &begin_upload, &zeros(0xE0), 0x0504_0001),
    ];
    for (what, begin, then, code) in cases {
        let mut bench = Bench::preop_with(configuration(), 36);
        assert_eq!(aborted(&bench.sdo(begin)), None, "{what}");
        assert_eq!(aborted(&bench.sdo(then)), Some(code), "{what}");
        for command in [0x00, 0x60] {
            assert_eq!(
                aborted(&bench.sdo(&zeros(command))),
                Some(0x0504_0001),
                "{what}: the transfer is over"
            );
        }
        assert_eq!(bench.lamp.objects.wide, 0x1122_3344_5566_7788, "{what}");
    }
}

#[test]
fn an_abort_of_the_master_ends_the_transfer_without_an_answer() {
    let mut bench = Bench::preop_with(configuration(), 36);
    bench.sdo(&[0x40, 0x0A, 0x10, 0, 0, 0, 0, 0]);
    assert_eq!(bench.exchange(3, &[0, 0x20, 0x80, 0x0A, 0x10, 0, 0, 0, 4, 5]), None);
    assert_eq!(aborted(&bench.sdo(&[0x60, 0, 0, 0, 0, 0, 0, 0])), Some(0x0504_0001));
}

#[test]
fn a_new_transfer_takes_the_place_of_the_old_one() {
    let mut bench = Bench::preop_with(configuration(), 36);
    bench.sdo(&[0x21, 0x07, 0x20, 0, 8, 0, 0, 0]);
    assert_eq!(bench.upload(0x100A, 0).unwrap(), NAME.as_bytes());
    bench.sdo(&[0x21, 0x07, 0x20, 0, 8, 0, 0, 0]);
    assert_eq!(bench.upload(0x2000, 0).unwrap(), [50, 0]);
}

#[test]
fn uploads_end_with_the_standards_abort_codes() {
    let mut bench = Bench::preop();
    for (index, sub, code) in [
        (0x1002, 0, AbortCode::ObjectNotFound),
        (0x0000, 0, AbortCode::ObjectNotFound),
        (0x0005, 0, AbortCode::ObjectNotFound),
        (0x6502, 1, AbortCode::SubIndexNotFound),
        (0xFFFF, 255, AbortCode::ObjectNotFound),
        (0x1018, 5, AbortCode::SubIndexNotFound),
        (0x1C32, 3, AbortCode::SubIndexNotFound),
        (0x1600, 3, AbortCode::SubIndexNotFound),
        (0x1600, 13, AbortCode::SubIndexNotFound),
        (0x1C12, 2, AbortCode::SubIndexNotFound),
    ] {
        assert_eq!(bench.upload(index, sub), Err(code.code()), "{index:04X}:{sub:02X}");
    }
}

#[test]
fn downloads_end_with_the_standards_abort_codes_and_change_nothing() {
    let mut bench = Bench::preop();
    bench.lamp.locked = true;
    let cases: [(u16, u8, &[u8], AbortCode); 23] = [
        (0x2FFF, 0, &[0], AbortCode::ObjectNotFound),
        (0x2000, 1, &[0, 0], AbortCode::SubIndexNotFound),
        (0x2000, 0, &[1], AbortCode::LengthMismatch),
        (0x2000, 0, &[1, 0, 0, 0], AbortCode::LengthMismatch),
        (0x2005, 2, &[1, 0], AbortCode::LengthMismatch),
        (0x2007, 0, &[], AbortCode::LengthMismatch),
        (0x2007, 0, &[0; 9], AbortCode::LengthMismatch),
        (0x2000, 0, &[101, 0], AbortCode::ValueTooHigh),
        (0x2002, 0, &[1], AbortCode::DeviceState),
        (0x2005, 0, &[2], AbortCode::ReadOnly),
        (0x6041, 0, &[0, 0], AbortCode::ReadOnly),
        (0x1008, 0, b"new", AbortCode::ReadOnly),
        (0x1018, 1, &[0; 4], AbortCode::ReadOnly),
        (0x1010, 1, &[2, 0], AbortCode::ValueRange),
        (0x1010, 1, b"save", AbortCode::LengthMismatch),
        (0x1011, 1, &[0, 0], AbortCode::ValueRange),
        (0x1C32, 1, &[3, 0], AbortCode::ValueRange),
        (0x1C32, 1, &[0x22, 0], AbortCode::ValueRange),
        (0x1C33, 1, &[4, 0], AbortCode::ValueRange),
        (0x1C32, 8, &[2, 0], AbortCode::ValueRange),
        (0x1C33, 1, &[9, 0], AbortCode::ValueRange),
        (0x1C32, 2, &[0; 4], AbortCode::ReadOnly),
        (0x1C00, 1, &[0], AbortCode::ReadOnly),
    ];
    let before = bench.lamp.objects.clone();
    for (index, sub, data, code) in cases {
        assert_eq!(
            bench.download(index, sub, data),
            Err(code.code()),
            "{index:04X}:{sub:02X} {data:02X?}"
        );
    }
    assert_eq!(bench.lamp.objects, before);
    assert_eq!((bench.lamp.stored, bench.lamp.restored), (0, 0));
}

#[test]
fn what_can_be_written_in_preop_only_is_refused_later() {
    let writes: [(u16, u8, &[u8]); 4] = [(0x2001, 0, &[1, 0]), (0x1C12, 0, &[0]), (0x1600, 0, &[0]), (0x1C32, 1, &[1, 0])];
    for (index, sub, data) in writes {
        assert_eq!(Bench::preop().download(index, sub, data), Ok(()), "{index:04X}");
        for mut bench in [Bench::safeop(), Bench::op()] {
            assert_eq!(bench.download(index, sub, data), Err(0x0800_0022), "{index:04X}");
            assert_eq!(bench.download(0x2000, 0, &[3, 0]), Ok(()));
        }
    }
}

#[test]
fn parameters_are_stored_and_restored_by_writing_1() {
    let mut bench = Bench::preop();
    bench.download(0x1010, 1, &[1, 0]).unwrap();
    bench.download(0x1011, 1, &[1, 0]).unwrap();
    assert_eq!((bench.lamp.stored, bench.lamp.restored), (1, 1));
    assert_eq!(bench.upload(0x1010, 1).unwrap(), [0, 0]);
    bench.lamp.refusal = Some(AbortCode::DeviceState);
    assert_eq!(bench.download(0x1010, 1, &[1, 0]), Err(0x0800_0022));
}

#[test]
fn the_communication_area_holds_what_the_configuration_says() {
    let mut bench = Bench::preop();
    for (index, sub, value) in [
        (0x1000, 0, 0x0004_0192_u32),
        (0x1018, 2, 0x0A88_0001),
        (0x1018, 3, 0x204),
        (0x1018, 4, 77),
        (0x10F1, 1, 1),
        (0x1601, 2, 0x2005_0220),
        (0x1C32, 5, 500_000),
        (0x1C32, 6, 50_000),
        (0x1C32, 9, 50_000),
        (0x1C33, 6, 50_000),
        (0x1C33, 9, 0),
    ] {
        assert_eq!(bench.upload(index, sub).unwrap(), value.to_le_bytes(), "{index:04X}:{sub:02X}");
    }
    for (index, sub, value) in [
        (0x10F1, 2, 4_u16),
        (0x1C12, 1, 0x1600),
        (0x1C13, 1, 0x1A00),
        (0x1C32, 4, 0x4007),
        (0x1C33, 4, 0x400F),
    ] {
        assert_eq!(bench.upload(index, sub).unwrap(), value.to_le_bytes(), "{index:04X}:{sub:02X}");
    }
    for (index, sub, value) in [
        (0x1C00, 0, 4),
        (0x1C00, 3, 3),
        (0x1C32, 0, 0x20),
        (0x1602, 0, 0),
        (0x1A00, 0, 2),
        (0x1C32, 0x20, 0),
    ] {
        assert_eq!(bench.upload(index, sub).unwrap(), [value], "{index:04X}:{sub:02X}");
    }
}

#[test]
fn the_time_stamp_goes_on_from_what_was_written() {
    let mut bench = Bench::preop();
    bench.download(0x10F8, 0, &1_000_000_u64.to_le_bytes()).unwrap();
    bench.advance(5 * MILLISECOND);
    assert_eq!(bench.upload(0x10F8, 0).unwrap(), (6 * MILLISECOND).to_le_bytes());
}

#[test]
fn every_entry_of_the_table_can_be_read_or_lies_behind_its_count() {
    let mut bench = Bench::preop();
    for entry in slave::objects::ENTRIES {
        match bench.upload(entry.index, entry.sub) {
            Ok(value) => assert!(
                entry.bits == 0 || value.len() == entry.size(),
                "{:04X}:{:02X}",
                entry.index,
                entry.sub
            ),
            Err(code) => {
                assert_eq!(code, AbortCode::SubIndexNotFound.code());
                let count = bench.upload(entry.index, 0).unwrap()[0];
                assert!(entry.sub > count, "{:04X}:{:02X}", entry.index, entry.sub);
            }
        }
    }
}

#[test]
fn a_panel_reads_objects_without_a_bus() {
    let bench = Bench::new();
    let mut out = [0; 8];
    let read = |index, out: &mut [u8]| bench.slave.read_object(&bench.lamp, index, 0, wire::Nanos(0), out);
    assert_eq!(read(0x1008, &mut out), Ok(4));
    assert_eq!(out[..4], *b"Lamp");
    assert_eq!(read(0x100A, &mut out), Err(AbortCode::ObjectTooLong));
    assert_eq!(read(0x2FFF, &mut out), Err(AbortCode::ObjectNotFound));
}
