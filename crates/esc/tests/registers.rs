//! Registers: shadowed writes, access rights, AL control, counters, events.

mod bus;

use bus::{Bus, STATION};
use wire::frame::{Command, physical_address};
use wire::register::*;
use wire::{AlEvents, EscAccess, Nanos};

fn at(ado: u16) -> u32 {
    physical_address(STATION, ado)
}

#[test]
fn information_block_is_an_et1100s() {
    let mut bus = Bus::new(1);
    assert_eq!(bus.read(0, TYPE, 10).data, [0x11, 0, 3, 0, 8, 8, 8, 0x0F, 0xFC, 0]);
}

#[test]
fn reads_in_the_frame_of_a_write_see_the_old_value() {
    let mut bus = Bus::new(1);
    let answers = bus.send(&[
        (Command::Fpwr, at(ECAT_EVENT_MASK), &[4, 0]),
        (Command::Fprd, at(ECAT_EVENT_MASK), &[0; 2]),
        (Command::Fpwr, at(USER_RAM), &[9]),
        (Command::Fprd, at(USER_RAM), &[0]),
        (Command::Fprw, at(ECAT_EVENT_MASK), &[8, 0]),
    ]);
    assert_eq!(answers[1].data, [0, 0], "registers wait for the end of the frame");
    assert_eq!(answers[3].data, [9], "memory does not");
    assert_eq!((&answers[4].data[..], answers[4].wkc), (&[0, 0][..], 3));
    assert_eq!(bus.read(0, ECAT_EVENT_MASK, 2).data, [8, 0], "the last write counts");
}

#[test]
fn a_new_station_address_counts_from_the_next_frame_on() {
    let mut bus = Bus::new(1);
    let answers = bus.send(&[
        (Command::Apwr, physical_address(0, STATION_ADDRESS), &[0x34, 0x12]),
        (Command::Fprd, at(TYPE), &[0]),
        (Command::Fprd, physical_address(0x1234, TYPE), &[0]),
    ]);
    assert_eq!(answers.map_wkc(), [1, 1, 0]);
    assert_eq!(bus.one(Command::Fprd, physical_address(0x1234, TYPE), &[0]).wkc, 1);
}

trait MapWkc {
    fn map_wkc(&self) -> Vec<u16>;
}

impl MapWkc for Vec<bus::Answer> {
    fn map_wkc(&self) -> Vec<u16> {
        self.iter().map(|answer| answer.wkc).collect()
    }
}

#[test]
fn al_control_is_locked_until_the_slave_has_read_it() {
    let mut bus = Bus::new(1);
    bus.catch_up();
    assert!(!bus.chip(0).events().has(AlEvents::AL_CONTROL));
    assert_eq!(bus.write(0, AL_CONTROL, &[0x11, 0]), 1);
    assert_eq!(bus.write(0, AL_CONTROL, &[0x02, 0]), 0);
    assert_eq!(bus.one(Command::Fprw, at(AL_CONTROL), &[4, 0]).wkc, 1, "reading goes on");
    assert_eq!(bus.read(0, AL_CONTROL, 2).data, [0x11, 0], "a refused write changes nothing");
    bus.catch_up();
    assert!(bus.chip(0).events().has(AlEvents::AL_CONTROL));
    assert_eq!(bus.chip(0).read_u16(AL_CONTROL), 0x11);
    assert!(!bus.chip(0).events().has(AlEvents::AL_CONTROL));
    assert_eq!(bus.write(0, AL_CONTROL, &[0x02, 0]), 1);
}

#[test]
fn events_of_a_frame_wait_for_the_slaves_time_at_every_position_of_the_line() {
    let mut bus = Bus::new(3);
    bus.now = 5_000_000;
    let t = bus.now;
    assert_eq!(bus.one(Command::Bwr, physical_address(0, AL_CONTROL), &[0x11, 0]).wkc, 3);
    for position in 0..3 {
        let chip = bus.chip(position);
        chip.advance(Nanos(t - 1));
        assert!(!chip.events().has(AlEvents::AL_CONTROL));
        chip.advance(Nanos(t));
        assert!(chip.events().has(AlEvents::AL_CONTROL));
    }
}

#[test]
fn al_status_changes_raise_an_ecat_event_until_the_bus_reads_it() {
    let mut bus = Bus::new(2);
    bus.one(Command::Brd, physical_address(0, DL_STATUS), &[0; 2]);
    bus.one(Command::Bwr, physical_address(0, ECAT_EVENT_MASK), &[0x08, 0]);
    assert_eq!(bus.read(0, TYPE, 1).events, 0);
    bus.chip(1).write_u16(AL_STATUS, 1);
    assert_eq!(bus.read(0, TYPE, 1).events, 0, "written, but not changed");
    bus.chip(1).write_u16(AL_STATUS, 2);
    assert_eq!(bus.read(0, TYPE, 1).events, 8, "reported by every datagram that passes");
    let answer = bus.read(1, AL_STATUS, 6);
    assert_eq!((answer.data[0], answer.events), (2, 8));
    assert_eq!(bus.read(0, TYPE, 1).events, 0);
    assert_eq!(bus.read_u16(1, ECAT_EVENT_REQUEST) & 8, 0);
}

#[test]
fn only_masked_events_are_reported() {
    let mut bus = Bus::new(1);
    assert_eq!(bus.read_u16(0, ECAT_EVENT_REQUEST) & 4, 4, "the links came up");
    assert_eq!(bus.read(0, TYPE, 1).events, 0);
    bus.write(0, ECAT_EVENT_MASK, &[4, 0]);
    assert_eq!(bus.read(0, TYPE, 1).events, 4);
    bus.read(0, DL_STATUS, 2);
    assert_eq!(bus.read(0, TYPE, 1).events, 0);
}

#[test]
fn dl_status_tells_where_in_the_line_a_chip_is() {
    let mut bus = Bus::new(3);
    assert_eq!(
        [0, 1, 2].map(|position| bus.read_u16(position, DL_STATUS)),
        [0x5A33, 0x5A33, 0x5613]
    );
    let mut bus = Bus::new(1);
    assert_eq!(bus.read_u16(0, DL_STATUS), 0x5613);
    bus.chip(0).set_link(1, true);
    assert_eq!(bus.chip(0).read_u16(DL_STATUS), 0x5A33);
    bus.chip(0).set_link(1, false);
    bus.chip(0).set_link(3, true);
    assert_eq!(bus.read_u16(0, DL_STATUS), 0x5613);
    assert_eq!(bus.read(0, LOST_LINK_COUNTERS, 4).data, [0, 1, 0, 0]);
}

#[test]
fn rights_of_the_slave_are_not_those_of_the_bus() {
    let mut bus = Bus::new(1);
    let chip = bus.chip(0);
    chip.write(STATION_ADDRESS, &[9, 9]);
    chip.write(AL_CONTROL, &[9, 9]);
    chip.write(AL_STATUS, &[2, 0, 0xEE, 0xEE, 0x1B, 0]);
    assert_eq!(chip.read_u16(STATION_ADDRESS), STATION);
    assert_eq!(chip.read_u16(AL_CONTROL), 1);
    assert_eq!(bus.read(0, AL_STATUS, 6).data, [2, 0, 0, 0, 0x1B, 0]);
    assert_eq!(bus.write(0, AL_STATUS, &[8, 0, 0, 0, 0, 0]), 0);
    assert_eq!(bus.write(0, RUN_LED, &[0x11]), 1);
    bus.chip(0).write_u8(ERR_LED, 0x12);
    assert_eq!(bus.read(0, RUN_LED, 2).data, [0x11, 0x12]);
}

#[test]
fn broken_frames_count_and_write_nothing_to_registers() {
    let mut bus = Bus::new(2);
    let broken = |bus: &mut Bus| {
        let mut frame = [0; 100];
        let mut builder = wire::frame::FrameBuilder::new(&mut frame, bus::SOURCE).unwrap();
        builder.datagram(Command::Fpwr, 0, at(ECAT_EVENT_MASK), &[1, 0]).unwrap();
        builder.datagram(Command::Fpwr, 0, at(PROCESS_RAM), &[1]).unwrap();
        let length = builder.finish() - 1;
        assert_eq!(bus.segment.process(&mut frame[..length], Nanos(0)), esc::Processed::Malformed);
        (frame[28], frame[6])
    };
    assert_eq!(broken(&mut bus), (1, 0x12), "what was whole before the break has been processed");
    assert_eq!(bus.read(0, ECAT_EVENT_MASK, 2).data, [0, 0]);
    assert_eq!(bus.read_u8(0, PROCESSING_ERROR_COUNTER), 1);
    assert_eq!(bus.read_u8(1, PROCESSING_ERROR_COUNTER), 1);
    for _ in 0..300 {
        broken(&mut bus);
    }
    assert_eq!(bus.read_u8(0, PROCESSING_ERROR_COUNTER), 0xFF, "counters stop at their end");
    bus.chip(0).set_link(1, false);
    assert_eq!(bus.write(0, RX_ERROR_COUNTERS, &[0; 8]), 1);
    assert_eq!(bus.read_u8(0, PROCESSING_ERROR_COUNTER), 0xFF, "another group");
    assert_eq!(bus.read_u8(0, LOST_LINK_COUNTERS + 1), 1);
    assert_eq!(bus.write(0, LOST_LINK_COUNTERS + 3, &[7]), 1);
    assert_eq!(bus.read_u8(0, LOST_LINK_COUNTERS + 1), 0);
    assert_eq!(bus.write(0, PROCESSING_ERROR_COUNTER, &[7]), 1);
    assert_eq!(bus.read_u8(0, PROCESSING_ERROR_COUNTER), 0);
}

#[test]
fn power_cycle_forgets_everything_but_the_eeprom_and_the_cables() {
    let mut bus = Bus::new(2);
    bus.write(0, PROCESS_RAM, &[5]);
    bus.write(0, AL_CONTROL, &[2, 0]);
    bus.chip(0).power_cycle();
    assert_eq!(bus.one(Command::Fprd, at(TYPE), &[0]).wkc, 0);
    let answer = bus.one(Command::Aprd, physical_address(0, PROCESS_RAM), &[0]);
    assert_eq!(answer.data, [0]);
    assert_eq!(
        bus.one(Command::Apwr, physical_address(0, AL_CONTROL), &[1, 0]).wkc,
        1,
        "not locked"
    );
    assert_eq!(bus.one(Command::Aprd, physical_address(0, STATION_ALIAS), &[0]).data, [0xAA]);
    assert_eq!(bus.one(Command::Aprd, physical_address(0, DL_STATUS), &[0; 2]).data, [0x33, 0x5A]);
}

#[test]
fn pdi_watchdog_shows_in_dl_status_and_counts() {
    let mut bus = Bus::new(1);
    bus.catch_up();
    bus.chip(0).events();
    bus.pass(99_000_000);
    assert_eq!(bus.read_u16(0, DL_STATUS), 0x5613);
    bus.pass(2_000_000);
    assert_eq!(bus.read_u16(0, DL_STATUS), 0x5611);
    assert_eq!(bus.read_u8(0, PDI_WATCHDOG_COUNTER), 1);
    bus.chip(0).events();
    assert_eq!(bus.read_u16(0, DL_STATUS), 0x5613);
    assert_eq!(bus.write(0, PROCESS_WATCHDOG_COUNTER, &[0]), 1);
    assert_eq!(bus.read_u8(0, PDI_WATCHDOG_COUNTER), 0);
}
