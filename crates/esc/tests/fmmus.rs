//! Logical addressing, by example and against a model that moves single bits.

mod bus;

use bus::{Bus, FmmuEntry, INPUTS, MAILBOX_IN, OUTPUTS};
use proptest::prelude::*;
use wire::EscAccess;
use wire::frame::Command;
use wire::register::*;

const READ: u8 = FmmuEntry::READ;
const WRITE: u8 = FmmuEntry::WRITE;

#[test]
fn the_data_sheets_example() {
    let mut bus = Bus::new(1);
    let example = |physical, kind| FmmuEntry {
        logical: 0x0001_0011,
        length: 3,
        start_bit: 3,
        stop_bit: 0,
        physical,
        physical_bit: 1,
        kind,
    };
    bus.fmmu(0, 0, example(0x1001, READ));
    bus.fmmu(0, 1, example(0x2001, WRITE));
    bus.write(0, 0x1001, &[0xFF; 2]);
    let answer = bus.one(Command::Lrd, 0x0001_0011, &[0; 3]);
    assert_eq!(
        (answer.data, answer.wkc),
        (vec![0xF8, 0xFF, 0x01], 1),
        "fourteen bits, of which the first becomes bit 3"
    );
    bus.write(0, 0x1001, &[0x01, 0x80]);
    assert_eq!(
        bus.one(Command::Lrd, 0x0001_0011, &[0xFF; 3]).data,
        [0x07, 0x00, 0xFE],
        "other bits stay"
    );

    bus.write(0, 0x2001, &[0x00, 0x00]);
    assert_eq!(bus.one(Command::Lwr, 0x0001_0011, &[0xFF; 3]).wkc, 1);
    assert_eq!(bus.read(0, 0x2001, 2).data, [0xFE, 0x7F]);
    assert_eq!(bus.one(Command::Lwr, 0x0001_0012, &[0x00]).wkc, 1, "one byte of three");
    assert_eq!(bus.read(0, 0x2001, 2).data, [0x3E, 0x40]);
}

#[test]
fn slaves_share_a_byte() {
    let mut bus = Bus::new(4);
    for position in 0..4 {
        bus.write(position, 0x1000, &[if position % 2 == 0 { 0xFF } else { 0x00 }]);
        let bit = 2 * position as u8;
        bus.fmmu(
            position,
            0,
            FmmuEntry {
                logical: 0x100,
                length: 1,
                start_bit: bit,
                stop_bit: bit + 1,
                physical: 0x1000,
                physical_bit: 0,
                kind: READ,
            },
        );
    }
    let answer = bus.one(Command::Lrd, 0x100, &[0b1100_1100]);
    assert_eq!((answer.data, answer.wkc), (vec![0b0011_0011], 4));
}

#[test]
fn cyclic_exchange_of_a_drive_with_overlapped_and_separate_images() {
    for inputs_at in [0x1_0000, 0x1_0007] {
        let mut bus = Bus::new(1);
        bus.sync_manager(0, 2, 0x1100, 7, OUTPUTS);
        bus.sync_manager(0, 3, 0x1200, 11, INPUTS);
        bus.fmmu(0, 0, FmmuEntry::whole(0x1_0000, 7, 0x1100, WRITE));
        bus.fmmu(0, 1, FmmuEntry::whole(inputs_at, 11, 0x1200, READ));
        let image: Vec<u8> = (1..=18).collect();
        assert_eq!(bus.one(Command::Lrw, 0x1_0000, &image).wkc, 2, "no inputs yet");
        bus.chip(0).write(0x1200, &[0xEE; 11]);
        let answer = bus.one(Command::Lrw, 0x1_0000, &image);
        assert_eq!(answer.wkc, 3);
        let offset = (inputs_at - 0x1_0000) as usize;
        let mut expected = image.clone();
        expected[offset..offset + 11].fill(0xEE);
        assert_eq!(answer.data, expected);
        let mut outputs = [0; 7];
        bus.chip(0).read(0x1100, &mut outputs);
        assert_eq!(outputs[..], image[..7], "outputs are taken before inputs are put there");
    }
}

#[test]
fn an_image_in_several_frames_arrives_when_its_last_part_does() {
    let mut bus = Bus::new(1);
    bus.sync_manager(0, 2, 0x1100, 8, OUTPUTS);
    bus.fmmu(0, 0, FmmuEntry::whole(0x100, 8, 0x1100, WRITE));
    assert_eq!(bus.one(Command::Lwr, 0x104, &[1; 4]).wkc, 0, "not from the middle");
    assert_eq!(bus.one(Command::Lwr, 0xFE, &[2; 6]).wkc, 1);
    assert_eq!(bus.chip(0).read_u8(0x1100), 0);
    assert_eq!(bus.one(Command::Lwr, 0x104, &[3; 6]).wkc, 1);
    let mut outputs = [0; 8];
    bus.chip(0).read(0x1100, &mut outputs);
    assert_eq!(outputs, [2, 2, 2, 2, 3, 3, 3, 3]);
}

#[test]
fn mailbox_status_can_be_mapped_as_a_byte_and_as_a_bit() {
    let mut bus = Bus::new(1);
    bus.sync_manager(0, 1, 0x1080, 16, MAILBOX_IN);
    let status = SM + SM_SIZE + sync_manager::STATUS;
    bus.fmmu(0, 2, FmmuEntry::whole(0x200, 1, status, READ));
    bus.fmmu(
        0,
        3,
        FmmuEntry {
            start_bit: 6,
            stop_bit: 6,
            physical_bit: 3,
            ..FmmuEntry::whole(0x201, 1, status, READ)
        },
    );
    let answer = bus.one(Command::Lrd, 0x200, &[0, 0xFF]);
    assert_eq!((answer.data, answer.wkc), (vec![0, 0xBF], 1));
    bus.chip(0).write(0x1080, &[1; 16]);
    let answer = bus.one(Command::Lrd, 0x200, &[0, 0x00]);
    assert_eq!((answer.data, answer.wkc), (vec![0x09, 0x40], 1));
}

#[test]
fn registers_are_written_through_fmmus_at_the_end_of_the_frame() {
    let mut bus = Bus::new(1);
    bus.fmmu(0, 0, FmmuEntry::whole(0x300, 4, ECAT_EVENT_MASK - 2, READ | WRITE));
    let answer = bus.one(Command::Lrw, 0x300, &[0xEE, 0xEE, 0x04, 0x01]);
    assert_eq!(
        (answer.data, answer.wkc),
        (vec![0xEE, 0xEE, 0, 0], 3),
        "reserved bytes keep what came"
    );
    assert_eq!(bus.read(0, ECAT_EVENT_MASK - 2, 4).data, [0, 0, 4, 1]);
    bus.fmmu(
        0,
        0,
        FmmuEntry {
            start_bit: 0,
            stop_bit: 0,
            physical_bit: 3,
            ..FmmuEntry::whole(0x300, 1, ECAT_EVENT_MASK, WRITE)
        },
    );
    assert_eq!(bus.one(Command::Lwr, 0x300, &[1]).wkc, 1);
    assert_eq!(bus.read(0, ECAT_EVENT_MASK, 2).data, [0x0C, 1]);
}

#[test]
fn of_two_reading_fmmus_the_lower_number_wins() {
    let mut bus = Bus::new(1);
    bus.write(0, 0x1000, &[0x11]);
    bus.write(0, 0x1001, &[0x22]);
    bus.fmmu(0, 1, FmmuEntry::whole(0x100, 1, 0x1000, READ));
    bus.fmmu(0, 0, FmmuEntry::whole(0x100, 1, 0x1001, READ));
    assert_eq!(bus.one(Command::Lrd, 0x100, &[0]).data, [0x22]);
}

#[test]
fn old_values_out_before_new_values_in() {
    let mut bus = Bus::new(1);
    bus.write(0, 0x1000, &[1, 2]);
    bus.fmmu(0, 0, FmmuEntry::whole(0x100, 2, 0x1000, READ | WRITE));
    let answer = bus.one(Command::Lrw, 0x100, &[7, 8]);
    assert_eq!((answer.data, answer.wkc), (vec![1, 2], 3));
    assert_eq!(bus.read(0, 0x1000, 2).data, [7, 8]);
}

const LOGICAL: u32 = 0x500;
const MEMORY: u16 = 0x1000;

fn entry() -> impl Strategy<Value = FmmuEntry> {
    (0..12u32, 0..6u16, 0..8u8, 0..8u8, 0..12u16, 0..8u8, 0..4u8, any::<bool>()).prop_map(
        |(logical, length, start_bit, stop_bit, physical, physical_bit, kind, whole)| FmmuEntry {
            logical: LOGICAL + logical,
            length,
            start_bit: if whole { 0 } else { start_bit },
            stop_bit: if whole { 7 } else { stop_bit },
            physical: MEMORY + physical,
            physical_bit: if whole { 0 } else { physical_bit },
            kind,
        },
    )
}

/// What a chip with these FMMUs does to data and memory, bit by bit.
fn model(fmmus: &[FmmuEntry], memory: &mut [u8], command: Command, logical: u32, data: &mut [u8]) -> u16 {
    let mapped = |logical_bit: u64, kind: u8| {
        fmmus
            .iter()
            .enumerate()
            .filter(|(_, fmmu)| fmmu.kind & kind != 0)
            .find_map(|(index, fmmu)| {
                let count = i64::from(fmmu.length) * 8 - 8 + i64::from(fmmu.stop_bit) + 1 - i64::from(fmmu.start_bit);
                let first = u64::from(fmmu.logical) * 8 + u64::from(fmmu.start_bit);
                let bit = i64::try_from(logical_bit).unwrap() - i64::try_from(first).unwrap();
                (fmmu.length != 0 && (0..count).contains(&bit)).then(|| {
                    (
                        index,
                        usize::from(fmmu.physical - MEMORY) * 8 + usize::from(fmmu.physical_bit) + bit as usize,
                    )
                })
            })
    };
    let (mut read, mut written) = (false, false);
    for (at, data) in data.iter_mut().enumerate() {
        let incoming = *data;
        let bit = |bit: u8| (u64::from(logical) + at as u64) * 8 + u64::from(bit);
        for b in 0..8 {
            if let Some((_, from)) = mapped(bit(b), READ).filter(|_| command != Command::Lwr) {
                *data = *data & !(1 << b) | (memory[from / 8] >> (from % 8) & 1) << b;
                read = true;
            }
        }
        // Where two FMMUs write one physical bit from the same logical byte, the higher number comes last.
        for (index, b) in (0..fmmus.len()).flat_map(|index| (0..8).map(move |b| (index, b))) {
            if let Some((_, to)) = mapped(bit(b), WRITE).filter(|(by, _)| *by == index && command != Command::Lrd) {
                memory[to / 8] = memory[to / 8] & !(1 << (to % 8)) | (incoming >> b & 1) << (to % 8);
                written = true;
            }
        }
    }
    match command {
        Command::Lrw => u16::from(read) + 2 * u16::from(written),
        _ => u16::from(read || written),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn any_mapping_behaves_like_the_model(
        fmmus in prop::collection::vec(entry(), 0..=8),
        mut memory in prop::array::uniform20(any::<u8>()),
        command in prop::sample::select(&[Command::Lrd, Command::Lwr, Command::Lrw][..]),
        logical in LOGICAL - 3..LOGICAL + 16,
        mut data in prop::collection::vec(any::<u8>(), 0..20),
    ) {
        let mut bus = Bus::new(1);
        for (index, fmmu) in fmmus.iter().enumerate() {
            bus.fmmu(0, index as u16, *fmmu);
        }
        bus.write(0, MEMORY, &memory);
        let answer = bus.one(command, logical, &data);
        let wkc = model(&fmmus, &mut memory, command, logical, &mut data);
        prop_assert_eq!(answer.data, data);
        prop_assert_eq!(answer.wkc, wkc);
        prop_assert_eq!(&bus.read(0, MEMORY, 20).data[..], &memory[..]);
    }
}
