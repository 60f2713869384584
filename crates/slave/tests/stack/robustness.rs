//! Whatever a master does, nothing panics and INIT leads out.

use proptest::prelude::*;
use wire::{AlEvents, register as reg};

use crate::workbench::{Bench, MILLISECOND, configuration};

/// Something a master, or a disturbed bus, does.
#[derive(Clone, Debug)]
enum Act {
    Mailbox(Vec<u8>),
    Coe(Vec<u8>),
    Foe(Vec<u8>),
    Fetch,
    Request(u16),
    Register(u16, Vec<u8>),
    SyncManager(usize, u16, u16, u8, u8),
    Outputs(Vec<u8>),
    Events(u32),
    Fault(u16),
    Advance(u64),
}

fn bytes() -> impl Strategy<Value = Vec<u8>> {
    proptest::collection::vec(any::<u8>(), 0..140)
}

/// An SDO request that is more likely to mean something.
fn sdo() -> impl Strategy<Value = Vec<u8>> {
    let index = prop_oneof![
        Just(0x1600_u16),
        Just(0x1C12),
        Just(0x1C32),
        Just(0x2007),
        Just(0x2008),
        Just(0x100A),
        0x1000..0x2010_u16
    ];
    (any::<u8>(), index, 0..14_u8, proptest::collection::vec(any::<u8>(), 4..60)).prop_map(|(command, index, sub, rest)| {
        let [low, high] = index.to_le_bytes();
        [&[0, 0x20, command, low, high, sub], &rest[..]].concat()
    })
}

/// A message of FoE that is more likely to mean something.
fn foe() -> impl Strategy<Value = Vec<u8>> {
    let name = prop_oneof![
        Just(b"note.txt".to_vec()),
        Just(b"fixed.txt".to_vec()),
        Just(b"eventlog.txt\0".to_vec()),
        proptest::collection::vec(any::<u8>(), 0..130)
    ];
    (0..8_u8, prop_oneof![0..4_u32, any::<u32>()], name)
        .prop_map(|(operation, number, rest)| [&[operation, 0], &number.to_le_bytes()[..], &rest].concat())
}

/// A request for SDO information that is more likely to mean something.
fn information() -> impl Strategy<Value = Vec<u8>> {
    let index = prop_oneof![0..7_u16, Just(0x1600), Just(0x1C32), Just(0x100A), 0x1000..0x2010_u16];
    (0..8_u8, index, 0..34_u8, any::<u8>()).prop_map(|(opcode, index, sub, values)| {
        let [low, high] = index.to_le_bytes();
        vec![0, 0x80, opcode, 0, 0, 0, low, high, sub, values]
    })
}

fn act() -> impl Strategy<Value = Act> {
    let address = prop_oneof![0x0800..0x0820_u16, 0x0980..0x09A8_u16, 0x0400..0x0444_u16, any::<u16>()];
    let in_use = |(index, long, control, activate): (usize, bool, u8, u8)| {
        let (start, length) = [(0x1000, 128), (0x1080, 128), (0x1100, 3), (0x1400, 6)][index];
        Act::SyncManager(index, start, length + u16::from(long), control, activate)
    };
    prop_oneof![
        bytes().prop_map(Act::Mailbox),
        sdo().prop_map(Act::Coe),
        information().prop_map(Act::Coe),
        foe().prop_map(Act::Foe),
        Just(Act::Fetch),
        any::<u16>().prop_map(Act::Request),
        prop_oneof![Just(1_u16), Just(2), Just(4), Just(8), Just(0x12), Just(0x14)].prop_map(Act::Request),
        (address, proptest::collection::vec(any::<u8>(), 1..20)).prop_map(|(address, data)| Act::Register(address, data)),
        (0..4_usize, any::<u16>(), any::<u16>(), any::<u8>(), any::<u8>()).prop_map(|(a, b, c, d, e)| Act::SyncManager(a, b, c, d, e)),
        (
            0..4_usize,
            any::<bool>(),
            prop_oneof![Just(0x26), Just(0x22), Just(0x64), Just(0x20)],
            0..4_u8
        )
            .prop_map(in_use),
        proptest::collection::vec(any::<u8>(), 3).prop_map(Act::Outputs),
        any::<u32>().prop_map(Act::Events),
        (0..3_u16).prop_map(Act::Fault),
        prop_oneof![Just(0), Just(50_000), 0..10_000 * MILLISECOND, any::<u64>()].prop_map(Act::Advance),
    ]
}

fn message(protocol: u8, body: &[u8]) -> Vec<u8> {
    [&[body.len() as u8, 0, 0, 0, 0, protocol], body].concat()
}

fn perform(bench: &mut Bench, act: Act) {
    match act {
        Act::Mailbox(message) => _ = bench.chip.send(&message),
        Act::Coe(body) => _ = bench.chip.send(&message(3, &body)),
        Act::Foe(body) => _ = bench.chip.send(&message(4, &body)),
        Act::Fetch => _ = bench.chip.receive(),
        Act::Request(control) => bench.chip.request(control),
        Act::Register(address, data) => {
            for (address, byte) in (address..=u16::MAX).zip(data) {
                // The PDI's own byte of a sync manager is the one register here that no master can write.
                if !(0x0800..0x0840).contains(&address) || address % 8 != 7 {
                    bench.chip.set(address, &[byte]);
                }
            }
        }
        Act::SyncManager(index, start, length, control, activate) => bench.chip.set_sm(index, start, length, control, activate),
        Act::Outputs(data) => _ = bench.chip.outputs(&data),
        Act::Fault(code) => bench.lamp.fault = code,
        Act::Events(events) => bench.chip.events |= events,
        Act::Advance(time) => bench.now = bench.now.wrapping_add(time),
    }
}

/// Whatever state the bench is in, this is how a master starts.
fn start_again(bench: &mut Bench) {
    bench.chip.request(0x11);
    bench.tick();
    assert_eq!((bench.chip.status(), bench.chip.code()), (1, 0));
    bench.chip.clear_sms();
    bench.tick();
    bench.chip.set_sync_unit(0, 0, 0);
    bench.chip.events &= !(AlEvents::SYNC0 | AlEvents::SYNC1);
    bench.chip.set(reg::PROCESS_WATCHDOG_TIME, &[0xE8, 3]);
    bench.set_mailboxes(128);
    assert_eq!(bench.request(0x12), (2, 0));
    assert_eq!(bench.upload(0x1018, 1).unwrap(), [0x88, 0x0A, 0, 0]);
    assert!(bench.read_file("eventlog.txt").unwrap().starts_with(b"# Event log of Lamp"));
    bench.write_file("note.txt", b"written").unwrap();
    assert_eq!(bench.read_file("note.txt").unwrap(), b"written");
    for (index, pdo) in [(0x1C12, 0x1600_u16), (0x1C13, 0x1A00)] {
        bench.download(index, 0, &[0]).unwrap();
        bench.download(index, 1, &pdo.to_le_bytes()).unwrap();
        bench.download(index, 0, &[1]).unwrap();
    }
    for (index, entries) in [(0x1600, [0x2000_0010_u32, 0x2005_0108]), (0x1A00, [0x6041_0010, 0x2005_0220])] {
        bench.download(index, 0, &[0]).unwrap();
        for (sub, entry) in (1..).zip(entries) {
            bench.download(index, sub, &entry.to_le_bytes()).unwrap();
        }
        bench.download(index, 0, &[2]).unwrap();
    }
    bench.set_process_data(3, 6);
    assert_eq!(bench.request(4), (4, 0));
    bench.request(8);
    assert!(bench.chip.outputs(&[1, 0, 2]));
    bench.tick();
    assert_eq!(bench.chip.status(), 8);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn any_bus_traffic_is_survived_and_init_leads_out(
        start in 0..3_usize,
        acts in proptest::collection::vec(act(), 0..60),
    ) {
        let mut bench = [Bench::preop, Bench::op, Bench::op_with_sync0][start]();
        for act in acts {
            perform(&mut bench, act);
            bench.tick();
        }
        start_again(&mut bench);
    }

    #[test]
    fn any_mailbox_message_has_one_answer_at_most_and_a_list_as_many_as_it_says(
        mailbox in 36..=128_u16,
        messages in proptest::collection::vec((3..5_u8, prop_oneof![bytes(), sdo(), information(), foe()]), 1..20),
    ) {
        let mut bench = Bench::preop_with(configuration(), mailbox);
        for (protocol, body) in messages {
            bench.chip.send(&message(protocol, &body));
            bench.tick();
            let mut left = 1;
            while let Some(answer) = bench.chip.receive() {
                prop_assert!(left > 0);
                let of_a_list = answer[5] & 0x0F == 3 && answer[7] == 0x80 && answer[8] & 0x7F == 2;
                left = if of_a_list { u16::from_le_bytes([answer[10], answer[11]]) } else { 0 };
                prop_assert!(usize::from(u16::from_le_bytes([answer[0], answer[1]])) + 6 <= answer.len());
                bench.tick();
            }
            prop_assert!(left < 2, "a list stops before its end");
        }
        prop_assert_eq!(bench.chip.status(), 2);
    }
}
