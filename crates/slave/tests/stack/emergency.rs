//! Emergency messages: when they are sent, and behind what.

use crate::workbench::{Bench, configuration};

/// The emergency among what lies in the mailbox, without headers.
fn emergency(message: Option<Vec<u8>>) -> Option<[u8; 8]> {
    let message = message?;
    assert_eq!(message[..5], [10, 0, 0, 0, 0], "to the master");
    assert_eq!((message[5] & 0x8F, &message[6..8]), (3, &[0, 0x10][..]));
    assert!(message[16..].iter().all(|&byte| byte == 0));
    Some(message[8..16].try_into().unwrap())
}

/// Polls, and fetches what lies in the mailbox.
fn fetch(bench: &mut Bench) -> Option<[u8; 8]> {
    bench.poll();
    emergency(bench.chip.receive())
}

const FAULT: [u8; 8] = [0x10, 0x31, 0x21, 4, 0, 0, 0, 9];
const CLEARED: [u8; 8] = [0, 0, 0, 4, 0, 0, 0, 9];

#[test]
fn a_fault_is_told_once_when_it_comes_and_once_when_it_goes() {
    for bench in [Bench::preop, Bench::safeop, Bench::op] {
        let mut bench = bench();
        assert_eq!(fetch(&mut bench), None);
        bench.lamp.fault = 0x3110;
        assert_eq!(fetch(&mut bench), Some(FAULT));
        assert_eq!(fetch(&mut bench), None);
        bench.lamp.fault = 0;
        assert_eq!(fetch(&mut bench), Some(CLEARED));
        assert_eq!(fetch(&mut bench), None);
    }
}

#[test]
fn one_fault_in_place_of_another_is_told() {
    let mut bench = Bench::preop();
    for code in [0x3110, 0x7500_u16] {
        bench.lamp.fault = code;
        assert_eq!(fetch(&mut bench).unwrap()[..2], code.to_le_bytes());
    }
}

#[test]
fn a_fault_from_before_the_first_mailbox_is_told() {
    let mut bench = Bench::new();
    bench.lamp.fault = 0x3110;
    bench.poll();
    bench.set_mailboxes(128);
    assert_eq!(bench.request(0x12), (2, 0));
    assert_eq!(fetch(&mut bench), Some(FAULT));
    assert_eq!(fetch(&mut bench), None);
}

#[test]
fn a_fault_from_before_a_mailbox_was_started_anew_is_not_told_but_its_end_is() {
    let mut bench = Bench::preop();
    assert_eq!(fetch(&mut bench), None);
    bench.request(0x11);
    bench.lamp.fault = 0x3110;
    bench.poll();
    assert_eq!(bench.request(0x12), (2, 0));
    assert_eq!(fetch(&mut bench), None);
    bench.lamp.fault = 0;
    assert_eq!(fetch(&mut bench), Some(CLEARED));
}

#[test]
fn an_emergency_that_was_not_fetched_is_gone_after_init() {
    let mut bench = Bench::preop();
    bench.lamp.fault = 0x3110;
    bench.poll();
    bench.request(0x11);
    bench.request(0x12);
    assert_eq!(fetch(&mut bench), None);
}

/// An upload of 0x2000:00.
const UPLOAD: [u8; 16] = [10, 0, 0, 0, 0, 0x03, 0, 0x20, 0x40, 0x00, 0x20, 0, 0, 0, 0, 0];

#[test]
fn no_emergency_comes_between_a_request_and_its_response() {
    // The fault comes before the request, together with it, and after it.
    for moment in 0..3 {
        let mut bench = Bench::preop();
        if moment == 0 {
            bench.lamp.fault = 0x3110;
            bench.poll();
        }
        assert!(bench.chip.send(&UPLOAD));
        if moment == 1 {
            bench.lamp.fault = 0x3110;
        }
        bench.poll();
        bench.lamp.fault = 0x3110;
        bench.poll();
        let response = bench.chip.receive().unwrap();
        assert_eq!(response[6..8], [0, 0x30], "moment {moment}: the response comes first");
        let then = {
            bench.poll();
            bench.chip.receive()
        };
        assert_eq!(emergency(then.clone()), Some(FAULT), "moment {moment}");
        assert_eq!(fetch(&mut bench), None, "moment {moment}: once");
        let counter = |message: &[u8]| message[5] >> 4;
        assert_eq!(
            counter(&then.unwrap()),
            counter(&response) % 7 + 1,
            "moment {moment}: no counter is left out"
        );
    }
}

#[test]
fn an_emergency_waits_for_the_end_of_a_list() {
    let mut bench = Bench::preop_with(configuration(), 36);
    let mut message = bench.exchange(3, &[0, 0x80, 1, 0, 0, 0, 1, 0]).unwrap();
    bench.lamp.fault = 0x3110;
    while message[8] & 0x80 != 0 {
        bench.poll();
        message = bench.chip.receive().unwrap();
        assert_eq!(message[7], 0x80, "a part of the list");
    }
    assert_eq!(fetch(&mut bench), Some(FAULT));
}

#[test]
fn a_list_asked_for_over_an_unread_emergency_comes_first() {
    let mut bench = Bench::preop_with(configuration(), 36);
    bench.lamp.fault = 0x3110;
    bench.poll();
    let first = bench.exchange(3, &[0, 0x80, 1, 0, 0, 0, 1, 0]).unwrap();
    assert_eq!(first[7], 0x80);
}

#[test]
fn what_the_master_does_not_fetch_is_bounded_and_ends_with_the_present_state() {
    let mut bench = Bench::preop();
    for code in 1..1000 {
        bench.lamp.fault = code;
        bench.poll();
    }
    let mut told = vec![];
    while let Some(message) = fetch(&mut bench) {
        told.push(u16::from_le_bytes([message[0], message[1]]));
    }
    assert_eq!(told, [1, 2, 3, 4, 5, 999], "one in the mailbox, four waiting, and what is true now");
}

#[test]
fn a_lost_emergency_is_repeated() {
    let mut bench = Bench::preop();
    bench.lamp.fault = 0x3110;
    bench.poll();
    let first = bench.chip.receive();
    bench.poll();
    bench.chip.toggle_repeat();
    bench.poll();
    assert!(bench.chip.repeat_is_answered());
    assert_eq!(bench.chip.receive(), first);
}

#[test]
fn an_emergency_that_makes_way_leaves_the_repeat_acknowledge_alone() {
    let mut bench = Bench::preop();
    bench.chip.toggle_repeat();
    bench.lamp.fault = 0x3110;
    bench.poll();
    bench.chip.send(&UPLOAD);
    bench.poll();
    assert!(bench.chip.repeat_is_answered());
    assert_eq!(bench.chip.receive().unwrap()[7], 0x30);
}
