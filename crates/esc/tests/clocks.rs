//! Distributed clocks as masters use them.

mod bus;

use bus::{Bus, STATION, chip};
use wire::frame::{Command, physical_address};
use wire::register::*;
use wire::{AlEvents, EscAccess, Nanos};

const HOP: u64 = esc::segment::PROCESSING_DELAY_NS + esc::segment::WIRE_DELAY_NS;

fn broadcast(bus: &mut Bus, ado: u16, data: &[u8]) -> u16 {
    bus.one(Command::Bwr, physical_address(0, ado), data).wkc
}

/// Receive times of ports 0 and 1.
fn receive_times(bus: &mut Bus, position: u16) -> [u32; 2] {
    [0, 4].map(|port| bus.read_u32(position, DC_RECEIVE_TIMES + port))
}

/// What SOEM's configdc does: latch, offsets to `host`, delays from round trips; the delays.
fn configure(bus: &mut Bus, count: u16, host: u64) -> Vec<u32> {
    broadcast(bus, DC_ACTIVATION, &[0]);
    broadcast(bus, DC_SYSTEM_TIME, &[0; 4]);
    broadcast(bus, DC_SPEED_START, &[0x00, 0x10]);
    broadcast(bus, DC_FILTER_DEPTH, &[0x00, 0x0C]);
    assert_eq!(broadcast(bus, DC_RECEIVE_TIMES, &[0; 4]), count);
    let trips: Vec<u32> = (0..count)
        .map(|position| match (receive_times(bus, position), position + 1 == count) {
            (_, true) => 0,
            ([first, second], false) => second.wrapping_sub(first),
        })
        .collect();
    let mut delays = vec![0];
    for position in 0..count {
        let own = bus.read_u64(position, DC_PROCESSING_TIME);
        assert_eq!(bus.write(position, DC_SYSTEM_TIME_OFFSET, &host.wrapping_sub(own).to_le_bytes()), 1);
        if position > 0 {
            let at = usize::from(position);
            let delay = (trips[at - 1] - trips[at]) / 2 + delays[at - 1];
            assert_eq!(bus.write(position, DC_SYSTEM_TIME_DELAY, &delay.to_le_bytes()), 1);
            delays.push(delay);
        }
    }
    delays
}

/// One frame that hands the reference clock's time to those behind it; the time.
fn distribute(bus: &mut Bus) -> u64 {
    let answer = bus.one(Command::Frmw, physical_address(STATION, DC_SYSTEM_TIME), &[0; 8]);
    u64::from_le_bytes(answer.data.try_into().unwrap())
}

#[test]
fn receive_times_follow_from_the_line_and_change_with_every_latch() {
    let mut bus = Bus::new(3);
    bus.now = 10_000_000;
    assert_eq!(broadcast(&mut bus, DC_RECEIVE_TIMES, &[0]), 3);
    let expected = |now: u64, position: u64| {
        let own = 1_000_000 * (position + 1) + now + position * HOP;
        (own, own + 2 * (2 - position) * HOP)
    };
    for position in 0..2 {
        let (first, second) = expected(10_000_000, u64::from(position));
        assert_eq!(receive_times(&mut bus, position), [first as u32, second as u32]);
        assert_eq!(bus.read_u64(position, DC_PROCESSING_TIME), first);
    }
    assert_eq!(
        receive_times(&mut bus, 2),
        [expected(10_000_000, 2).0 as u32, 0],
        "no cable, no time"
    );
    bus.now += 5_000;
    broadcast(&mut bus, DC_RECEIVE_TIMES, &[0; 16]);
    assert_eq!(receive_times(&mut bus, 0)[0], expected(10_005_000, 0).0 as u32);
    assert_eq!(bus.write(0, DC_RECEIVE_TIMES + 1, &[0; 3]), 0, "only the first byte latches");
}

#[test]
fn delays_measured_the_soem_way_are_those_of_the_line() {
    let mut bus = Bus::new(3);
    assert_eq!(configure(&mut bus, 3, 0), [0, HOP as u32, 2 * HOP as u32]);
}

#[test]
fn system_time_is_that_of_the_frames_start_everywhere() {
    let mut bus = Bus::new(2);
    let host = 800_000_000_000_000_000;
    let configured = bus.now;
    configure(&mut bus, 2, host);
    bus.now += 1_000_000;
    let expected = host + bus.now - configured;
    assert_eq!(distribute(&mut bus), expected);
    assert_eq!(bus.read_u64(0, DC_SYSTEM_TIME), expected);
    let time = bus.read_u64(1, DC_SYSTEM_TIME);
    assert_eq!(
        time,
        expected - HOP,
        "host time was put where the frame passed, so the delay shows until the loop has worked it off"
    );
    let at = |ado| physical_address(STATION, ado);
    let answers = bus.send(&[
        (Command::Fpwr, at(PROCESS_RAM), &[0; 1000]),
        (Command::Fprd, at(DC_SYSTEM_TIME), &[0; 8]),
    ]);
    assert_eq!(answers[1].data, expected.to_le_bytes());
    bus.catch_up();
    let mut bytes = [0; 8];
    bus.chip(1).read(DC_SYSTEM_TIME, &mut bytes);
    assert_eq!(
        u64::from_le_bytes(bytes),
        expected - HOP,
        "the slave's view: without delay, at its own time"
    );
}

#[test]
fn slaves_follow_the_reference_clock_and_its_drift() {
    for cycle in [250_000, 1_000_000] {
        let mut bus = Bus::of(vec![chip(5_000_000, 20_000), chip(7_000_000_000, -35_000), chip(3, 60_000)]);
        configure(&mut bus, 3, 0);
        for _ in 0..8_000 {
            bus.pass(cycle);
            distribute(&mut bus);
        }
        for _ in 0..200 {
            bus.pass(cycle);
            let reference = distribute(&mut bus);
            for position in 1..3 {
                let time = bus.read_u64(position, DC_SYSTEM_TIME);
                assert!(time.abs_diff(reference) <= 3, "slave {position}: {time} beside {reference}");
                assert!(bus.read_u32(position, DC_SYSTEM_TIME_DIFFERENCE) & 0x7FFF_FFFF <= 3);
            }
        }
        let speed = bus.read_u16(1, DC_SPEED_DIFFERENCE) as i16;
        let expected = 55e-6 * 4096.0 * 4096.0;
        assert!((f64::from(speed) - expected).abs() < 0.02 * expected, "{speed} beside {expected}");
        assert_eq!(bus.read_u16(0, DC_SPEED_DIFFERENCE), 0, "the reference clock is its own master");
    }
}

#[test]
fn writing_the_speed_counter_start_resets_the_difference() {
    let mut bus = Bus::new(1);
    bus.write(0, DC_SYSTEM_TIME, &[0; 4]);
    assert_ne!(bus.read_u32(0, DC_SYSTEM_TIME_DIFFERENCE), 0);
    bus.write(0, DC_SPEED_START, &[0, 0x10]);
    assert_eq!(bus.read_u32(0, DC_SYSTEM_TIME_DIFFERENCE), 0);
}

#[test]
fn difference_is_of_32_bits_and_includes_the_delay() {
    let mut bus = Bus::new(1);
    bus.now = 5_000_000_000;
    bus.write(0, DC_SYSTEM_TIME_DELAY, &1_000u32.to_le_bytes());
    let own = (bus.now + 1_000_000) as u32;
    bus.write(0, DC_SYSTEM_TIME, &(own - 1_000 - 77).to_le_bytes());
    assert_eq!(bus.read_u32(0, DC_SYSTEM_TIME_DIFFERENCE), 77);
    bus.write(0, DC_SPEED_START, &[0, 0x10]);
    bus.write(0, DC_SYSTEM_TIME, &(own - 1_000 + 77).to_le_bytes());
    assert_eq!(bus.read_u32(0, DC_SYSTEM_TIME_DIFFERENCE), 0x8000_004D);
}

/// Starts SYNC0 `lead` ns from now with the given activation byte; the start time.
fn start_sync(bus: &mut Bus, lead: u64, cycles: [u32; 2], activation: u8) -> u64 {
    let start = bus.read_u64(0, DC_SYSTEM_TIME) + lead;
    assert_eq!(bus.write(0, DC_CYCLIC_CONTROL, &[0, 0]), 1);
    assert_eq!(bus.write(0, DC_START_TIME, &start.to_le_bytes()), 1);
    assert_eq!(
        bus.write(0, DC_SYNC0_CYCLE, &[cycles[0].to_le_bytes(), cycles[1].to_le_bytes()].concat()),
        1
    );
    assert_eq!(bus.write(0, DC_ACTIVATION, &[activation]), 1);
    start
}

/// The instants, from now on and in steps of 1 us, at which SYNC0 and SYNC1 are seen.
fn watch(bus: &mut Bus, microseconds: u64) -> [Vec<u64>; 2] {
    let begin = bus.now;
    let mut seen = [vec![], vec![]];
    for _ in 0..microseconds {
        bus.pass(1_000);
        let events = bus.chip(0).events();
        for (signal, (event, register)) in [(AlEvents::SYNC0, DC_SYNC0_STATUS), (AlEvents::SYNC1, DC_SYNC1_STATUS)]
            .into_iter()
            .enumerate()
        {
            if events.has(event) {
                seen[signal].push(bus.now - begin);
                bus.chip(0).read_u8(register);
                assert!(!bus.chip(0).events().has(event), "acknowledged by reading");
            }
        }
    }
    seen
}

#[test]
fn sync0_fires_at_the_start_time_and_every_cycle_after() {
    let mut bus = Bus::new(1);
    let start = start_sync(&mut bus, 100_000, [50_000, 0], 3);
    assert_eq!(bus.read_u64(0, DC_START_TIME), start);
    assert_eq!(bus.read_u8(0, DC_ACTIVATION_STATUS), 3);
    assert_eq!(watch(&mut bus, 220), [vec![100_000, 150_000, 200_000], vec![]]);
    assert_eq!(bus.read_u64(0, DC_START_TIME), start + 150_000, "reads as the next pulse");
    assert_eq!(bus.read_u8(0, DC_ACTIVATION_STATUS), 0);
    bus.write(0, DC_ACTIVATION, &[0]);
    assert_eq!(watch(&mut bus, 200), [vec![], vec![]]);
    assert_eq!(bus.read_u64(0, DC_START_TIME), start);
}

#[test]
fn pulses_missed_by_a_late_slave_are_one_event_and_the_bus_sees_the_next_nevertheless() {
    let mut bus = Bus::new(1);
    let start = start_sync(&mut bus, 100_000, [50_000, 0], 3);
    bus.now += 1_010_000;
    assert_eq!(bus.read_u64(0, DC_START_TIME), start + 950_000);
    bus.catch_up();
    assert!(bus.chip(0).events().has(AlEvents::SYNC0));
    assert_eq!(watch(&mut bus, 100)[0], [1_000, 40_000, 90_000], "the pending one, then in rhythm");
}

#[test]
fn writing_the_same_activation_again_changes_nothing() {
    let mut bus = Bus::new(1);
    start_sync(&mut bus, 10_000, [50_000, 0], 3);
    bus.pass(30_000);
    bus.chip(0).read_u8(DC_SYNC0_STATUS);
    bus.write(0, DC_ACTIVATION, &[3]);
    assert_eq!(watch(&mut bus, 60)[0], [30_000]);
}

#[test]
fn sync_signals_need_their_bits_in_activation_and_configuration() {
    let mut bus = Bus::new(1);
    start_sync(&mut bus, 10_000, [50_000, 0], 1);
    assert_eq!(watch(&mut bus, 100), [vec![], vec![]]);
    let mut silent = Bus::of(vec![esc::Chip::new(esc::ChipConfig {
        eeprom: [0xFF; esc::EEPROM_SIZE],
        clock_offset_ns: 0,
        clock_ppb: 0,
    })]);
    start_sync(&mut silent, 10_000, [50_000, 0], 3);
    assert_eq!(watch(&mut silent, 100), [vec![], vec![]], "0x0151 is not loaded");
}

#[test]
fn start_time_activates_by_itself_when_told_so() {
    let mut bus = Bus::new(1);
    let now = bus.read_u64(0, DC_SYSTEM_TIME);
    bus.write(0, DC_SYNC0_CYCLE, &50_000u32.to_le_bytes());
    bus.write(0, DC_ACTIVATION, &[dc_activation::AUTO | dc_activation::SYNC0]);
    assert_eq!(watch(&mut bus, 10)[0], []);
    // 32 bits only: the rest is completed from the present time.
    bus.write(0, DC_START_TIME, &((now + 40_000) as u32).to_le_bytes());
    assert_eq!(bus.read_u8(0, DC_ACTIVATION), 0b1011);
    assert_eq!(watch(&mut bus, 100)[0], [30_000, 80_000]);
}

/// The level of both signals as the bus sees it.
fn levels(bus: &mut Bus) -> [u8; 2] {
    bus.read(0, DC_SYNC0_STATUS, 2).data.try_into().unwrap()
}

#[test]
fn a_signal_is_high_for_the_length_of_its_pulse() {
    // The EEPROM says 10 us.
    let mut bus = Bus::new(1);
    start_sync(&mut bus, 100_000, [50_000, 20_000], 7);
    let mut seen = 0;
    for (at, expected) in [
        (99_999, [0, 0]),
        (100_000, [1, 0]),
        (109_999, [1, 0]),
        (110_000, [0, 0]),
        (120_000, [0, 1]),
        (130_000, [0, 0]),
        (155_000, [1, 0]),
        (175_000, [0, 1]),
    ] {
        bus.pass(at - seen);
        seen = at;
        assert_eq!(levels(&mut bus), expected, "{at}");
    }
    assert_eq!(bus.chip(0).read_u8(DC_SYNC1_STATUS), 1, "the slave sees the same");
    assert_eq!(levels(&mut bus), [0, 1], "and its reading shortens no pulse");
    bus.write(0, DC_ACTIVATION, &[0]);
    assert_eq!(levels(&mut bus), [0, 0]);
}

#[test]
fn in_acknowledge_mode_a_signal_is_high_until_the_slave_has_read_its_status() {
    let mut eeprom = bus::eeprom();
    eeprom[4..6].fill(0);
    eeprom[14] = wire::sii::checksum(&eeprom);
    let mut bus = Bus::of(vec![esc::Chip::new(esc::ChipConfig {
        eeprom,
        clock_offset_ns: 0,
        clock_ppb: 0,
    })]);
    assert_eq!(bus.read_u16(0, DC_PULSE_LENGTH), 0);
    start_sync(&mut bus, 100_000, [50_000, 20_000], 7);
    bus.pass(100_000);
    assert_eq!(levels(&mut bus), [1, 0]);
    bus.pass(49_000);
    assert_eq!(levels(&mut bus), [1, 1]);
    assert_eq!(bus.chip(0).read_u8(DC_SYNC0_STATUS), 1);
    assert_eq!(levels(&mut bus), [0, 1], "each for itself");
    bus.pass(1_000);
    assert_eq!(levels(&mut bus), [1, 1]);
}

#[test]
fn a_single_shot_is_one_pulse_until_the_unit_is_started_anew() {
    let mut bus = Bus::new(1);
    for _ in 0..2 {
        let start = start_sync(&mut bus, 100_000, [0, 30_000], 7);
        assert_eq!(bus.read_u8(0, DC_ACTIVATION_STATUS), 3);
        assert_eq!(watch(&mut bus, 110), [vec![100_000], vec![]]);
        assert_eq!(bus.read_u8(0, DC_ACTIVATION_STATUS), 2, "SYNC1 is still to come");
        assert_eq!(watch(&mut bus, 300), [vec![], vec![20_000]]);
        assert_eq!(bus.read_u8(0, DC_ACTIVATION_STATUS), 0);
        assert_eq!(
            (bus.read_u64(0, DC_START_TIME), bus.read_u64(0, DC_NEXT_SYNC1)),
            (start, start + 30_000)
        );
    }
}

#[test]
fn start_times_are_judged_as_the_activation_says() {
    const NEAR: u64 = 1 << 31;
    const ON: u8 = dc_activation::CYCLIC | dc_activation::SYNC0;
    const CHECKED: u8 = ON | dc_activation::PLAUSIBILITY;
    const NARROW: u8 = dc_activation::NEAR_FUTURE;
    // From now, activation, first pulse and activation status right after starting.
    for (what, lead, activation, first, status) in [
        ("ahead", 40_000, ON, Some(40_000), 3),
        ("in the past", u64::MAX, ON, None, 7),
        ("long past", 1 << 63, ON, None, 7),
        ("in the past, checked", u64::MAX, CHECKED, Some(0), 4),
        ("far ahead, near future only", NEAR, ON | NARROW, None, 7),
        ("far ahead, near future only, checked", NEAR, CHECKED | NARROW, Some(0), 4),
        ("just near enough, checked", NEAR - 1, CHECKED | NARROW, None, 3),
        ("far ahead, checked", NEAR, CHECKED, None, 3),
        (
            "64 bits written, extended from 32: far past is ahead",
            (1 << 32) + 40_000,
            ON | dc_activation::EXTEND_START,
            Some(40_000),
            3,
        ),
        ("64 bits written: far ahead", (1 << 32) + 40_000, ON, None, 3),
    ] {
        let mut bus = Bus::new(1);
        let now = bus.read_u64(0, DC_SYSTEM_TIME);
        let start = now.wrapping_add(lead);
        bus.write(0, DC_START_TIME, &start.to_le_bytes());
        bus.write(0, DC_SYNC0_CYCLE, &50_000u32.to_le_bytes());
        bus.write(0, DC_ACTIVATION, &[activation]);
        assert_eq!(bus.read_u8(0, DC_ACTIVATION_STATUS), status, "{what}");
        if first == Some(0) {
            bus.catch_up();
            assert!(bus.chip(0).events().has(AlEvents::SYNC0), "{what}");
        } else {
            let seen = watch(&mut bus, 100)[0].first().copied();
            assert_eq!(seen, first, "{what}");
        }
    }
}

#[test]
fn sync1_follows_with_its_cycle_time_and_leaves_out_the_sync0_pulses_on_the_way() {
    for (cycle1, expected) in [
        (20_000, vec![120_000, 170_000, 220_000, 270_000]),
        (50_000, vec![150_000, 200_000, 250_000]),
        (70_000, vec![170_000, 270_000]),
        (100_000, vec![200_000, 300_000]),
    ] {
        let mut bus = Bus::new(1);
        start_sync(&mut bus, 100_000, [50_000, cycle1], 7);
        let [sync0, sync1] = watch(&mut bus, 300);
        assert_eq!(sync0, [100_000, 150_000, 200_000, 250_000, 300_000]);
        assert_eq!(sync1[..expected.len()], expected, "SYNC1 every {cycle1} ns");
    }
}

#[test]
fn the_debug_pulse_is_one_event_and_its_bit_reads_zero() {
    let mut bus = Bus::new(1);
    for (signals, expected) in [
        (dc_activation::SYNC0, AlEvents::SYNC0),
        (dc_activation::SYNC1, AlEvents::SYNC1),
        (dc_activation::SYNC0 | dc_activation::SYNC1, AlEvents::SYNC0 | AlEvents::SYNC1),
    ] {
        bus.write(0, DC_ACTIVATION, &[dc_activation::DEBUG_PULSE | signals]);
        assert_eq!(bus.read_u8(0, DC_ACTIVATION), signals);
        bus.catch_up();
        assert_eq!(bus.chip(0).events().0 & (AlEvents::SYNC0 | AlEvents::SYNC1), expected);
        bus.chip(0).read_u16(DC_SYNC0_STATUS);
        assert_eq!(watch(&mut bus, 100), [vec![], vec![]], "once");
    }
}

#[test]
fn the_cyclic_unit_obeys_its_owner() {
    let mut bus = Bus::new(1);
    bus.chip(0).write(DC_SYNC0_CYCLE, &[1; 4]);
    assert_eq!(bus.read_u32(0, DC_SYNC0_CYCLE), 0);
    bus.write(0, DC_CYCLIC_CONTROL, &[1]);
    assert_eq!(bus.write(0, DC_SYNC0_CYCLE, &[2; 4]), 0);
    assert_eq!(bus.write(0, DC_ACTIVATION, &[3]), 0);
    bus.chip(0).write(DC_SYNC0_CYCLE, &[1; 4]);
    assert_eq!(bus.read_u32(0, DC_SYNC0_CYCLE), 0x0101_0101);
}

#[test]
fn time_may_lag_behind_frames_without_harm() {
    let mut bus = Bus::new(1);
    bus.now = 1_000_000_000;
    start_sync(&mut bus, 100_000, [50_000, 0], 3);
    bus.chip(0).advance(Nanos(999_000_000));
    assert!(!bus.chip(0).events().has(AlEvents::SYNC0));
    bus.chip(0).advance(Nanos(1_000_100_000));
    assert!(bus.chip(0).events().has(AlEvents::SYNC0));
    bus.chip(0).advance(Nanos(0));
    assert!(bus.chip(0).events().has(AlEvents::SYNC0));
}
