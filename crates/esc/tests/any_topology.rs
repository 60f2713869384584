//! However chips are plugged together and replugged, every frame ends, and what it says is true.

mod bus;

use bus::{Bus, PRIMARY, SECONDARY, SOURCE, answers, frame, junction, port};
use esc::{End, Processed, Segment, Side};
use proptest::prelude::*;
use wire::frame::{Command, physical_address};
use wire::register::*;
use wire::{EscAccess, Nanos};

const CHIPS: usize = 5;

#[derive(Clone, Debug)]
enum Step {
    Connect(End, End),
    Disconnect(End),
    Count(Side),
    LoopControl(Side, u16, [u8; 2]),
    Reset(Side),
    Latch(Side),
    Wait(u64),
    PowerCycle(usize),
}

fn end() -> impl Strategy<Value = End> {
    prop_oneof![
        1 => Just(PRIMARY),
        1 => Just(SECONDARY),
        8 => (0..CHIPS, 0..4usize).prop_map(|(position, at)| port(position, at)),
    ]
}

fn side() -> impl Strategy<Value = Side> {
    prop_oneof![Just(Side::Primary), Just(Side::Secondary)]
}

/// Steps that leave loop control alone.
fn replugging() -> impl Strategy<Value = Step> {
    prop_oneof![
        6 => (end(), end()).prop_map(|(one, other)| Step::Connect(one, other)),
        3 => end().prop_map(Step::Disconnect),
        4 => side().prop_map(Step::Count),
        1 => side().prop_map(Step::Reset),
        1 => side().prop_map(Step::Latch),
        1 => (0..2_000_000_000u64).prop_map(Step::Wait),
        1 => (0..CHIPS).prop_map(Step::PowerCycle),
    ]
}

fn any_step() -> impl Strategy<Value = Step> {
    prop_oneof![
        5 => replugging(),
        1 => (side(), 0..CHIPS as u16, any::<[u8; 2]>()).prop_map(|(side, at, control)| Step::LoopControl(side, at, control)),
    ]
}

fn bus(tangled: bool) -> Bus {
    let mut bus = Bus::of((0..CHIPS as u64).map(|at| junction(at, 2 + at as usize % 3)).collect());
    if tangled {
        for position in 0..CHIPS {
            bus.segment.disconnect(port(position, 0));
        }
    }
    bus
}

/// Sends one datagram; how many chips processed it, and where it came out.
fn send(bus: &mut Bus, side: Side, command: Command, address: u32, data: &[u8]) -> (u16, Option<Side>) {
    let before = frame(SOURCE, &[(command, address, data)]);
    let mut sent = before.clone();
    let (processed, exit) = bus.segment.process_from(side, &mut sent, Nanos(bus.now));
    assert_eq!(processed == Processed::Returned, exit.is_some());
    assert_eq!((sent.len(), &sent[..6], &sent[7..18]), (before.len(), &before[..6], &before[7..18]));
    let answer = &answers(&sent)[0];
    let processed = answer.adp.wrapping_sub(address as u16);
    assert_eq!(
        sent[6] != before[6],
        processed != 0,
        "only processing units touch the source address"
    );
    assert!(answer.wkc <= processed && processed <= CHIPS as u16);
    (processed, exit)
}

fn run(bus: &mut Bus, step: &Step) {
    let all = |ado| physical_address(0, ado);
    match *step {
        Step::Connect(one, other) => _ = bus.segment.connect(one, other),
        Step::Disconnect(end) => _ = bus.segment.disconnect(end),
        Step::Count(side) => _ = send(bus, side, Command::Brd, all(TYPE), &[0]),
        Step::LoopControl(side, position, control) => {
            let address = physical_address(0u16.wrapping_sub(position), DL_CONTROL);
            send(bus, side, Command::Apwr, address, &control);
        }
        Step::Reset(side) => {
            for letter in b"RES" {
                send(bus, side, Command::Bwr, all(RESET), &[*letter]);
            }
        }
        Step::Latch(side) => _ = send(bus, side, Command::Bwr, all(DC_RECEIVE_TIMES), &[0]),
        Step::Wait(time) => bus.pass(time),
        Step::PowerCycle(position) => bus.chip(position).power_cycle(),
    }
}

/// Cables end at each other, and DL status knows exactly the ports that have one.
fn check_cables(bus: &mut Bus, automatic: bool) {
    for position in 0..CHIPS {
        let now = Nanos(bus.now);
        bus.chip(position).advance(now);
        let status = bus.chip(position).read_u16(DL_STATUS);
        for at in 0..4 {
            let other = bus.segment.connected(port(position, at));
            if let Some(other) = other {
                assert_eq!(bus.segment.connected(other), Some(port(position, at)));
            }
            let linked = u16::from(other.is_some());
            assert_eq!(status >> (4 + at) & 1, linked);
            assert_eq!(status >> (9 + 2 * at) & 1, linked);
            assert!(!automatic || status >> (8 + 2 * at) & 1 == 1 - linked, "loops follow links");
        }
    }
}

/// Chips whose port 0 has no link, where frames begin to circulate.
fn strays(segment: &mut Segment<Vec<esc::Chip>>) -> usize {
    (0..CHIPS)
        .filter(|position| segment.connected(port(*position, 0)).is_none())
        .count()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1_000))]

    #[test]
    fn no_frame_is_lost_or_processed_twice_while_loops_are_automatic(
        tangled in any::<bool>(),
        steps in prop::collection::vec(replugging(), 1..60),
    ) {
        let mut bus = bus(tangled);
        for step in &steps {
            run(&mut bus, step);
            check_cables(&mut bus, true);
            let mut processed = 0;
            for side in [Side::Primary, Side::Secondary] {
                let plugged = bus.segment.connected(End::Master(side)).is_some();
                let (chips, exit) = send(&mut bus, side, Command::Brd, 0, &[0]);
                processed += chips;
                prop_assert!(plugged || exit.is_none() && chips == 0);
                prop_assert!(exit.is_some() || !plugged || strays(&mut bus.segment) > 1, "destroyed only as circulating");
            }
            prop_assert!(processed <= CHIPS as u16, "one way of a frame leads through each processing unit");
        }
    }

    #[test]
    fn whatever_happens_chips_plugged_as_a_line_are_one(steps in prop::collection::vec(any_step(), 1..60)) {
        let mut bus = bus(false);
        for step in &steps {
            run(&mut bus, step);
            check_cables(&mut bus, false);
        }
        for position in 0..CHIPS {
            for at in 0..4 {
                bus.segment.disconnect(port(position, at));
            }
            bus.chip(position).power_cycle();
        }
        bus.segment.disconnect(PRIMARY);
        let mut upstream = PRIMARY;
        for position in 0..CHIPS {
            bus.plug(upstream, port(position, 0));
            upstream = port(position, 1);
        }
        prop_assert_eq!(send(&mut bus, Side::Primary, Command::Brd, 0, &[0]), (CHIPS as u16, Some(Side::Primary)));
    }
}
