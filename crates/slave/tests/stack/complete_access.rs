//! Complete access: the layout, all or nothing, and every refusal.

use crate::workbench::{Bench, configuration};

const FULL: [u32; 12] = [0x2000_0010; 12];

/// A list with its count as complete access carries it.
fn list<const N: usize>(items: impl IntoIterator<Item = [u8; N]>) -> Vec<u8> {
    let items: Vec<[u8; N]> = items.into_iter().collect();
    [&[items.len() as u8, 0][..], &items.concat()].concat()
}

fn mapping(entries: &[u32]) -> Vec<u8> {
    list(entries.iter().map(|entry| entry.to_le_bytes()))
}

fn assignment(pdos: &[u16]) -> Vec<u8> {
    list(pdos.iter().map(|pdo| pdo.to_le_bytes()))
}

#[test]
fn objects_are_laid_out_as_their_data_types_say() {
    let mut bench = Bench::preop();
    let cases: [(u16, Vec<u8>); 11] = [
        (0x1C00, vec![4, 0, 1, 2, 3, 4]),
        (
            0x1018,
            vec![4, 0, 0x88, 0x0A, 0, 0, 0x01, 0x00, 0x88, 0x0A, 0x04, 0x02, 0, 0, 77, 0, 0, 0],
        ),
        (0x10F1, vec![2, 0, 1, 0, 0, 0, 4, 0]),
        (0x1010, vec![1, 0, 0, 0]),
        (0x1C12, assignment(&[0x1600])),
        (0x1C13, assignment(&[0x1A00])),
        (0x1600, mapping(&[0x2000_0010, 0x2005_0108])),
        (0x1602, vec![0, 0]),
        (0x1A00, mapping(&[0x6041_0010, 0x2005_0220])),
        (0x2005, vec![2, 0, 1, 0xFE, 0xFF, 0xFF, 0xFF]),
        // 1, 2, one bit, and 16 bits of -3 from bit 1 on.
        (0x2008, vec![4, 0, 1, 0, 2, 0xFB, 0xFF, 0x01]),
    ];
    for (index, expected) in cases {
        assert_eq!(bench.upload_complete(index, 0), Ok(expected.clone()), "{index:04X}");
        assert_eq!(
            bench.upload_complete(index, 1),
            Ok(expected[2..].to_vec()),
            "{index:04X} from sub-index 1 on"
        );
    }
}

#[test]
fn sync_parameters_leave_no_room_for_sub_indices_that_do_not_exist() {
    let mut bench = Bench::preop();
    for (index, types, delay) in [(0x1C32, 0x4007_u16, 50_000_u32), (0x1C33, 0x400F, 0)] {
        let mut expected = vec![0; 33];
        expected[0] = 0x20;
        expected[8..10].copy_from_slice(&types.to_le_bytes());
        expected[10..14].copy_from_slice(&500_000_u32.to_le_bytes());
        expected[14..18].copy_from_slice(&50_000_u32.to_le_bytes());
        expected[20..24].copy_from_slice(&delay.to_le_bytes());
        assert_eq!(bench.upload_complete(index, 0), Ok(expected));
    }
}

#[test]
fn complete_access_is_refused_where_there_is_nothing_complete() {
    let mut bench = Bench::preop();
    for (index, sub, code) in [
        (0x1000, 0, 0x0601_0000),
        (0x1008, 0, 0x0601_0000),
        (0x2000, 0, 0x0601_0000),
        (0x2000, 1, 0x0601_0000),
        (0x1018, 2, 0x0601_0000),
        (0x2005, 0xFF, 0x0601_0000),
        (0x1003, 0, 0x0602_0000),
        (0x2FFF, 1, 0x0602_0000),
    ] {
        assert_eq!(bench.upload_complete(index, sub), Err(code), "{index:04X}:{sub:02X}");
        assert_eq!(bench.download_complete(index, sub, &[1, 0]), Err(code), "{index:04X}:{sub:02X}");
    }
}

#[test]
fn lists_are_replaced_in_one_go() {
    let mut bench = Bench::preop();
    for (index, value) in [
        (0x1C12, assignment(&[0x1601, 0x1600, 0x1602])),
        (0x1C12, assignment(&[])),
        (0x1C13, assignment(&[0x1A02])),
        (0x1600, mapping(&FULL)),
        (0x1600, mapping(&[])),
        (0x1A01, mapping(&[0x6041_0010, 0x0000_0008, 0x2006_0001])),
    ] {
        assert_eq!(bench.download_complete(index, 0, &value), Ok(()), "{index:04X}");
        assert_eq!(bench.upload_complete(index, 0), Ok(value), "{index:04X}");
    }
}

#[test]
fn a_list_with_a_mistake_stays_as_it_was() {
    let too_many = [&[13, 0][..], &[0; 52]].concat();
    let four_pdos = [&[4, 0][..], &[0, 0x16, 1, 0x16, 2, 0x16, 0, 0x16]].concat();
    let cases: [(u16, Vec<u8>, u32); 12] = [
        (0x1C12, assignment(&[0x1600, 0x1600]), 0x0604_0043),
        (0x1C12, assignment(&[0x1601, 0x1A00]), 0x0609_0030),
        (0x1C12, assignment(&[0x1601, 0]), 0x0609_0030),
        (0x1C12, vec![1, 0, 0, 0x16, 1, 0x16], 0x0607_0010),
        (0x1C12, vec![2, 0, 0, 0x16], 0x0607_0010),
        (0x1C12, vec![1], 0x0607_0010),
        (0x1C12, four_pdos, 0x0607_0010),
        (0x1C12, vec![200, 0, 0, 0x16], 0x0609_0031),
        (0x1600, mapping(&[0x2007_0040, 0x2FFF_0010]), 0x0602_0000),
        (0x1600, mapping(&[0x2007_0040, 0x6041_0010]), 0x0604_0041),
        (0x1600, mapping(&[0x2007_0040, 0x2005_0308]), 0x0609_0011),
        (0x1600, too_many, 0x0607_0010),
    ];
    for (index, value, code) in cases {
        let mut bench = Bench::preop();
        let before = bench.upload_complete(index, 0);
        assert_eq!(bench.download_complete(index, 0, &value), Err(code), "{index:04X} {value:02X?}");
        assert_eq!(bench.upload_complete(index, 0), before, "{index:04X} {value:02X?}");
    }
}

#[test]
fn entries_of_a_list_without_its_count_need_the_count_to_be_zero() {
    let mut bench = Bench::preop();
    let pdos = [1, 0x16, 0, 0x16];
    assert_eq!(bench.download_complete(0x1C12, 1, &pdos), Err(0x0601_0003));
    bench.download(0x1C12, 0, &[0]).unwrap();
    assert_eq!(bench.download_complete(0x1C12, 1, &pdos[..3]), Err(0x0607_0010));
    assert_eq!(bench.download_complete(0x1C12, 1, &pdos), Ok(()));
    assert_eq!(bench.upload_complete(0x1C12, 0), Ok(vec![0, 0]), "the count is the master's to set");
    bench.download(0x1C12, 0, &[2]).unwrap();
    assert_eq!(bench.upload_complete(0x1C12, 1), Ok(pdos.to_vec()));
}

#[test]
fn an_assignment_by_complete_access_takes_effect() {
    let mut bench = Bench::preop();
    bench.download_complete(0x1C12, 0, &assignment(&[0x1601])).unwrap();
    bench.download_complete(0x1601, 0, &mapping(&[0x2007_0040])).unwrap();
    bench.set_process_data(8, 6);
    assert_eq!(bench.request(4), (4, 0));
}

#[test]
fn lists_and_records_are_written_in_the_states_their_entries_are() {
    let mut bench = Bench::safeop();
    for (index, value, outcome) in [
        (0x1C12, assignment(&[0x1600]), Err(0x0800_0022)),
        (0x1A00, mapping(&[]), Err(0x0800_0022)),
        (0x200A, vec![1, 0, 6, 0], Err(0x0800_0022)),
        (0x1C32, vec![0; 33], Err(0x0800_0022)),
        (0x2005, vec![2, 0, 9, 1, 0, 0, 0], Ok(())),
    ] {
        assert_eq!(bench.download_complete(index, 0, &value), outcome, "{index:04X}");
    }
    assert!(bench.upload_complete(0x1C12, 0).is_ok(), "reading is allowed");
}

#[test]
fn records_take_all_their_values_or_none() {
    let mut bench = Bench::preop();
    bench.download_complete(0x2008, 0, &[4, 0, 7, 0, 99, 0x0A, 0, 0]).unwrap();
    let objects = &bench.lamp.objects;
    assert_eq!((objects.mixed_first, objects.mixed_bit, objects.mixed_last), (7, false, 5));
    assert_eq!(objects.mixed_fixed, 2, "read-only entries are ignored");
    bench.download_complete(0x2008, 1, &[8, 0, 0, 1, 0, 0]).unwrap();
    assert_eq!((bench.lamp.objects.mixed_first, bench.lamp.objects.mixed_bit), (8, true));

    let before = bench.lamp.objects.clone();
    for (value, code) in [
        (&[4, 0, 11, 0, 0, 0, 0, 0][..], 0x0609_0031),
        (&[4, 0, 3, 0, 0, 22, 0, 0], 0x0609_0031),
        (&[4, 0, 3, 0, 0, 0, 0xFF, 1], 0x0609_0032),
        (&[4, 0, 3, 0, 0, 0, 0], 0x0607_0010),
        (&[4, 0, 3, 0, 0, 0, 0, 0, 0], 0x0607_0010),
    ] {
        assert_eq!(bench.download_complete(0x2008, 0, value), Err(code), "{value:02X?}");
        assert_eq!(bench.lamp.objects, before, "{value:02X?}");
    }
    bench.lamp.locked = true;
    assert_eq!(bench.download_complete(0x2008, 0, &[4, 0, 3, 0, 0, 0, 0, 0]), Err(0x0800_0022));
    assert_eq!(bench.lamp.objects, before);
}

#[test]
fn records_without_a_writable_entry_are_read_only() {
    let mut bench = Bench::preop();
    for (index, value) in [(0x2009, vec![1, 0, 5, 0]), (0x1018, vec![0; 18]), (0x1C00, vec![4, 0, 1, 2, 3, 4])] {
        assert_eq!(bench.download_complete(index, 0, &value), Err(0x0601_0002), "{index:04X}");
    }
}

#[test]
fn sync_parameters_are_restored_when_one_is_refused() {
    let mut bench = Bench::preop();
    let mut value = bench.upload_complete(0x1C32, 0).unwrap();
    value[2] = 1;
    value[24..28].copy_from_slice(&2_000_000_u32.to_le_bytes());
    assert_eq!(bench.download_complete(0x1C32, 0, &value), Ok(()));
    assert_eq!(bench.upload_complete(0x1C32, 0), Ok(value.clone()));
    let refused = [&[0x20, 0, 9, 0][..], &value[4..]].concat();
    assert_eq!(bench.download_complete(0x1C32, 0, &refused), Err(0x0609_0030));
    assert_eq!(bench.upload_complete(0x1C32, 0), Ok(value));
}

#[test]
fn transfers_of_every_length_pass_mailboxes_of_every_size() {
    for mailbox in 36..=128 {
        let mut bench = Bench::preop_with(configuration(), mailbox);
        for count in [0, 1, 4, 5, 6, 7, 11, 12] {
            let value = mapping(&FULL[..count]);
            assert_eq!(
                bench.download_complete(0x1600, 0, &value),
                Ok(()),
                "{count} entries through {mailbox}"
            );
            assert_eq!(bench.upload_complete(0x1600, 0), Ok(value), "{count} entries through {mailbox}");
        }
        let mut wrong = mapping(&FULL);
        wrong[46] = 0xFF;
        let before = bench.upload_complete(0x1600, 0);
        assert_eq!(bench.download_complete(0x1600, 0, &wrong), Err(0x0604_0041), "through {mailbox}");
        assert_eq!(bench.upload_complete(0x1600, 0), before);
        assert_eq!(bench.upload_complete(0x1C33, 0).map(|value| value.len()), Ok(33));
    }
}
