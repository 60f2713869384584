//! A ring with two cards of the master, whole and broken, and how SOEM gets through it.

mod bus;

use bus::{Bus, FmmuEntry, INPUTS, OUTPUTS, PRIMARY, SECONDARY, SOURCE, STATION, answers, frame, port};
use esc::{End, Side};
use wire::EscAccess;
use wire::frame::{Command, Layout, physical_address};
use wire::register::*;

fn ring(count: usize) -> Bus {
    let mut bus = Bus::new(count);
    bus.plug(port(count - 1, 1), SECONDARY);
    bus
}

/// The end towards the primary card of cable `number` of a ring: 0 from the card to the first chip, `count` to the secondary card.
fn cable(number: usize) -> End {
    if number == 0 { PRIMARY } else { port(number - 1, 1) }
}

fn count_slaves(source: [u8; 6]) -> Vec<u8> {
    frame(source, &[(Command::Brd, physical_address(0, TYPE), &[0])])
}

fn circulates(frame: &[u8]) -> bool {
    let mut walk = Layout::of(frame).unwrap().walk();
    walk.next(frame).unwrap().is_circulating()
}

fn dl_status(bus: &mut Bus, position: usize) -> u16 {
    let now = wire::Nanos(bus.now);
    let chip = bus.chip(position);
    chip.advance(now);
    chip.read_u16(DL_STATUS) & 0xFFF0
}

#[test]
fn a_whole_ring_processes_what_the_primary_sends_and_forwards_what_the_secondary_sends() {
    for count in 1..=4 {
        let mut bus = ring(count);
        let mut primary = count_slaves(SOURCE);
        assert_eq!(bus.send_from(Side::Primary, &mut primary), Some(Side::Secondary));
        let answer = &answers(&primary)[0];
        assert_eq!((answer.wkc, answer.adp), (count as u16, count as u16));
        assert_eq!(primary[6], 0x12, "source address of a processed frame");
        assert!(!circulates(&primary));

        let sent = count_slaves(SOURCE);
        let mut secondary = sent.clone();
        assert_eq!(bus.send_from(Side::Secondary, &mut secondary), Some(Side::Primary));
        assert_eq!(secondary, sent, "no processing unit has seen it");
        for position in 0..count {
            assert_eq!(dl_status(&mut bus, position), 0x5A30, "chip {position} of {count}");
        }
    }
}

#[test]
fn a_whole_ring_answers_on_the_other_card_only() {
    let mut bus = ring(2);
    let mut sent = count_slaves(SOURCE);
    assert_eq!(
        bus.segment.process(&mut sent, wire::Nanos(5)),
        esc::Processed::Lost,
        "a master with one card hears nothing"
    );
}

#[test]
fn a_break_anywhere_leaves_two_lines_that_are_processed_from_both_ends() {
    for count in 1..=5 {
        for broken in 0..=count {
            let mut bus = ring(count);
            bus.unplug(cable(broken));
            let mut primary = count_slaves(SOURCE);
            let back = (broken > 0).then_some(Side::Primary);
            assert_eq!(bus.send_from(Side::Primary, &mut primary), back, "{broken} of {count}");
            assert_eq!((answers(&primary)[0].wkc, answers(&primary)[0].adp), (broken as u16, broken as u16));
            assert!(!circulates(&primary), "port 0 of the first has its link");

            let mut secondary = count_slaves(SOURCE);
            let back = (broken < count).then_some(Side::Secondary);
            assert_eq!(bus.send_from(Side::Secondary, &mut secondary), back, "{broken} of {count}");
            let beyond = (count - broken) as u16;
            assert_eq!((answers(&secondary)[0].wkc, answers(&secondary)[0].adp), (beyond, beyond));
            assert_eq!(
                circulates(&secondary),
                broken < count,
                "it passed one port 0 that had lost its link"
            );
        }
    }
}

#[test]
fn behind_a_break_positions_count_from_the_break_on() {
    let mut bus = ring(5);
    bus.unplug(cable(2));
    for step in 0..3u16 {
        let address = physical_address(0u16.wrapping_sub(step), STATION_ADDRESS);
        let mut sent = frame(SOURCE, &[(Command::Aprd, address, &[0; 2])]);
        assert_eq!(bus.send_from(Side::Secondary, &mut sent), Some(Side::Secondary));
        assert_eq!(answers(&sent)[0].data, (STATION + 2 + step).to_le_bytes());
    }
}

#[test]
fn both_neighbours_of_a_break_tell_of_it_and_of_its_repair() {
    let mut bus = ring(4);
    for (broken, neighbours) in [
        (0, [None, Some((0, 0))]),
        (2, [Some((1, 1)), Some((2, 0))]),
        (4, [Some((3, 1)), None]),
    ] {
        for position in 0..4 {
            let chip = bus.chip(position);
            chip.read_u16(DL_STATUS);
        }
        // What came before is acknowledged: every chip's DL status is read, by whichever card reaches it.
        for side in [Side::Primary, Side::Secondary] {
            let mut sent = frame(SOURCE, &[(Command::Brd, physical_address(0, DL_STATUS), &[0; 2])]);
            assert!(bus.send_from(side, &mut sent).is_some());
        }
        let end = cable(broken);
        let other = bus.segment.connected(end).unwrap();
        bus.unplug(end);
        for (position, port) in neighbours.into_iter().flatten() {
            let status = dl_status(&mut bus, position);
            assert_eq!(status >> (4 + port) & 1, 0, "no link at port {port} of chip {position}");
            assert_eq!(status >> (8 + 2 * port) & 3, 1, "loop closed, no signal");
            assert_eq!(bus.chip(position).read_u16(ECAT_EVENT_REQUEST) & 4, 4);
            let mut lost = [0; 4];
            bus.chip(position).read(LOST_LINK_COUNTERS, &mut lost);
            assert_eq!(lost[port], 1);
        }
        let untouched = (0..4).filter(|position| !neighbours.iter().flatten().any(|(near, _)| near == position));
        for position in untouched.collect::<Vec<_>>() {
            assert_eq!(dl_status(&mut bus, position), 0x5A30);
            assert_eq!(bus.chip(position).read_u16(ECAT_EVENT_REQUEST) & 4, 0);
        }
        bus.plug(end, other);
        for position in 0..4 {
            assert_eq!(dl_status(&mut bus, position), 0x5A30);
        }
        let mut sent = count_slaves(SOURCE);
        assert_eq!(bus.send_from(Side::Primary, &mut sent), Some(Side::Secondary));
    }
}

#[test]
fn a_frame_that_circulates_already_is_destroyed_where_the_link_to_the_master_is_lost() {
    let mut bus = ring(3);
    bus.unplug(cable(1));
    let mut sent = count_slaves(SOURCE);
    assert_eq!(bus.send_from(Side::Secondary, &mut sent), Some(Side::Secondary));
    let seen = sent.clone();
    assert_eq!(bus.send_from(Side::Secondary, &mut sent), None);
    assert_eq!(sent, seen, "destroyed before anybody processed it");
    // Where no link is lost, the bit means nothing.
    let mut sent = seen.clone();
    assert_eq!(bus.send_from(Side::Primary, &mut sent), Some(Side::Primary));
    assert_eq!(answers(&sent)[0].wkc, 3);
}

#[test]
fn a_port_closed_by_hand_makes_no_frame_circulate() {
    let mut bus = ring(2);
    let loop_control = frame(SOURCE, &[(Command::Fpwr, physical_address(STATION, DL_CONTROL + 1), &[0b11])]);
    assert_eq!(bus.send_from(Side::Primary, &mut loop_control.clone()), Some(Side::Secondary));
    for _ in 0..2 {
        let mut sent = count_slaves(SOURCE);
        assert_eq!(bus.send_from(Side::Secondary, &mut sent), Some(Side::Secondary));
        assert_eq!(answers(&sent)[0].wkc, 2);
        assert!(!circulates(&sent));
    }
    assert_eq!(bus.send_from(Side::Primary, &mut count_slaves(SOURCE)), None, "the loop is closed");
}

/// SOEM's cards: bytes 2 and 3 of the source address tell the frames apart (nicdrv.c).
const SOEM_PRIMARY: [u8; 6] = [0x01, 0x01, 0x01, 0x01, 0x01, 0x01];
const SOEM_SECONDARY: [u8; 6] = [0x04, 0x04, 0x04, 0x04, 0x04, 0x04];

fn route(received: &Option<Vec<u8>>) -> Option<[u8; 2]> {
    received.as_ref().map(|frame| [frame[8], frame[9]])
}

/// Sends as SOEM does with a redundant port: the frame on the primary card and a dummy on the secondary; then, if the ring is broken,
/// what came back on the secondary once more.
fn soem_exchange(bus: &mut Bus, datagrams: &[(Command, u32, &[u8])]) -> Vec<u8> {
    let mut received = [None, None];
    let sent = frame(SOEM_PRIMARY, datagrams);
    for (side, frame) in [(Side::Primary, sent.clone()), (Side::Secondary, count_slaves(SOEM_SECONDARY))] {
        let mut frame = frame;
        if let Some(exit) = bus.send_from(side, &mut frame) {
            assert_eq!(received[exit as usize].replace(frame), None);
        }
    }
    let [primary, secondary] = &received;
    match (route(primary), route(secondary)) {
        (Some([4, 4]), Some([1, 1])) => secondary.clone().unwrap(),
        (Some([1, 1]), None) => primary.clone().unwrap(),
        (first @ (Some([1, 1]) | None), Some([4, 4])) => {
            let mut again = if first.is_some() { primary.clone().unwrap() } else { sent };
            again[6..12].copy_from_slice(&SOEM_SECONDARY);
            assert_eq!(bus.send_from(Side::Secondary, &mut again), Some(Side::Secondary));
            again
        }
        routes => panic!("frames on unknown routes: {routes:?}"),
    }
}

#[test]
fn soem_reaches_every_drive_of_a_ring_broken_anywhere() {
    for count in 1..=5 {
        for broken in (0..=count).map(Some).chain([None]) {
            let mut bus = Bus::new(count);
            let mut image = vec![0; count];
            for position in 0..count as u16 {
                bus.sync_manager(position, 2, 0x1100, 1, OUTPUTS);
                bus.sync_manager(position, 3, 0x1200, 1, INPUTS);
                let logical = 0x1_0000 + u32::from(position);
                bus.fmmu(position, 0, FmmuEntry::whole(logical, 1, 0x1100, FmmuEntry::WRITE));
                bus.fmmu(position, 1, FmmuEntry::whole(logical, 1, 0x1200, FmmuEntry::READ));
                bus.chip(usize::from(position)).write(0x1200, &[0x50 + position as u8]);
                image[usize::from(position)] = position as u8;
            }
            bus.plug(port(count - 1, 1), SECONDARY);
            if let Some(broken) = broken {
                bus.unplug(cable(broken));
            }
            let back = soem_exchange(
                &mut bus,
                &[(Command::Brd, physical_address(0, TYPE), &[0]), (Command::Lrw, 0x1_0000, &image)],
            );
            let answer = answers(&back);
            assert_eq!(answer[0].wkc, count as u16, "{count} drives, {broken:?}");
            assert_eq!(answer[1].wkc, 3 * count as u16, "{count} drives, {broken:?}");
            let inputs: Vec<u8> = (0..count as u8).map(|position| 0x50 + position).collect();
            assert_eq!(answer[1].data, inputs);
            for position in 0..count as u16 {
                let mut output = [0xFF];
                bus.chip(usize::from(position)).read(0x1100, &mut output);
                assert_eq!(output, [position as u8]);
                let counted = physical_address(0u16.wrapping_sub(position), STATION_ADDRESS);
                let station = physical_address(STATION + position, STATION_ADDRESS);
                let back = soem_exchange(&mut bus, &[(Command::Aprd, counted, &[0; 2]), (Command::Fprd, station, &[0; 2])]);
                for answer in answers(&back) {
                    assert_eq!((answer.wkc, answer.data), (1, (STATION + position).to_le_bytes().to_vec()));
                }
            }
        }
    }
}
