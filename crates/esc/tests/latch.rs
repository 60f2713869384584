//! The latch units: edges of their inputs in system time.

mod bus;

use bus::Bus;
use wire::register::*;
use wire::{AlEvents, EscAccess, Nanos};

/// What the clock of [`Bus::new`]'s first chip shows at time 0.
const START: u64 = 1_000_000;
const OF_SLAVE: u8 = 1 << 4;

fn edge(bus: &mut Bus, unit: usize, level: bool, at: u64) {
    bus.chip(0).latch(unit, level, Nanos(at));
}

fn time(bus: &mut Bus, index: u16) -> u64 {
    bus.read_u64(0, DC_LATCH_TIMES + 8 * index)
}

fn status(bus: &mut Bus, unit: u16) -> u8 {
    bus.read_u8(0, DC_LATCH_STATUS + unit)
}

fn reported(bus: &mut Bus) -> bool {
    bus.read_u16(0, ECAT_EVENT_REQUEST) & 1 != 0
}

#[test]
fn continuous_edges_overwrite_each_other_in_system_time() {
    let mut bus = Bus::new(1);
    bus.write(0, DC_SYSTEM_TIME_OFFSET, &5_000_000_000_u64.to_le_bytes());
    for at in [2_000_000, 3_000_000] {
        edge(&mut bus, 0, true, at);
        edge(&mut bus, 0, true, at + 50);
        edge(&mut bus, 0, false, at + 100);
        edge(&mut bus, 1, true, at + 7);
        edge(&mut bus, 1, false, at + 8);
        let base = START + 5_000_000_000 + at;
        let times = [0, 1, 2, 3].map(|index| time(&mut bus, index));
        assert_eq!(times, [base, base + 100, base + 7, base + 8]);
    }
    assert_eq!((status(&mut bus, 0), status(&mut bus, 1)), (0, 0));
    assert!(!reported(&mut bus));
    edge(&mut bus, 1, true, 4_000_000);
    assert_eq!((status(&mut bus, 0), status(&mut bus, 1)), (0, dc_latch::LEVEL));
}

#[test]
fn a_single_edge_is_kept_until_the_bus_reads_its_time() {
    let mut bus = Bus::new(1);
    assert_eq!(bus.write(0, DC_LATCH_CONTROL, &[dc_latch::POSITIVE]), 1);
    bus.write(0, ECAT_EVENT_MASK, &[1, 0]);
    edge(&mut bus, 0, true, 2_000_000);
    edge(&mut bus, 0, false, 2_000_100);
    edge(&mut bus, 0, true, 2_000_200);
    assert_eq!(status(&mut bus, 0), dc_latch::POSITIVE | dc_latch::LEVEL);
    assert!(reported(&mut bus));
    assert_eq!(bus.read(0, TYPE, 1).events, 1, "reported by every datagram");
    assert_eq!(
        time(&mut bus, 1),
        START + 2_000_100,
        "the other edge is continuous, and reading it acknowledges nothing"
    );
    assert!(reported(&mut bus));
    assert_eq!(time(&mut bus, 0), START + 2_000_000, "the first");
    assert!(!reported(&mut bus));
    assert_eq!(status(&mut bus, 0), dc_latch::LEVEL);
    edge(&mut bus, 0, false, 2_000_300);
    edge(&mut bus, 0, true, 2_000_400);
    assert_eq!(time(&mut bus, 0), START + 2_000_400, "armed again");
}

#[test]
fn both_edges_of_both_units_are_kept_apart() {
    let mut bus = Bus::new(1);
    assert_eq!(bus.write(0, DC_LATCH_CONTROL, &[3, 3]), 1);
    for round in 0..2u64 {
        for unit in 0..2 {
            edge(&mut bus, unit, true, 10_000 * round + 10 * unit as u64 + 1);
            edge(&mut bus, unit, false, 10_000 * round + 10 * unit as u64 + 2);
        }
    }
    assert_eq!([status(&mut bus, 0), status(&mut bus, 1)], [3, 3]);
    let all = bus.read(0, DC_LATCH_TIMES, 32).data;
    let times: Vec<u64> = all
        .chunks(8)
        .map(|bytes| u64::from_le_bytes(bytes.try_into().unwrap()) - START)
        .collect();
    assert_eq!(times, [1, 2, 11, 12]);
    assert_eq!([status(&mut bus, 0), status(&mut bus, 1)], [0, 0]);
}

#[test]
fn a_broken_frame_acknowledges_nothing() {
    let mut bus = Bus::new(1);
    bus.write(0, DC_LATCH_CONTROL, &[1]);
    edge(&mut bus, 0, true, 5);
    let at = wire::frame::physical_address(bus::STATION, DC_LATCH_TIMES);
    let mut sent = bus::frame(bus::SOURCE, &[(wire::frame::Command::Fprd, at, &[0; 8])]);
    sent[14] += 1;
    assert_eq!(bus.segment.process(&mut sent, Nanos(bus.now)), esc::Processed::Malformed);
    assert!(reported(&mut bus));
}

#[test]
fn a_unit_of_the_slave_reports_to_the_slave() {
    let mut bus = Bus::new(1);
    bus.write(0, DC_CYCLIC_CONTROL, &[OF_SLAVE]);
    assert_eq!(bus.write(0, DC_LATCH_CONTROL, &[3]), 0, "not the bus's");
    assert_eq!(bus.write(0, DC_LATCH_CONTROL + 1, &[1]), 1, "this one is");
    bus.chip(0).write(DC_LATCH_CONTROL, &[dc_latch::NEGATIVE, 3]);
    assert_eq!(bus.read(0, DC_LATCH_CONTROL, 2).data, [2, 1]);
    edge(&mut bus, 0, true, 1_500_000);
    edge(&mut bus, 0, false, 1_600_000);
    bus.now = 1_600_000;
    bus.catch_up();
    assert!(bus.chip(0).events().has(AlEvents::DC_LATCH));
    assert!(!reported(&mut bus));
    time(&mut bus, 1);
    assert_eq!(status(&mut bus, 0), dc_latch::NEGATIVE, "the bus's reading is no acknowledge");
    let mut read = [0; 8];
    bus.chip(0).read(DC_LATCH_TIMES + 8, &mut read);
    assert_eq!(u64::from_le_bytes(read), START + 1_600_000);
    assert!(!bus.chip(0).events().has(AlEvents::DC_LATCH));
    assert_eq!(status(&mut bus, 0), 0);
}

#[test]
fn switching_to_continuous_takes_back_what_was_reported() {
    let mut bus = Bus::new(1);
    bus.write(0, DC_LATCH_CONTROL, &[3]);
    edge(&mut bus, 0, true, 5);
    assert!(reported(&mut bus));
    bus.write(0, DC_LATCH_CONTROL, &[0]);
    assert!(!reported(&mut bus));
    assert_eq!(status(&mut bus, 0), dc_latch::LEVEL);
    bus.chip(0).latch(2, true, Nanos(9));
    assert_eq!(bus.write(0, DC_LATCH_STATUS, &[0; 34]), 0, "read only");
}
