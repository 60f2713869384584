//! PDO mapping, assignment, and process data bit by bit.

use dictionary::AbortCode;
use proptest::prelude::*;

use crate::workbench::{Bench, MILLISECOND};

/// Writes a mapping the way SOEM's and IgH's users do.
fn map(bench: &mut Bench, index: u16, entries: &[u32]) -> Result<(), u32> {
    bench.download(index, 0, &[0])?;
    for (position, entry) in entries.iter().enumerate() {
        bench.download(index, position as u8 + 1, &entry.to_le_bytes())?;
    }
    bench.download(index, 0, &[entries.len() as u8])
}

fn assign(bench: &mut Bench, index: u16, pdos: &[u16]) -> Result<(), u32> {
    bench.download(index, 0, &[0])?;
    for (position, pdo) in pdos.iter().enumerate() {
        bench.download(index, position as u8 + 1, &pdo.to_le_bytes())?;
    }
    bench.download(index, 0, &[pdos.len() as u8])
}

/// OP with process data of these lengths.
fn start(bench: &mut Bench, outputs: u16, inputs: u16, data: &[u8]) {
    bench.set_process_data(outputs, inputs);
    assert_eq!(bench.request(4), (4, 0));
    bench.request(8);
    assert!(bench.chip.outputs(data));
    bench.tick();
    assert_eq!(bench.chip.status(), 8);
}

#[test]
fn a_mapping_is_rewritten_while_its_pdo_is_assigned_as_igh_does() {
    let mut bench = Bench::preop();
    map(&mut bench, 0x1600, &[0x2007_0040, 0x2000_0010]).unwrap();
    assign(&mut bench, 0x1C12, &[0x1600]).unwrap();
    start(&mut bench, 10, 6, &[1, 2, 3, 4, 5, 6, 7, 8, 42, 0]);
    assert_eq!(
        (bench.lamp.objects.wide, bench.lamp.objects.brightness),
        (0x0807_0605_0403_0201, 42)
    );
}

#[test]
fn several_pdos_with_the_same_object_work_and_the_last_value_counts() {
    let mut bench = Bench::preop();
    map(&mut bench, 0x1602, &[0x2000_0010]).unwrap();
    assign(&mut bench, 0x1C12, &[0x1600, 0x1601, 0x1602]).unwrap();
    start(&mut bench, 11, 6, &[1, 0, 9, 2, 0, 4, 0, 0, 0, 3, 0]);
    let objects = &bench.lamp.objects;
    assert_eq!((objects.brightness, objects.red, objects.green), (3, 9, 4));
}

#[test]
fn entries_and_assignments_can_be_written_only_while_their_count_is_zero() {
    let mut bench = Bench::preop();
    assert_eq!(bench.download(0x1600, 1, &0x2000_0010_u32.to_le_bytes()), Err(0x0601_0003));
    assert_eq!(bench.download(0x1C12, 1, &0x1600_u16.to_le_bytes()), Err(0x0601_0003));
    // The count of the assignment does not matter for the mapping.
    bench.download(0x1600, 0, &[0]).unwrap();
    assert_eq!(bench.download(0x1600, 1, &0x2000_0010_u32.to_le_bytes()), Ok(()));
    assert_eq!(bench.upload(0x1600, 1), Err(0x0609_0011), "not counted, not readable");
    bench.download(0x1600, 0, &[1]).unwrap();
    assert_eq!(bench.upload(0x1600, 1).unwrap(), 0x2000_0010_u32.to_le_bytes());
}

#[test]
fn mapping_entries_are_checked_where_they_are_written() {
    for (index, entry, code) in [
        (0x1600, 0x2FFF_0010_u32, AbortCode::ObjectNotFound),
        (0x1600, 0x2005_0310, AbortCode::SubIndexNotFound),
        (0x1600, 0x2005_0008, AbortCode::NotMappable),
        (0x1600, 0x6041_0010, AbortCode::NotMappable),
        (0x1600, 0x2000_0008, AbortCode::NotMappable),
        (0x1600, 0x2000_0020, AbortCode::NotMappable),
        (0x1600, 0x10F8_0040, AbortCode::NotMappable),
        (0x1600, 0x0000_0110, AbortCode::NotMappable),
        (0x1600, 0x0005_0010, AbortCode::NotMappable),
        (0x1A00, 0x2002_0008, AbortCode::NotMappable),
        (0x1A00, 0x0005_0008, AbortCode::NotMappable),
        (0x1A00, 0x6502_0020, AbortCode::NotMappable),
        (0x1A00, 0x1008_0000, AbortCode::NotMappable),
    ] {
        let mut bench = Bench::preop();
        bench.download(index, 0, &[0]).unwrap();
        assert_eq!(
            bench.download(index, 1, &entry.to_le_bytes()),
            Err(code.code()),
            "{index:04X} {entry:08X}"
        );
    }
}

#[test]
fn counts_are_checked_against_what_they_count() {
    let mut bench = Bench::preop();
    assert_eq!(bench.download(0x1600, 0, &[13]), Err(AbortCode::PdoLengthExceeded.code()));
    assert_eq!(
        bench.download(0x1602, 0, &[1]),
        Err(AbortCode::NotMappable.code()),
        "an entry never written"
    );
    assert_eq!(
        map(&mut bench, 0x1602, &[0xFF; 12]),
        Err(AbortCode::PdoLengthExceeded.code()),
        "382 bytes"
    );
    assert_eq!(bench.download(0x1C12, 0, &[4]), Err(AbortCode::ValueTooHigh.code()));
    assert_eq!(
        bench.download(0x1C12, 0, &[2]),
        Err(AbortCode::ValueRange.code()),
        "an assignment never written"
    );
    assert_eq!(assign(&mut bench, 0x1C12, &[0x1A00]), Err(AbortCode::ValueRange.code()));
    assert_eq!(assign(&mut bench, 0x1C13, &[0x1A03]), Err(AbortCode::ValueRange.code()));
    assert_eq!(
        assign(&mut bench, 0x1C12, &[0x1601, 0x1601]),
        Err(AbortCode::ParameterIncompatible.code())
    );
    // Masters clear what they do not use.
    bench.download(0x1C12, 2, &[0, 0]).unwrap();
    bench.download(0x1C12, 0, &[1]).unwrap();
}

#[test]
fn a_configuration_survives_states_and_init() {
    let mut bench = Bench::preop();
    assign(&mut bench, 0x1C12, &[0x1601]).unwrap();
    bench.request(0x11);
    bench.request(0x12);
    assert_eq!(bench.upload(0x1C12, 1).unwrap(), [0x01, 0x16]);
}

#[test]
fn gaps_and_single_bits_lie_where_the_mapping_says() {
    let mut bench = Bench::preop();
    // 3 bits gap, 1 bit, 5 bits gap, 8 bits, 1 dummy bit, 16 bits: 34 bits.
    map(
        &mut bench,
        0x1600,
        &[0x0000_0003, 0x2006_0001, 0x0000_0005, 0x2005_0108, 0x0001_0001, 0x2000_0010],
    )
    .unwrap();
    map(
        &mut bench,
        0x1A00,
        &[0x0000_0003, 0x2006_0001, 0x0000_0005, 0x2005_0108, 0x0000_0001, 0x2000_0010],
    )
    .unwrap();
    let word = 1_u64 << 3 | 0xA5 << 9 | 0x0063 << 18;
    start(&mut bench, 5, 5, &word.to_le_bytes()[..5]);
    let objects = &bench.lamp.objects;
    assert_eq!((objects.on, objects.red, objects.brightness), (true, 0xA5, 0x63));
    bench.advance(MILLISECOND);
    assert_eq!(bench.chip.inputs().unwrap(), word.to_le_bytes()[..5]);
}

#[test]
fn values_out_of_range_and_vetoed_objects_keep_what_they_had() {
    let mut bench = Bench::preop();
    map(&mut bench, 0x1600, &[0x2000_0010, 0x2002_0008]).unwrap();
    bench.lamp.locked = true;
    start(&mut bench, 3, 6, &[101, 0, 99]);
    assert_eq!((bench.lamp.objects.brightness, bench.lamp.objects.guarded), (50, 7));
    bench.lamp.locked = false;
    bench.chip.outputs(&[100, 0, 99]);
    bench.tick();
    assert_eq!((bench.lamp.objects.brightness, bench.lamp.objects.guarded), (100, 99));
}

#[test]
fn outputs_are_taken_in_op_only() {
    let mut bench = Bench::safeop();
    bench.chip.outputs(&[5, 0, 6]);
    assert_eq!(bench.tick().sync, None);
    assert_eq!(bench.lamp.objects.brightness, 50);
    // What came last takes effect with OP itself, before anything of an earlier session could.
    let report = {
        bench.chip.request(8);
        bench.tick()
    };
    assert!(report.sync.is_some_and(|sync| sync.fresh));
    assert_eq!(bench.lamp.objects.brightness, 5);
    bench.request(4);
    bench.chip.outputs(&[7, 0, 8]);
    bench.tick();
    assert_eq!(bench.lamp.objects.brightness, 5);
}

#[test]
fn the_device_time_can_be_mapped() {
    let mut bench = Bench::preop();
    map(&mut bench, 0x1A00, &[0x10F8_0040]).unwrap();
    start(&mut bench, 3, 8, &[0; 3]);
    bench.advance(7 * MILLISECOND);
    assert_eq!(bench.chip.inputs().unwrap(), (7 * MILLISECOND).to_le_bytes());
}

proptest! {
    #[test]
    fn any_outputs_come_back_as_the_same_inputs(data in any::<[u8; 13]>()) {
        let mut bench = Bench::preop();
        let entries = [0x2007_0040, 0x2005_0220, 0x2005_0108];
        map(&mut bench, 0x1600, &entries).unwrap();
        map(&mut bench, 0x1A00, &entries).unwrap();
        let mut data = data;
        // The table's range for eight bytes ends at the largest positive number.
        data[7] &= 0x7F;
        start(&mut bench, 13, 13, &data);
        bench.advance(MILLISECOND);
        prop_assert_eq!(bench.chip.inputs().unwrap(), data);
    }
}
