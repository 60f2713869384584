//! Working counters and addressing of all commands.

mod bus;

use bus::{Bus, FmmuEntry, STATION};
use wire::frame::{Command, physical_address};
use wire::register::*;
use wire::{EscAccess, Nanos};

/// A register that the bus only reads, one that it reads and writes, one that is not there, and memory.
const READ_ONLY: u16 = AL_STATUS;
const READ_WRITE: u16 = STATION_ADDRESS;
const MISSING: u16 = 0x0A00;
const MEMORY: u16 = 0x1000;

const READS: u8 = 1;
const WRITES: u8 = 2;

/// Commands that address a slave physically, and what they do.
const ADDRESSED: [(Command, u8); 6] = [
    (Command::Aprd, READS),
    (Command::Apwr, WRITES),
    (Command::Aprw, READS | WRITES),
    (Command::Fprd, READS),
    (Command::Fpwr, WRITES),
    (Command::Fprw, READS | WRITES),
];

/// What a slave in which the places of `rights` answer adds to the working counter.
fn increment(does: u8, rights: u8) -> u16 {
    match (does, does & rights) {
        (READS, READS) | (WRITES, WRITES) => 1,
        (3, done) => u16::from(done & READS) + u16::from(done & WRITES),
        _ => 0,
    }
}

/// Places and what can be done there.
const PLACES: [(u16, u8); 4] = [
    (READ_ONLY, READS),
    (READ_WRITE, READS | WRITES),
    (MISSING, 0),
    (MEMORY, READS | WRITES),
];

fn is_positional(command: Command) -> bool {
    matches!(command, Command::Aprd | Command::Apwr | Command::Aprw | Command::Armw)
}

#[test]
fn addressed_commands_count_what_one_slave_could_do() {
    for (command, does) in ADDRESSED {
        for (place, rights) in PLACES {
            let mut bus = Bus::new(3);
            let adp = if is_positional(command) { 0xFFFF } else { STATION + 1 };
            let data = bus.read(1, place, 2).data;
            let answer = bus.one(command, physical_address(adp, place), &data);
            assert_eq!(answer.wkc, increment(does, rights), "{command:?} at {place:#06x}");
            let nobody = if is_positional(command) { 1 } else { 0x2000 };
            let answer = bus.one(command, physical_address(nobody, place), &data);
            assert_eq!((answer.wkc, answer.data), (0, data), "{command:?} at {place:#06x} to nobody");
        }
    }
}

#[test]
fn broadcasts_count_what_every_slave_could_do() {
    for (command, does) in [(Command::Brd, READS), (Command::Bwr, WRITES), (Command::Brw, READS | WRITES)] {
        for (place, rights) in PLACES {
            let mut bus = Bus::new(3);
            let answer = bus.one(command, physical_address(7, place), &[0, 0]);
            assert_eq!(answer.wkc, 3 * increment(does, rights), "{command:?} at {place:#06x}");
            assert_eq!(answer.adp, 10, "{command:?} is counted on by every slave");
        }
    }
}

#[test]
fn read_multiple_write_counts_one_for_reader_and_writers() {
    for (command, adp) in [(Command::Armw, 0xFFFF), (Command::Frmw, STATION + 1)] {
        for (place, rights) in PLACES {
            let mut bus = Bus::new(3);
            let reader = increment(READS, rights);
            let writer = increment(WRITES, rights);
            let answer = bus.one(command, physical_address(adp, place), &[0, 0]);
            assert_eq!(answer.wkc, reader + 2 * writer, "{command:?} at {place:#06x}");
        }
    }
}

#[test]
fn read_multiple_write_copies_from_the_addressed_slave_to_those_behind_it() {
    let mut bus = Bus::new(4);
    for position in 0..4 {
        bus.write(position, MEMORY, &[position as u8 + 1]);
    }
    let answer = bus.one(Command::Frmw, physical_address(STATION + 1, MEMORY), &[0xEE]);
    assert_eq!((answer.data, answer.wkc, answer.adp), (vec![2], 4, STATION + 1));
    let memory: Vec<u8> = (0..4).map(|position| bus.read(position, MEMORY, 1).data[0]).collect();
    assert_eq!(memory, [0xEE, 2, 2, 2], "those before it write what the master sent");
}

#[test]
fn logical_commands_count_once_however_many_fmmus_match() {
    let both = READS | WRITES;
    // Directions of two FMMUs side by side, and what they add up to.
    for (kinds, rights) in [([1, 1], READS), ([2, 2], WRITES), ([1, 2], both), ([0, 0], 0), ([3, 0], both)] {
        for (command, does) in [(Command::Lrd, READS), (Command::Lwr, WRITES), (Command::Lrw, both)] {
            let mut bus = Bus::new(2);
            for position in 0..2 {
                for (index, kind) in kinds.into_iter().enumerate() {
                    let offset = 4 * index as u16;
                    let logical = 0x1_0000 + 0x100 * u32::from(position) + u32::from(offset);
                    bus.fmmu(position, index as u16, FmmuEntry::whole(logical, 4, MEMORY + offset, kind));
                }
            }
            let answer = bus.one(command, 0x1_0000, &[0; 8]);
            assert_eq!(answer.wkc, increment(does, rights), "{command:?} with FMMUs {kinds:?}");
            let answer = bus.one(command, 0x1_0000, &[0; 0x108]);
            assert_eq!(answer.wkc, 2 * increment(does, rights), "{command:?} over both slaves");
            assert_eq!(bus.one(command, 0x1_0008, &[0; 0xF8]).wkc, 0, "{command:?} between them");
        }
    }
}

#[test]
fn no_operation_and_unknown_commands_touch_nothing() {
    for command in [Command::Nop, Command::Unknown(15), Command::Unknown(0xFF)] {
        let mut bus = Bus::new(2);
        let answer = bus.one(command, physical_address(0, MEMORY), &[1, 2]);
        assert_eq!((answer.adp, answer.wkc, answer.data), (0, 0, vec![1, 2]));
        assert_eq!(bus.read(0, MEMORY, 2).data, [0, 0]);
    }
}

#[test]
fn one_good_byte_is_success_and_the_others_are_left_alone() {
    let mut bus = Bus::new(1);
    // The masters' habits: whole blocks, of which only a part is there (KickCAT, SOEM, gatorcat, TwinCAT).
    for (first, length) in [
        (FMMU, 256),
        (SM, 128),
        (SM, 256),
        (RX_ERROR_COUNTERS, 20),
        (RX_ERROR_COUNTERS, 8),
        (DC_CYCLIC_CONTROL, 2),
    ] {
        assert_eq!(bus.write(0, first, &vec![0; length]), 1, "{first:#06x}, {length} bytes");
    }
    for (first, length) in [(FMMU + 128, 128), (SM + 64, 64)] {
        assert_eq!(bus.write(0, first, &vec![0; length]), 0, "{first:#06x}, {length} bytes");
    }
    // AL status and AL status code with reserved bytes between them, as SOEM and KickCAT read them.
    let answer = bus.one(Command::Fprd, physical_address(STATION, AL_STATUS), &[0xEE; 6]);
    assert_eq!((answer.data, answer.wkc), (vec![1, 0, 0, 0, 0, 0], 1));
    // The last byte of memory and what is behind.
    assert_eq!(bus.write(0, 0x2FFF, &[1, 2, 3]), 1);
    assert_eq!(bus.write(0, 0x3000, &[1, 2, 3]), 0);
    assert_eq!(bus.read(0, 0xFFFF, 4).wkc, 0);
    assert_eq!(bus.read(0, 0x2FFF, 1).data, [1]);
}

#[test]
fn empty_datagrams_succeed_nowhere() {
    let mut bus = Bus::new(1);
    for command in Command::ALL {
        assert_eq!(bus.one(command, physical_address(0, 0), &[]).wkc, 0, "{command:?}");
    }
}

#[test]
fn working_counter_and_position_wrap() {
    let mut bus = Bus::new(2);
    assert_eq!(bus.one(Command::Brd, physical_address(0xFFFF, TYPE), &[0]).adp, 1);
    let mut frame = [0; 60];
    let mut builder = wire::frame::FrameBuilder::new(&mut frame, bus::SOURCE).unwrap();
    builder.datagram(Command::Brd, 0, 0, &[0]).unwrap();
    builder.finish();
    frame[16 + 11..16 + 13].copy_from_slice(&[0xFF, 0xFF]);
    let _ = bus.segment.process(&mut frame, Nanos(0));
    assert_eq!(frame[16 + 11..16 + 13], [1, 0]);
}

#[test]
fn reads_return_old_values_and_exchange_writes_new_ones() {
    let mut bus = Bus::new(1);
    bus.write(0, MEMORY, &[0x0F]);
    let at = physical_address(STATION, MEMORY);
    assert_eq!(bus.one(Command::Fprw, at, &[0x33]).data, [0x0F]);
    assert_eq!(bus.one(Command::Brd, at, &[0x44]).data, [0x77], "broadcast reads are ORed");
    assert_eq!(bus.one(Command::Brw, at, &[0x80]).data, [0xB3]);
    assert_eq!(bus.one(Command::Fpwr, at, &[0x11]).data, [0x11], "written data come back unchanged");
    assert_eq!(bus.read(0, MEMORY, 1).data, [0x11]);
}

#[test]
fn station_alias_counts_only_when_enabled() {
    let mut bus = Bus::new(2);
    for (position, alias) in [(0, 0x00BBu16), (1, 0x00CC)] {
        bus.chip(position).write(STATION_ALIAS, &alias.to_le_bytes());
    }
    let by_alias = physical_address(0x00CC, TYPE);
    assert_eq!(bus.one(Command::Fprd, by_alias, &[0]).wkc, 0);
    assert_eq!(bus.write(1, DL_CONTROL + 3, &[1]), 1);
    assert_eq!(bus.one(Command::Fprd, by_alias, &[0]).wkc, 1);
    assert_eq!(
        bus.one(Command::Frmw, physical_address(0x00CC, TYPE), &[0]).wkc,
        1,
        "reads there, cannot write elsewhere"
    );
    assert_eq!(
        bus.one(Command::Fpwr, physical_address(STATION, STATION_ALIAS), &[0, 0]).wkc,
        0,
        "the bus cannot write it"
    );
    assert_eq!(bus.read(1, TYPE, 1).wkc, 1, "the station address still counts");
}
