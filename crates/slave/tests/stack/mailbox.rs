//! Headers, counters, duplicates, errors, queueing and the repeat request.

use crate::workbench::{Bench, configuration};

/// An upload of 0x2000:00 with this header.
fn upload(address: u16, counter: u8) -> Vec<u8> {
    let [low, high] = address.to_le_bytes();
    let mut message = vec![10, 0, low, high, 0, counter << 4 | 3];
    message.extend_from_slice(&[0, 0x20, 0x40, 0x00, 0x20, 0, 0, 0, 0, 0]);
    message
}

fn answer(bench: &mut Bench, message: &[u8]) -> Option<Vec<u8>> {
    assert!(bench.chip.send(message));
    bench.poll();
    bench.chip.receive()
}

#[test]
fn answers_count_for_themselves_and_never_zero() {
    let mut bench = Bench::preop();
    for round in 0..20_u8 {
        let reply = answer(&mut bench, &upload(0, 0)).expect("counter 0 is never a duplicate");
        assert_eq!(reply[5] >> 4, round % 7 + 1);
    }
}

#[test]
fn a_repeated_counter_is_discarded_silently() {
    let mut bench = Bench::preop();
    assert!(answer(&mut bench, &upload(0, 5)).is_some());
    assert!(answer(&mut bench, &upload(0, 5)).is_none());
    assert!(answer(&mut bench, &upload(0, 6)).is_some());
    assert!(answer(&mut bench, &upload(0, 5)).is_some());
}

#[test]
fn a_master_that_starts_again_may_repeat_the_last_counter() {
    let mut bench = Bench::preop();
    assert!(answer(&mut bench, &upload(0, 1)).is_some());
    bench.request(0x11);
    bench.request(0x12);
    let reply = answer(&mut bench, &upload(0, 1)).unwrap();
    assert_eq!(reply[5] >> 4, 1);
}

#[test]
fn what_was_left_in_the_mailboxes_is_gone_after_init() {
    let mut bench = Bench::preop();
    bench.chip.send(&upload(0, 1));
    bench.poll();
    bench.request(0x11);
    bench.chip.send(&upload(0, 2));
    bench.request(0x12);
    assert_eq!(bench.chip.receive(), None);
    assert!(answer(&mut bench, &upload(0, 3)).is_some());
}

#[test]
fn the_address_is_echoed_as_igh_expects() {
    let mut bench = Bench::preop();
    assert_eq!(answer(&mut bench, &upload(0x03E9, 0)).unwrap()[2..4], [0xE9, 0x03]);
}

#[test]
fn messages_that_cannot_be_served_are_answered_with_the_mailbox_error() {
    let coe = |service: u8, length: usize| {
        let mut body = vec![0, service << 4];
        body.resize(length, 0);
        body
    };
    let cases: [(&str, u8, Vec<u8>, u8); 19] = [
        ("AoE", 1, coe(2, 10), 2),
        ("EoE", 2, coe(2, 10), 2),
        ("no FoE header", 4, coe(2, 5), 6),
        ("SoE", 5, coe(2, 10), 2),
        ("VoE", 15, coe(2, 10), 2),
        ("no CoE header", 3, vec![0], 6),
        ("nothing at all", 3, vec![], 6),
        ("SDO too short", 3, coe(2, 9), 6),
        ("CoE service 0", 3, coe(0, 10), 5),
        ("CoE service 9", 3, coe(9, 10), 5),
        ("CoE service 15", 3, coe(15, 10), 5),
        ("emergency", 3, coe(1, 10), 4),
        ("SDO response", 3, coe(3, 10), 4),
        ("TxPDO", 3, coe(4, 10), 4),
        ("RxPDO", 3, coe(5, 10), 4),
        ("RxPDO request", 3, coe(7, 10), 4),
        ("no header of SDO information", 3, coe(8, 5), 6),
        ("no list type", 3, [&coe(8, 2)[..], &[1, 0, 0, 0, 1]].concat(), 6),
        ("no value info", 3, [&coe(8, 2)[..], &[5, 0, 0, 0, 0x18, 0x10, 1]].concat(), 6),
    ];
    for (what, protocol, body, code) in cases {
        let mut bench = Bench::preop();
        let reply = bench.exchange(protocol, &body).expect(what);
        assert_eq!((reply[0..2].to_vec(), reply[5] & 0x0F), (vec![4, 0], 0), "{what}");
        assert_eq!(reply[6..10], [1, 0, code, 0], "{what}");
    }
}

#[test]
fn a_length_beyond_the_mailbox_is_an_error() {
    for (mailbox, length, code) in [(36, 31_u16, 8), (128, 123, 8), (128, 0xFFFF, 8)] {
        let mut bench = Bench::preop_with(configuration(), mailbox);
        let mut message = upload(0, 1);
        message[..2].copy_from_slice(&length.to_le_bytes());
        assert_eq!(answer(&mut bench, &message).unwrap()[6..10], [1, 0, code, 0]);
    }
    let mut bench = Bench::preop_with(configuration(), 36);
    let mut message = upload(0, 1);
    message[0] = 30;
    assert_eq!(answer(&mut bench, &message).unwrap()[8], 0x4B, "exactly the mailbox fits");
}

#[test]
fn an_error_reply_of_the_master_is_not_answered() {
    let mut bench = Bench::preop();
    assert_eq!(bench.exchange(0, &[1, 0, 2, 0]), None);
}

#[test]
fn requests_wait_in_the_chip_when_the_master_does_not_fetch_the_answers() {
    let mut bench = Bench::preop();
    let mut sent = 0;
    while bench.chip.send(&upload(sent, 0)) && sent < 50 {
        bench.poll();
        sent += 1;
    }
    assert!((5..10).contains(&sent), "{sent}");
    let mut fetched = vec![];
    while let Some(reply) = bench.chip.receive() {
        fetched.push(u16::from_le_bytes([reply[2], reply[3]]));
        bench.poll();
    }
    assert_eq!(fetched, (0..sent).collect::<Vec<_>>(), "nothing is lost and the order stays");
}

#[test]
fn a_repeat_request_brings_the_last_answer_again_before_the_next() {
    let mut bench = Bench::preop();
    let first = answer(&mut bench, &upload(1, 1)).unwrap();
    bench.chip.send(&upload(2, 2));
    bench.poll();
    bench.chip.toggle_repeat();
    bench.poll();
    assert!(bench.chip.repeat_is_answered());
    assert_eq!(bench.chip.receive(), Some(first));
    bench.poll();
    let second = bench.chip.receive().unwrap();
    assert_eq!(second[2], 2);
    bench.chip.toggle_repeat();
    bench.poll();
    assert!(bench.chip.repeat_is_answered());
    assert_eq!(bench.chip.receive(), Some(second));
}

#[test]
fn a_repeat_request_without_an_earlier_answer_is_only_acknowledged() {
    let mut bench = Bench::preop();
    bench.chip.toggle_repeat();
    bench.poll();
    assert!(bench.chip.repeat_is_answered());
    assert_eq!(bench.chip.receive(), None);
    bench.chip.send(&upload(7, 1));
    bench.poll();
    bench.chip.toggle_repeat();
    bench.poll();
    assert!(bench.chip.repeat_is_answered());
    assert_eq!(bench.chip.receive().unwrap()[2], 7, "the unread answer is still there");
}

#[test]
fn a_mailbox_moved_in_preop_is_followed() {
    let mut bench = Bench::preop();
    bench.chip.set_sm(0, 0x1040, 40, 0x26, 1);
    bench.chip.set_sm(1, 0x10A0, 44, 0x22, 1);
    bench.poll();
    assert_eq!(bench.chip.status(), 2);
    assert_eq!(answer(&mut bench, &upload(0, 1)).unwrap().len(), 44);
}
