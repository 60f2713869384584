//! Reset by register, and the physical read/write offset.

mod bus;

use bus::{Bus, STATION};
use wire::EscAccess;
use wire::frame::{Command, physical_address};
use wire::register::*;

/// Writes one letter to 0x0040 of the first chip, by position.
fn letter(bus: &mut Bus, letter: u8) -> u16 {
    bus.one(Command::Apwr, physical_address(0, RESET), &[letter]).wkc
}

fn prepared() -> Bus {
    let mut bus = Bus::new(2);
    bus.sync_manager(0, 2, 0x1100, 4, bus::OUTPUTS);
    bus.write(0, USER_RAM, &[7]);
    bus.write(0, AL_CONTROL, &[2, 0]);
    bus.chip(0).write(AL_STATUS, &[2, 0]);
    bus
}

fn is_as_after_power_on(bus: &mut Bus) -> bool {
    let mut read = |ado, length| bus.one(Command::Aprd, physical_address(0, ado), &vec![0xEE; length]).data;
    read(STATION_ADDRESS, 2) == [0, 0]
        && read(AL_STATUS, 2) == [1, 0]
        && read(USER_RAM, 1) == [0]
        && read(SM + 16, 5) == [0; 5]
        && read(STATION_ALIAS, 1) == [0xAA]
}

#[test]
fn three_letters_in_three_frames_reset_the_chip() {
    let mut bus = prepared();
    assert!(!is_as_after_power_on(&mut bus));
    for (at, byte) in b"RES".iter().enumerate() {
        assert_eq!(bus.chip(0).resets(), 0, "before letter {at}");
        assert_eq!(letter(&mut bus, *byte), 1);
    }
    assert_eq!((bus.chip(0).resets(), bus.chip(1).resets()), (1, 0));
    assert!(is_as_after_power_on(&mut bus));
    assert_eq!(bus.read_u16(1, STATION_ADDRESS), STATION + 1, "the neighbour goes on");
    assert_eq!(
        bus.one(Command::Aprd, physical_address(0, DL_STATUS), &[0; 2]).data[1],
        0x5A,
        "so do the links"
    );
    assert_eq!(
        bus.one(Command::Apwr, physical_address(0, AL_CONTROL), &[1, 0]).wkc,
        1,
        "not locked"
    );
}

#[test]
fn a_broadcast_resets_all_chips_at_once() {
    let mut bus = Bus::new(3);
    for byte in b"RES" {
        assert_eq!(bus.one(Command::Bwr, physical_address(0, RESET), &[*byte]).wkc, 3);
    }
    assert_eq!([0, 1, 2].map(|position| bus.chip(position).resets()), [1; 3]);
    assert_eq!(bus.one(Command::Brd, physical_address(0, STATION_ADDRESS), &[0; 2]).data, [0, 0]);
}

#[test]
fn the_register_shows_how_far_the_sequence_has_come() {
    let mut bus = prepared();
    letter(&mut bus, b'R');
    assert_eq!(bus.chip(0).read_u16(RESET) & 0xFF, 1);
    letter(&mut bus, b'E');
    assert_eq!(bus.chip(0).read_u16(RESET) & 0xFF, 2);
    letter(&mut bus, b'X');
    assert_eq!(bus.chip(0).read_u16(RESET) & 0xFF, 0);
}

#[test]
fn a_sequence_that_is_interrupted_does_nothing() {
    for letters in [&b"RE"[..], b"ES", b"RXES", b"RRS", b"RSE", b"RER ES", b"res", b"SER", b"RE S"] {
        let mut bus = prepared();
        for byte in letters {
            letter(&mut bus, *byte);
        }
        assert_eq!(bus.chip(0).resets(), 0, "{letters:?}");
    }
    let mut bus = prepared();
    letter(&mut bus, b'R');
    letter(&mut bus, b'E');
    bus.one(Command::Brd, physical_address(0, TYPE), &[0]);
    letter(&mut bus, b'S');
    assert_eq!(bus.chip(0).resets(), 0, "a frame without a letter came between");
    assert!(!is_as_after_power_on(&mut bus));
}

#[test]
fn a_sequence_may_begin_again_at_any_time() {
    let mut bus = prepared();
    for byte in b"RERRES" {
        letter(&mut bus, *byte);
    }
    assert_eq!(bus.chip(0).resets(), 1);
    for byte in b"RES" {
        letter(&mut bus, *byte);
    }
    assert_eq!(bus.chip(0).resets(), 2);
}

#[test]
fn letters_in_one_frame_count_as_one() {
    let mut bus = prepared();
    let at = physical_address(0, RESET);
    let stay = |letter: &'static [u8]| (Command::Fpwr, physical_address(STATION, RESET), letter);
    bus.send(&[stay(b"R"), stay(b"E"), stay(b"S")]);
    assert_eq!(bus.chip(0).resets(), 0);
    assert_eq!(bus.one(Command::Apwr, at, b"RES").wkc, 1, "0x0041 is the slave's");
    assert_eq!(bus.chip(0).resets(), 0);
}

#[test]
fn the_slave_resets_its_chip_through_its_own_register() {
    let mut bus = prepared();
    bus.chip(0).write(RESET, b"R");
    for byte in [b'R', b'E'] {
        bus.chip(0).write(RESET_PDI, &[byte]);
    }
    assert_eq!(bus.chip(0).read_u16(RESET), 0x0200);
    assert_eq!(bus.write(0, RESET_PDI, b"S"), 0, "not from the bus");
    bus.chip(0).write(RESET_PDI, b"S");
    assert_eq!(bus.chip(0).resets(), 1);
    assert!(is_as_after_power_on(&mut bus));
}

#[test]
fn a_reset_opens_loops_that_the_master_closed() {
    let mut bus = Bus::new(2);
    bus.write(0, DL_CONTROL + 1, &[3 << 2]);
    assert_eq!(bus.one(Command::Brd, 0, &[0]).wkc, 1);
    for byte in b"RES" {
        letter(&mut bus, *byte);
    }
    assert_eq!(bus.one(Command::Brd, 0, &[0]).wkc, 2);
}

#[test]
fn read_write_commands_write_as_far_behind_as_the_offset_says() {
    let mut bus = Bus::new(1);
    bus.write(0, 0x1000, &[1, 2, 3, 4]);
    bus.write(0, PHYSICAL_OFFSET, &[0x10, 0]);
    let answer = bus.one(Command::Fprw, physical_address(STATION, 0x1000), &[5, 6, 7, 8]);
    assert_eq!((answer.data, answer.wkc), (vec![1, 2, 3, 4], 3));
    assert_eq!(bus.read(0, 0x1000, 4).data, [1, 2, 3, 4]);
    assert_eq!(bus.read(0, 0x1010, 4).data, [5, 6, 7, 8]);
    let answer = bus.one(Command::Aprw, physical_address(0, 0x2FF0), &[9]);
    assert_eq!((answer.data, answer.wkc), (vec![0], 1), "nothing to write to");
    let answer = bus.one(Command::Brw, physical_address(0, 0x1000), &[0x80]);
    assert_eq!((answer.data, answer.wkc), (vec![0x81], 3), "broadcasts have no offset");
    assert_eq!(bus.read(0, 0x1000, 1).data, [0x80]);
    bus.write(0, PHYSICAL_OFFSET, &[0, 0]);
    assert_eq!(bus.one(Command::Aprw, physical_address(0, 0x1001), &[9]).data, [2]);
    assert_eq!(bus.read(0, 0x1001, 1).data, [9]);
}
