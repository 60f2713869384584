//! File transfers: packets, errors, repeats and what ends a transfer.

use proptest::prelude::*;

use crate::workbench::{Bench, configuration};

const READ: u8 = 1;
const WRITE: u8 = 2;
const DATA: u8 = 3;
const ACK: u8 = 4;
const ERROR: u8 = 5;
const BUSY: u8 = 6;

/// Data bytes of a full packet in the mailbox of 128 bytes.
const ROOM: usize = 116;

fn noted(lines: &[usize]) -> Bench {
    let mut bench = Bench::preop();
    bench.lamp.note = lines
        .iter()
        .zip(b'a'..)
        .map(|(&n, c)| char::from(c).to_string().repeat(n))
        .collect();
    bench
}

#[test]
fn packets_fill_the_mailbox_and_a_shorter_one_is_the_last() {
    for (lines, sizes) in [
        (&[][..], &[0][..]),
        (&[1], &[1]),
        (&[115], &[115]),
        (&[116], &[116, 0]),
        (&[117], &[116, 1]),
        (&[100, 16, 0, 0], &[116, 0]),
        (&[128, 128, 128], &[116, 116, 116, 36]),
    ] {
        let mut bench = noted(lines);
        let mut answer = bench.foe(READ, 0, b"note.txt");
        let mut file = vec![];
        for (packet, &size) in (1..).zip(sizes) {
            let (operation, number, data) = answer.unwrap();
            assert_eq!((operation, number, data.len()), (DATA, packet, size), "{lines:?}");
            file.extend_from_slice(&data);
            answer = bench.foe(ACK, packet, &[]);
        }
        assert_eq!(answer, None);
        assert_eq!(file, bench.lamp.note.concat().into_bytes());
    }
}

#[test]
fn a_file_written_takes_effect_with_its_last_packet_and_is_logged() {
    let mut bench = Bench::preop();
    assert_eq!(bench.foe(WRITE, 0, b"note.txt"), Some((ACK, 0, vec![])));
    assert_eq!(bench.foe(DATA, 1, &[b'x'; ROOM]), Some((ACK, 1, vec![])));
    assert!(bench.lamp.note.is_empty());
    assert_eq!(bench.foe(DATA, 2, &[]), Some((ACK, 2, vec![])));
    assert_eq!(bench.lamp.note, ["x".repeat(ROOM)]);
    let log = String::from_utf8(bench.read_file("eventlog.txt").unwrap()).unwrap();
    assert!(log.ends_with("information File note.txt written\n"), "{log}");
}

#[test]
fn messages_that_do_not_belong_to_the_transfer_end_it_with_an_error() {
    type Message = (u8, u32, &'static [u8]);
    let reading: &[Message] = &[(READ, 0, b"note.txt")];
    let writing: &[Message] = &[(WRITE, 0, b"note.txt"), (DATA, 1, &[b'x'; ROOM])];
    let written: &[Message] = &[(WRITE, 0, b"note.txt"), (DATA, 1, b"x")];
    let cases: [(&[Message], Message, u32, &str); 15] = [
        (&[], (READ, 0, b"other.txt"), 0x8001, "there is no such file"),
        (&[], (WRITE, 0, b""), 0x8001, "there is no such file"),
        (&[], (WRITE, 0, b"fixed.txt"), 0x8002, "this file can be read only"),
        (&[], (WRITE, 0, b"eventlog.txt"), 0x8002, "this file can be read only"),
        (&[], (ACK, 1, b""), 0x8004, "no file is being read"),
        (&[], (BUSY, 0, b""), 0x8004, "no file is being read"),
        (&[], (DATA, 1, b""), 0x8004, "no file is being written"),
        (&[], (7, 0, b""), 0x8004, "there is no operation 7"),
        (reading, (ACK, 2, b""), 0x8005, "packet 2 came where 1 was due"),
        (reading, (DATA, 1, b""), 0x8004, "no file is being written"),
        (reading, (0, 0, b""), 0x8004, "there is no operation 0"),
        (writing, (DATA, 3, b""), 0x8005, "packet 3 came where 2 was due"),
        (writing, (ACK, 1, b""), 0x8004, "no file is being read"),
        (writing, (WRITE, 0, b"other.txt"), 0x8001, "there is no such file"),
        (written, (DATA, 2, b""), 0x8004, "the file has ended"),
    ];
    for (before, (operation, number, rest), code, text) in cases {
        let mut bench = noted(&[ROOM, 1]);
        for &(operation, number, rest) in before {
            let answer = bench.foe(operation, number, rest).unwrap();
            assert_ne!(answer.0, ERROR);
        }
        let answer = bench.foe(operation, number, rest).unwrap();
        assert_eq!(answer, (ERROR, code, text.into()), "{before:?}");
        assert!(bench.foe(ACK, 1, &[]).unwrap().0 == ERROR && bench.foe(DATA, 2, &[]).unwrap().0 == ERROR);
    }
}

#[test]
fn what_the_device_refuses_comes_with_its_reason() {
    let mut bench = Bench::preop();
    bench.lamp.note_refusal = Some("line 3: no");
    assert_eq!(bench.write_file("note.txt", b"x"), Err((0x8000, "line 3: no".into())));
    bench.lamp.locked = true;
    assert_eq!(bench.write_file("note.txt", b"x"), Err((0x8002, "locked".into())));
    assert!(bench.lamp.note.is_empty());
    let mut bench = Bench::preop_with(configuration(), 36);
    bench.lamp.note_refusal = Some("line 3: a reason longer than the mailbox");
    assert_eq!(bench.write_file("note.txt", b"x"), Err((0x8000, "line 3: a reason longer ".into())));
}

#[test]
fn a_packet_sent_again_is_acknowledged_again_and_written_once() {
    let mut bench = Bench::preop();
    bench.foe(WRITE, 0, b"note.txt");
    for (packet, data) in [(1, &[b'x'; ROOM][..]), (2, b"y")] {
        for _ in 0..3 {
            assert_eq!(bench.foe(DATA, packet, data), Some((ACK, packet, vec![])));
        }
    }
    assert_eq!(bench.lamp.note, ["x".repeat(ROOM) + "y"]);
}

#[test]
fn a_busy_master_gets_the_same_packet_again() {
    let mut bench = noted(&[ROOM, 5]);
    bench.foe(READ, 0, b"note.txt");
    let second = bench.foe(ACK, 1, &[]);
    assert_eq!(bench.foe(BUSY, 0, b"wait"), second);
    assert_eq!(second, Some((DATA, 2, b"bbbbb".to_vec())));
    assert_eq!(bench.foe(ACK, 2, &[]), None);
}

#[test]
fn a_line_that_changes_between_two_packets_is_not_torn() {
    let mut bench = noted(&[ROOM - 2, 4]);
    bench.foe(READ, 0, b"note.txt");
    bench.lamp.note[1] = "x".into();
    assert_eq!(bench.foe(ACK, 1, &[]), Some((DATA, 2, b"bb".to_vec())));
}

#[test]
fn a_new_request_takes_the_place_of_a_transfer_and_an_error_of_the_master_ends_it() {
    let mut bench = noted(&[ROOM, 1]);
    bench.foe(WRITE, 0, b"note.txt");
    bench.foe(DATA, 1, &[b'x'; ROOM]);
    assert_eq!(bench.read_file("note.txt").unwrap().len(), ROOM + 1);
    bench.foe(WRITE, 0, b"note.txt");
    bench.foe(DATA, 1, &[b'y'; ROOM]);
    assert_eq!(bench.foe(ERROR, 0x8000, b"no more"), None);
    assert_eq!(bench.foe(DATA, 2, b"z").unwrap().0, ERROR);
    assert_eq!(bench.read_file("note.txt").unwrap().len(), ROOM + 1);
}

#[test]
fn a_transfer_goes_on_through_all_states_but_init_and_beside_sdo() {
    let mut bench = noted(&[ROOM, ROOM, ROOM, ROOM, 1]);
    bench.foe(READ, 0, b"note.txt\0");
    assert!(bench.upload(0x1018, 1).is_ok());
    bench.set_process_data(3, 6);
    bench.request(4);
    assert_eq!(bench.foe(ACK, 1, &[]).unwrap().0, DATA);
    bench.request(8);
    bench.chip.outputs(&[1, 0, 2]);
    bench.tick();
    assert_eq!(bench.chip.status(), 8);
    assert_eq!(bench.foe(ACK, 2, &[]).unwrap().0, DATA);
    bench.request(2);
    assert_eq!(bench.foe(ACK, 3, &[]).unwrap().0, DATA);
    bench.request(1);
    bench.request(2);
    assert_eq!(bench.foe(ACK, 4, &[]).unwrap().0, ERROR);
}

#[test]
fn a_repeated_counter_sends_no_packet_twice_and_a_repeat_request_the_same_one() {
    let mut bench = noted(&[ROOM, 3]);
    bench.foe(READ, 0, b"note.txt");
    let acknowledge = [6, 0, 0, 0, 0, 0x74, ACK, 0, 1, 0, 0, 0];
    bench.chip.send(&acknowledge);
    bench.poll();
    let second = bench.chip.receive().unwrap();
    bench.chip.send(&acknowledge);
    bench.poll();
    assert_eq!(bench.chip.receive(), None);
    bench.chip.toggle_repeat();
    bench.poll();
    assert_eq!(bench.chip.receive(), Some(second));
}

proptest! {
    #[test]
    fn any_file_comes_back_as_it_was_written_at_any_mailbox_size(
        mailbox in 36..=128_u16,
        text in "[a-z\n]{0,128}",
    ) {
        let mut bench = Bench::preop_with(configuration(), mailbox);
        bench.write_file("note.txt", text.as_bytes()).unwrap();
        prop_assert_eq!(bench.read_file("note.txt").unwrap(), text.as_bytes());
    }
}
