//! Branches, drives that come and go, loop control.

mod bus;

use bus::{Bus, PRIMARY, SECONDARY, SOURCE, STATION, answers, chip, frame, junction, port};
use esc::{CannotConnect, End, Processed, Segment, Side};
use wire::frame::{Command, physical_address};
use wire::register::*;
use wire::{EscAccess, Nanos};

const AUTO: u8 = 0;
const AUTO_CLOSE: u8 = 1;
const OPEN: u8 = 2;
const CLOSED: u8 = 3;

fn count(bus: &mut Bus) -> u16 {
    bus.one(Command::Brd, physical_address(0, TYPE), &[0]).wkc
}

/// Station addresses in the order in which a frame is processed.
fn order(bus: &mut Bus) -> Vec<u16> {
    (0..count(bus))
        .map(|position| {
            let address = physical_address(0u16.wrapping_sub(position), STATION_ADDRESS);
            let answer = bus.one(Command::Aprd, address, &[0; 2]);
            assert_eq!(answer.wkc, 1);
            u16::from_le_bytes(answer.data.try_into().unwrap())
        })
        .collect()
}

/// A junction of four ports with two chips at each of ports 1, 2 and 3. Station addresses by place in the list.
fn cross() -> Bus {
    let mut bus = Bus::of((0..7).map(|at| junction(at, 4)).collect());
    bus.unplug(port(2, 1));
    bus.unplug(port(4, 1));
    bus.plug(port(0, 2), port(3, 0));
    bus.plug(port(0, 3), port(5, 0));
    bus
}

#[test]
fn branches_are_processed_in_the_order_of_ports_3_1_2() {
    let mut bus = cross();
    let stations: Vec<u16> = [0, 5, 6, 1, 2, 3, 4].map(|at| STATION + at).to_vec();
    assert_eq!(order(&mut bus), stations);
    assert_eq!(bus.read_u16(0, DL_STATUS), 0xAAF3, "four ports open");
    assert_eq!(bus.read_u16(5, DL_STATUS), 0x5A33);
    assert_eq!(bus.read_u16(6, DL_STATUS), 0x5613);
    assert_eq!(bus.read_u8(0, PORT_DESCRIPTOR), 0xFF);
}

#[test]
fn a_junction_of_three_ports_shows_them() {
    let mut bus = Bus::of(vec![chip(0, 0), junction(1, 3), chip(2, 0), chip(3, 0)]);
    bus.unplug(port(2, 1));
    bus.plug(port(1, 2), port(3, 0));
    assert_eq!(order(&mut bus), [0, 1, 2, 3].map(|at| STATION + at));
    assert_eq!(bus.read_u16(1, DL_STATUS), 0x6A73);
    assert_eq!(bus.read_u8(1, PORT_DESCRIPTOR), 0x3F);
    bus.chip(1).power_cycle();
    assert_eq!(bus.chip(1).read_u16(DL_STATUS), 0x6A73, "cables and ports stay");
    assert_eq!(count(&mut bus), 4);
}

#[test]
fn a_drive_entered_by_another_port_than_0_is_processed_when_port_0_has_no_link() {
    let mut bus = Bus::new(3);
    bus.unplug(port(2, 0));
    bus.plug(port(1, 1), port(2, 1));
    assert_eq!(count(&mut bus), 3, "plugged the wrong way round");
    let mut sent = frame(SOURCE, &[(Command::Brd, 0, &[0])]);
    assert_eq!(bus.send_from(Side::Primary, &mut sent), Some(Side::Primary));
    assert_eq!(sent[23] & 0x40, 0x40, "and marked as circulating there");
}

#[test]
fn a_drive_that_comes_is_like_new_and_one_that_goes_leaves_a_closed_loop() {
    let mut bus = Bus::new(2);
    bus.one(Command::Bwr, physical_address(0, ECAT_EVENT_MASK), &[4, 0]);
    bus.one(Command::Brd, physical_address(0, DL_STATUS), &[0; 2]);
    assert_eq!(bus.read(0, TYPE, 1).events, 0);
    bus.segment.drives_mut().push(chip(77, 0));
    assert_eq!(count(&mut bus), 2, "not plugged yet");
    bus.plug(port(1, 1), port(2, 0));
    assert_eq!(count(&mut bus), 3);
    assert_eq!(bus.read(0, TYPE, 1).events, 4, "the neighbour tells");
    let at = |ado| physical_address(0u16.wrapping_sub(2), ado);
    assert_eq!(bus.one(Command::Aprd, at(STATION_ADDRESS), &[0xFF; 2]).data, [0, 0]);
    assert_eq!(bus.one(Command::Aprd, at(AL_STATUS), &[0xFF; 2]).data, [1, 0]);
    assert_eq!(bus.read_u16(1, DL_STATUS), 0x5A33);
    assert_eq!(bus.read(0, TYPE, 1).events, 0);

    bus.one(Command::Apwr, at(STATION_ADDRESS), &[0x34, 0x12]);
    bus.unplug(port(2, 0));
    assert_eq!(count(&mut bus), 2);
    assert_eq!(bus.read_u16(1, DL_STATUS), 0x5613);
    assert_eq!(bus.read(1, LOST_LINK_COUNTERS, 4).data, [0, 1, 0, 0]);
    bus.chip(2).power_cycle();
    bus.plug(port(1, 1), port(2, 0));
    assert_eq!(
        bus.one(Command::Aprd, at(STATION_ADDRESS), &[0xFF; 2]).data,
        [0, 0],
        "switched off meanwhile"
    );
}

#[test]
fn a_drive_is_taken_out_of_the_midst_of_a_line() {
    let mut bus = Bus::new(3);
    bus.unplug(port(1, 0));
    assert_eq!(order(&mut bus), [STATION]);
    bus.unplug(port(1, 1));
    bus.plug(port(0, 1), port(2, 0));
    assert_eq!(order(&mut bus), [STATION, STATION + 2]);
}

#[test]
fn without_the_masters_cable_nothing_comes_back() {
    let mut bus = Bus::new(2);
    bus.unplug(PRIMARY);
    let mut sent = frame(SOURCE, &[(Command::Brd, 0, &[0])]);
    let before = sent.clone();
    assert_eq!(bus.segment.process(&mut sent, Nanos(1)), Processed::Lost);
    assert_eq!(sent, before);
    assert_eq!(bus.chip(0).read_u16(DL_STATUS) & 0x0330, 0x0120);
    bus.plug(port(0, 0), PRIMARY);
    assert_eq!(order(&mut bus), [STATION, STATION + 1], "the drives have lost nothing");
}

#[test]
fn cables_that_cannot_be_are_refused() {
    let mut bus = Bus::new(2);
    let segment = &mut bus.segment;
    let absent = |end| Err(CannotConnect::NoSuchPort(end));
    assert_eq!(segment.connect(port(1, 1), port(2, 0)), absent(port(2, 0)));
    assert_eq!(segment.connect(port(1, 2), SECONDARY), absent(port(1, 2)), "two ports only");
    assert_eq!(segment.connect(port(1, 9), SECONDARY), absent(port(1, 9)));
    assert_eq!(segment.connect(port(0, 1), SECONDARY), Err(CannotConnect::Occupied(port(0, 1))));
    assert_eq!(segment.connect(SECONDARY, port(0, 1)), Err(CannotConnect::Occupied(port(0, 1))));
    assert_eq!(segment.connect(port(1, 1), port(1, 1)), Err(CannotConnect::SameEnd));
    assert_eq!(segment.disconnect(port(1, 1)), None);
    assert_eq!(segment.connected(PRIMARY), Some(port(0, 0)));
    assert_eq!(count(&mut bus), 2);
}

#[test]
fn a_chip_put_in_anothers_place_comes_without_cables() {
    let mut bus = Bus::new(3);
    bus.segment.drives_mut()[1] = chip(0, 0);
    let mut sent = frame(SOURCE, &[(Command::Brd, 0, &[0])]);
    assert_eq!(bus.segment.process(&mut sent, Nanos(1)), Processed::Lost);
    assert_eq!(bus.segment.disconnect(port(0, 1)), Some(port(1, 0)));
    assert_eq!(count(&mut bus), 1);
    assert_eq!(bus.segment.disconnect(port(2, 0)), Some(port(1, 1)));
    bus.plug(port(0, 1), port(1, 0));
    bus.plug(port(1, 1), port(2, 0));
    assert_eq!(count(&mut bus), 3);
    bus.segment.drives_mut().truncate(1);
    assert_eq!(bus.segment.process(&mut sent, Nanos(1)), Processed::Lost);
}

fn control(bus: &mut Bus, position: u16, port: u8, mode: u8) {
    assert_eq!(bus.write(position, DL_CONTROL + 1, &[mode << (2 * port)]), 1);
}

#[test]
fn a_port_closed_by_the_master_ends_the_line_there_and_reports_its_link() {
    let mut bus = Bus::new(3);
    control(&mut bus, 0, 1, CLOSED);
    assert_eq!(count(&mut bus), 1);
    assert_eq!(bus.read_u16(0, DL_STATUS), 0x5E33, "link and signal, loop closed");
    assert_eq!(bus.read(0, LOST_LINK_COUNTERS, 4).data, [0; 4]);
    control(&mut bus, 0, 1, AUTO);
    assert_eq!(count(&mut bus), 3);
    assert_eq!(bus.read_u16(0, DL_STATUS), 0x5A33);
}

#[test]
fn loop_control_acts_behind_the_frame_that_brings_it() {
    let mut bus = Bus::new(3);
    let answer = bus.one(Command::Bwr, physical_address(0, DL_CONTROL + 1), &[CLOSED << 2]);
    assert_eq!(answer.wkc, 3, "it went all the way and came back");
    assert_eq!(count(&mut bus), 1);
    // Each broadcast opens one more.
    assert_eq!(bus.one(Command::Bwr, physical_address(0, DL_CONTROL + 1), &[AUTO]).wkc, 1);
    assert_eq!(bus.one(Command::Bwr, physical_address(0, DL_CONTROL + 1), &[AUTO]).wkc, 2);
    assert_eq!(count(&mut bus), 3);
}

#[test]
fn an_auto_close_port_stays_closed_until_it_is_written_again() {
    let mut bus = Bus::new(2);
    control(&mut bus, 0, 1, AUTO_CLOSE);
    assert_eq!(count(&mut bus), 2, "open while there is a link");
    bus.unplug(port(0, 1));
    assert_eq!(count(&mut bus), 1);
    bus.plug(port(0, 1), port(1, 0));
    assert_eq!(count(&mut bus), 1);
    assert_eq!(bus.read_u16(0, DL_STATUS), 0x5E33);
    bus.pass(10_000_000_000);
    assert_eq!(count(&mut bus), 1);
    control(&mut bus, 0, 1, AUTO_CLOSE);
    assert_eq!(count(&mut bus), 2);
}

#[test]
fn an_auto_close_port_opens_for_a_frame_that_comes_in_there() {
    let mut bus = Bus::new(2);
    control(&mut bus, 0, 1, AUTO_CLOSE);
    bus.plug(port(1, 1), SECONDARY);
    bus.unplug(port(0, 1));
    bus.plug(port(0, 1), port(1, 0));
    let sent = frame(SOURCE, &[(Command::Brd, 0, &[0])]);
    assert_eq!(bus.send_from(Side::Primary, &mut sent.clone()), Some(Side::Primary), "still closed");
    assert_eq!(
        bus.send_from(Side::Secondary, &mut sent.clone()),
        None,
        "the frame that opens it is lost"
    );
    assert_eq!(bus.send_from(Side::Primary, &mut sent.clone()), Some(Side::Secondary));
    assert_eq!(bus.send_from(Side::Secondary, &mut sent.clone()), Some(Side::Primary));
}

#[test]
fn a_port_opened_by_hand_loses_frames_when_its_link_is_lost() {
    let mut bus = Bus::new(2);
    control(&mut bus, 0, 1, OPEN);
    bus.unplug(port(0, 1));
    let mut sent = frame(SOURCE, &[(Command::Brd, 0, &[0])]);
    assert_eq!(bus.segment.process(&mut sent, Nanos(bus.now)), Processed::Lost);
    assert_eq!(answers(&sent)[0].wkc, 1);
    assert_eq!(bus.chip(0).read_u16(DL_STATUS), 0x5213, "loop open, no link");
    bus.plug(port(0, 1), port(1, 0));
    assert_eq!(count(&mut bus), 2);
}

#[test]
fn when_every_port_is_closed_port_0_stands_in() {
    let mut bus = Bus::new(2);
    assert_eq!(bus.write(0, DL_CONTROL + 1, &[0xFF]), 1);
    assert_eq!(count(&mut bus), 1);
    assert_eq!(bus.read_u16(0, DL_STATUS), 0x5F33, "all loops closed");
    assert_eq!(bus.write(0, DL_CONTROL + 1, &[0]), 1);
    assert_eq!(count(&mut bus), 2);
}

#[test]
fn a_temporary_loop_control_is_taken_back_after_a_second() {
    let mut bus = Bus::new(2);
    bus.read(0, DL_STATUS, 2);
    bus.write(0, ECAT_EVENT_MASK, &[4, 0]);
    assert_eq!(bus.write(0, DL_CONTROL, &[0b11, CLOSED << 2]), 1);
    assert_eq!(count(&mut bus), 1);
    bus.pass(900_000_000);
    assert_eq!(bus.write(0, DL_CONTROL, &[0b11, CLOSED << 2]), 1, "the second begins anew");
    bus.pass(999_000_000);
    assert_eq!(count(&mut bus), 1);
    bus.read(0, DL_STATUS, 2);
    bus.now += 2_000_000;
    assert_eq!(count(&mut bus), 2);
    assert_eq!(bus.read(0, DL_CONTROL, 4).data, [1, 0, 7, 0]);
    assert_eq!(bus.read(0, TYPE, 1).events, 4);

    assert_eq!(bus.write(0, DL_CONTROL, &[0b11, CLOSED << 2]), 1);
    assert_eq!(bus.write(0, DL_CONTROL, &[0b01, CLOSED << 2]), 1, "permanent after all");
    bus.pass(2_000_000_000);
    assert_eq!(count(&mut bus), 1);
}

#[test]
fn a_link_lost_on_one_side_only_loses_frames_until_the_other_notices() {
    let mut bus = Bus::new(2);
    bus.chip(1).set_link(0, false);
    let mut sent = frame(SOURCE, &[(Command::Brd, 0, &[0])]);
    assert_eq!(bus.segment.process(&mut sent, Nanos(bus.now)), Processed::Lost);
    bus.chip(0).set_link(1, false);
    assert_eq!(count(&mut bus), 1);
}

#[test]
fn a_cable_from_card_to_card_is_a_ring_without_drives() {
    let mut segment = Segment::new(vec![chip(0, 0)]);
    segment.disconnect(PRIMARY);
    assert_eq!(segment.connect(PRIMARY, SECONDARY), Ok(()));
    let mut sent = frame(SOURCE, &[(Command::Brd, 0, &[0])]);
    for (from, to) in [(Side::Primary, Side::Secondary), (Side::Secondary, Side::Primary)] {
        let before = sent.clone();
        assert_eq!(segment.process_from(from, &mut sent, Nanos(0)), (Processed::Returned, Some(to)));
        assert_eq!(sent, before);
    }
    assert_eq!(segment.connected(port(0, 0)), None::<End>);
}

#[test]
fn link_and_activity_of_a_port_are_those_of_its_cable() {
    const FLICKER: u64 = 100_000_000;
    let mut bus = Bus::new(3);
    let ports = |bus: &mut Bus, position| {
        let now = Nanos(bus.now);
        let chip = bus.chip(position);
        [0, 1, 2, 9].map(|port| (chip.has_link(port), chip.is_active(port, now)))
    };
    let (active, quiet, none) = ((true, true), (true, false), (false, false));
    assert_eq!(ports(&mut bus, 0), [active, active, none, none]);
    assert_eq!(ports(&mut bus, 2), [active, none, none, none], "the end of the line");
    bus.pass(FLICKER - 1);
    assert_eq!(ports(&mut bus, 0), [active, active, none, none]);
    bus.pass(1);
    assert_eq!(ports(&mut bus, 0), [quiet, quiet, none, none], "no frame for 100 ms");

    bus.unplug(port(1, 1));
    bus.read_u8(0, TYPE);
    assert_eq!(ports(&mut bus, 1), [active, none, none, none]);
    assert_eq!(ports(&mut bus, 2), [none; 4]);
    assert_eq!(bus.write(0, DL_CONTROL + 1, &[CLOSED << 2]), 1);
    bus.read_u8(0, TYPE);
    assert_eq!(ports(&mut bus, 0), [active, quiet, none, none], "nothing passes a closed loop");

    bus.plug(port(2, 1), SECONDARY);
    let mut backwards = frame(SOURCE, &[(Command::Brd, physical_address(0, TYPE), &[0])]);
    bus.send_from(Side::Secondary, &mut backwards);
    assert_eq!(ports(&mut bus, 2), [none, active, none, none], "from the other side");
}
