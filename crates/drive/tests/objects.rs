//! The object table against the manual's chapter 2.

mod rig;

use dictionary::{AbortCode, Access, Objects};
use drive::DriveObjects;
use rig::{Rig, slot};

/// Index, sub-index, type, access, range (- for that of the type) and default, as the manual's tables say.
///
/// Corrected where they contradict themselves: 0x2011 takes only what the text allows; 0x2043 and 0x2044 have signed ranges; the tables of
/// 0x603F and 0x6041 call R/W what only the drive can know. Speeds and ramps of type INTEGER32 take no negative values.
const MANUAL: &str = "
2000 0 u16 RWS 100..6000 3000
2001 0 u16 RWS 200..65535 10000
2002 0 u16 RWS 200..65535 500
2003 0 u16 RWS 0..100 50
2005 1 u16 RWS 0..3 1
2005 2 u16 RWS 0..3 2
2006 0 u16 RWS 0..3 3
2007 1 u16 RWS 0..8 0
2007 2 u16 RWS 0..8 0
2007 3 u16 RWS 0..8 1
2007 4 u16 RWS 0..8 2
2007 5 u16 RWS 0..8 3
2007 6 u16 RWS 0..8 6
2008 0 u16 RWS 0..63 63
2009 0 u16 RWS 0..25600 6400
200A 0 u16 RWS 0..65535 1000
200B 1 u16 RWS 0..1 1
200B 2 u16 RWS 100..65535 1000
200B 3 u16 RWS 0..10000 200
200B 4 u16 RWS 0..1024 256
200C 1 u16 RWS 0..1 0
200C 2 u16 R 100..65535 1000
200C 3 u16 R 0..10 1
200C 4 u16 RWS 0..10000 1000
200C 5 u16 RWS 1..10 1
200C 6 u16 RWS 0..1000 256
200D 0 u16 RWS 0..1 0
200E 0 u16 R - 0
200F 0 u16 R - 0
2010 0 u16 RW 0..1 0
2011 0 u16 RWS 0..0 0
2043 0 i16 R -3000..3000 0
2044 0 i16 R -3000..3000 0
2048 0 u16 R - 0
2049 0 u16 R - 0
204A 0 u16 R - 0
204B 0 u16 RW 0..65535 60
204C 0 u16 RW 0..1 0
2060 0 u16 RWS 0..1000 0
2061 0 u16 RWS 0..1024 0
2062 0 u16 RWS 0..1024 0
603F 0 u16 R - 0
6040 0 u16 RW - 0
6041 0 u16 R - 0
6060 0 i8 RW - 0
6061 0 i8 R - 0
6064 0 i32 R - 0
606C 0 i32 R - 0
607A 0 i32 RW - 0
607C 0 i32 RW - 0
6081 0 i32 RW 0..2147483647 10000
6083 0 i32 RW 0..2147483647 100000
6084 0 i32 RW 0..2147483647 100000
6085 0 i32 RW 0..2147483647 500000
6098 0 i8 RW 17..35 17
6099 1 u32 RWS - 10000
6099 2 u32 RWS - 2000
609A 0 u32 RW - 100000
60B8 0 u16 RW - 0
60B9 0 u16 R - 0
60BA 0 u32 R - 0
60BB 0 u32 R - 0
60BC 0 u32 R - 0
60BD 0 u32 R - 0
60FD 0 u32 R - 0
60FE 1 u32 RWS - 0
60FE 2 u32 RWS - 0
60FF 0 i32 RW - 0
6502 0 u32 R - 165
";

/// Objects of the real family that the manual leaves out, in the same form.
const BEYOND_THE_MANUAL: &str = "
2020 0 u16 R - 4000
2021 0 u16 R - 0
2022 0 u32 R - 4000
2023 1 u16 R - 2000
2023 2 u16 R - 100
2023 3 u16 R - 200
2023 4 u16 R - 30
2023 5 u16 R - 0
2024 1 u16 R - 0
2024 2 u16 R - 10
2024 3 u16 R - 1000
2025 1 u16 R - 200
2025 2 u16 R - 600
2025 3 u16 R - 2000
2026 1 u16 R - 2000
2026 2 u16 R - 1000
2026 3 u16 R - 200
2026 4 u16 R - 400
2026 5 u16 R - 0
2056 0 u16 RW - 128
2150 0 u16 RWS - 1001
2151 0 u16 RWS 0..1 0
605A 0 i16 RW 0..6 2
605B 0 i16 RW 0..1 0
605C 0 i16 RW 0..1 1
605E 0 i16 RW 0..2 1
6077 0 i16 R - 0
60B1 0 i32 RW - 0
60B2 0 i16 RW - 0
60D5 0 u16 R - 0
60D6 0 u16 R - 0
60D7 0 u16 R - 0
60D8 0 u16 R - 0
60F4 0 i32 R - 0
";

struct Row {
    index: u16,
    sub: u8,
    bits: u32,
    signed: bool,
    access: &'static str,
    range: (i64, i64),
    default: i64,
}

fn rows() -> Vec<Row> {
    MANUAL
        .lines()
        .chain(BEYOND_THE_MANUAL.lines())
        .filter(|line| !line.is_empty())
        .map(row)
        .collect()
}

fn row(line: &'static str) -> Row {
    let columns: Vec<&str> = line.split(' ').collect();
    let [index, sub, data_type, access, range, default] = columns[..] else {
        panic!("{line}")
    };
    let bits: u32 = data_type[1..].parse().unwrap();
    let signed = data_type.starts_with('i');
    let whole = if signed {
        (-(1i64 << (bits - 1)), (1 << (bits - 1)) - 1)
    } else {
        (0, (1i64 << bits) - 1)
    };
    Row {
        index: u16::from_str_radix(index, 16).unwrap(),
        sub: sub.parse().unwrap(),
        bits,
        signed,
        access,
        range: range
            .split_once("..")
            .map_or(whole, |(low, high)| (low.parse().unwrap(), high.parse().unwrap())),
        default: default.parse().unwrap(),
    }
}

fn bytes(value: i64, row: &Row) -> Vec<u8> {
    value.to_le_bytes()[..row.bits as usize / 8].to_vec()
}

#[test]
fn the_table_has_the_rows_of_the_manual_and_of_the_family_and_no_others() {
    let mut wanted: Vec<(u16, u8)> = rows().iter().map(|row| (row.index, row.sub)).collect();
    wanted.sort_unstable();
    let present: Vec<(u16, u8)> = DriveObjects::ENTRIES.iter().map(|entry| (entry.index, entry.sub)).collect();
    assert_eq!(present, wanted);
}

// manual: 2.2.1/object 2.2.2/object 2.2.3/object 2.2.4/object 2.2.5/object 2.2.6/object 2.2.7/object 2.2.8/object 2.2.9/object
// manual: 2.2.10/object 2.2.11/object 2.2.12/object 2.2.13/object 2.2.14/object 2.2.15/object 2.2.16/object 2.2.19/object
// manual: 2.2.20/object 2.2.21/object 2.2.22/object 2.2.23/object 2.2.24/object 2.2.25/object 2.2.26/object 2.2.27/object
// manual: 2.2.28/object 2.3.1/object 2.3.2/object 2.3.3/object 2.3.4/object 2.3.5/object 2.3.6/object 2.3.7/object 2.3.8/object
// manual: 2.3.9/object 2.3.10/object 2.3.11/object 2.3.12/object 2.3.13/object 2.3.14/object 2.3.15/object 2.3.16/object
// manual: 2.3.17/object 2.3.18/object 2.3.19/object 2.3.20/object 2.3.21/object 2.3.22/object 2.3.23/object 2.3.24/object
// manual: 2.3.25/object 2.2.17/open-loop 2.3.26/value
#[test]
fn types_ranges_defaults_and_rights_are_those_of_the_manual() {
    for row in rows() {
        let entry = &DriveObjects::ENTRIES[slot(row.index, row.sub)];
        let at = format!("{:04X}:{:02}", row.index, row.sub);
        assert_eq!((u32::from(entry.bits), entry.data_type.is_signed()), (row.bits, row.signed), "{at}");
        assert_eq!((entry.min, entry.max), row.range, "{at}");
        assert_eq!(entry.default, row.default, "{at}");
        assert!(entry.access.is_readable(), "{at}");
        assert_eq!(entry.access.is_writable_everywhere(), row.access.contains('W'), "{at}");
        assert_eq!(entry.access.is_saved(), row.access.contains('S'), "{at}");
    }
}

// manual: 1.1.2/current 1.5/default
#[test]
fn a_new_drive_reads_the_defaults() {
    let objects = DriveObjects::new();
    for row in rows() {
        let mut out = [0; dictionary::MAX_VALUE_SIZE];
        let size = objects.load(slot(row.index, row.sub), &mut out);
        assert_eq!(out[..size], bytes(row.default, &row), "{:04X}:{:02}", row.index, row.sub);
    }
}

#[test]
fn values_outside_of_the_range_or_of_wrong_length_are_refused_and_change_nothing() {
    for row in rows().iter().filter(|row| row.access.contains('W')) {
        let mut rig = Rig::new();
        rig.objects.auto_pi = 0;
        let before = rig.objects.clone();
        let at = format!("{:04X}:{:02}", row.index, row.sub);
        let slot = slot(row.index, row.sub);
        let whole = if row.signed {
            -(1i64 << (row.bits - 1))..1 << (row.bits - 1)
        } else {
            0..1i64 << row.bits
        };
        for (value, abort) in [
            (row.range.0 - 1, AbortCode::ValueTooLow),
            (row.range.1 + 1, AbortCode::ValueTooHigh),
        ] {
            if whole.contains(&value) {
                assert_eq!(rig.objects.store(slot, &bytes(value, row)), Err(abort), "{at} = {value}");
            }
        }
        for length in [0, row.bits as usize / 8 - 1, row.bits as usize / 8 + 1] {
            assert_eq!(rig.objects.store(slot, &vec![0; length]), Err(AbortCode::LengthMismatch), "{at}");
        }
        assert_eq!(rig.objects, before, "{at}");
        for value in [row.range.0, row.range.1] {
            assert_eq!(rig.objects.store(slot, &bytes(value, row)), Ok(()), "{at} = {value}");
        }
    }
}

// manual: 2.3.3/object 2.3.17/object 2.3.18/object 2.3.19/object 2.3.20/object 2.3.21/object 2.3.22/object 2.3.23/object
// manual: 2.4.4/feedback
#[test]
fn what_the_drive_alone_knows_is_mapped_into_inputs_only() {
    let unmappable = [0x204B, 0x204C];
    let outputs_only = [0x2056, 0x60B1, 0x60B2];
    for entry in DriveObjects::ENTRIES {
        let (rx, tx) = (entry.access.is_rx_mappable(), entry.access.is_tx_mappable());
        let expected = match entry.index {
            index if unmappable.contains(&index) => (false, false),
            index if outputs_only.contains(&index) => (true, false),
            _ => (entry.access.is_writable(), true),
        };
        assert_eq!((rx, tx), expected, "{:04X}:{:02}", entry.index, entry.sub);
    }
}

#[test]
fn everything_the_default_mapping_names_can_be_mapped() {
    let outputs = [0x6040, 0x6060, 0x607A, 0x6081, 0x6083, 0x6084, 0x60FF];
    let inputs = [0x6041, 0x6061, 0x6064, 0x606C, 0x60FD, 0x603F, 0x200E, 0x200F, 0x2044, 0x2048];
    for index in outputs {
        let access = DriveObjects::ENTRIES[slot(index, 0)].access;
        assert!(
            access.is_rx_mappable() && access.bits() & Access::RW.bits() == Access::RW.bits(),
            "{index:04X}"
        );
    }
    for index in inputs {
        assert!(DriveObjects::ENTRIES[slot(index, 0)].access.is_tx_mappable(), "{index:04X}");
    }
}

#[test]
fn every_object_says_what_it_means_and_no_two_fields_of_an_object_share_a_name() {
    for (n, entry) in DriveObjects::ENTRIES.iter().enumerate() {
        assert!(entry.doc.trim().len() > 10 && entry.name.trim() == entry.name);
        let twin = DriveObjects::ENTRIES[..n]
            .iter()
            .find(|other| (other.object, other.name) == (entry.object, entry.name));
        assert_eq!(twin, None);
    }
}
