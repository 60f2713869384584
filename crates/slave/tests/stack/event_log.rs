//! What is logged, as 0x10F3 and `eventlog.txt` tell it; the device's time.

use crate::workbench::{Bench, MILLISECOND};

const HISTORY: u16 = 0x10F3;

fn read(bench: &mut Bench, sub: u8) -> u32 {
    let bytes = bench.upload(HISTORY, sub).unwrap();
    bytes.iter().rev().fold(0, |number, &byte| number << 8 | u32::from(byte))
}

/// Severity, text and time of the newest event by the file.
fn newest(bench: &mut Bench) -> (String, String, String) {
    let file = String::from_utf8(bench.read_file("eventlog.txt").unwrap()).unwrap();
    let line = file.lines().last().unwrap();
    let mut words = line.split_whitespace().skip(1).map(str::to_owned);
    let (time, severity) = (words.next().unwrap(), words.next().unwrap());
    (severity, words.collect::<Vec<_>>().join(" "), time)
}

/// Severity, diagnosis code and parameters of the newest message.
fn newest_message(bench: &mut Bench) -> (u8, u32, Vec<u16>) {
    let sub = read(bench, 2) as u8;
    let message = bench.upload(HISTORY, sub).unwrap();
    assert_eq!(message.len(), 28);
    let parameters = message[16..].chunks(4).take(message[5].into());
    (
        message[4] & 0x0F,
        u32::from_le_bytes(message[..4].try_into().unwrap()),
        parameters
            .map(|parameter| u16::from_le_bytes([parameter[2], parameter[3]]))
            .collect(),
    )
}

#[test]
fn each_kind_of_event_is_logged_with_severity_code_and_time() {
    type Case = (fn() -> Bench, fn(&mut Bench), &'static str, &'static str, u8, u32, &'static [u16]);
    let cases: [Case; 9] = [
        (Bench::preop, |_| {}, "information", "Power-on", 0, 0xE001, &[]),
        (
            Bench::preop,
            |bench| _ = bench.request(4),
            "warning",
            "Request for SAFEOP refused in PREOP, AL status code 0x001E InvalidInputConfiguration",
            1,
            0x001E_E002,
            &[4, 2, 0x1E],
        ),
        (
            Bench::op,
            |bench| {
                bench.chip.expire_watchdog();
                bench.poll();
            },
            "error",
            "OP left for SAFEOP, AL status code 0x001B SyncManagerWatchdog",
            2,
            0x001B_E003,
            &[8, 4, 0x1B],
        ),
        (
            Bench::op_with_sync0,
            |bench| _ = bench.advance(10 * MILLISECOND),
            "error",
            "OP left for SAFEOP, AL status code 0x002C FatalSyncError",
            2,
            0x002C_E003,
            &[8, 4, 0x2C],
        ),
        (
            Bench::safeop,
            |bench| {
                bench.request(8);
                bench.advance(8950 * MILLISECOND);
            },
            "warning",
            "Request for OP refused in SAFEOP, AL status code 0x001B SyncManagerWatchdog",
            1,
            0x001B_E002,
            &[8, 4, 0x1B],
        ),
        (
            Bench::preop,
            |bench| bench.lamp.fault = 0x3110,
            "error",
            "Fault 0x3110, error register 0x21",
            2,
            0x3110_E800,
            &[0x3110, 0x21],
        ),
        (
            Bench::preop,
            |bench| {
                bench.lamp.fault = 0x3110;
                bench.poll();
                bench.chip.receive();
                bench.lamp.fault = 0;
            },
            "information",
            "Fault 0x3110 cleared",
            0,
            0xE005,
            &[0x3110],
        ),
        (
            Bench::preop,
            |bench| bench.download(0x1010, 1, &[1, 0]).unwrap(),
            "information",
            "Parameters saved",
            0,
            0xE006,
            &[],
        ),
        (
            Bench::preop,
            |bench| bench.download(0x1011, 1, &[1, 0]).unwrap(),
            "information",
            "Parameters of delivery restored",
            0,
            0xE007,
            &[],
        ),
    ];
    for (start, act, severity, text, kind, code, parameters) in cases {
        let mut bench = start();
        act(&mut bench);
        bench.poll();
        bench.chip.receive();
        let time = format!("{}.{:09}", bench.now / 1_000_000_000, bench.now % 1_000_000_000);
        assert_eq!(newest(&mut bench), (severity.into(), text.into(), time), "{text}");
        assert_eq!(newest_message(&mut bench), (kind, code, parameters.to_vec()), "{text}");
    }
}

#[test]
fn what_was_refused_is_no_event() {
    let mut bench = Bench::preop();
    bench.lamp.refusal = Some(dictionary::AbortCode::CannotStore);
    bench.download(0x1010, 1, &[1, 0]).unwrap_err();
    bench.lamp.note_refusal = Some("no");
    bench.write_file("note.txt", b"").unwrap_err();
    assert_eq!(read(&mut bench, 0), 6, "power-on is the only message");
}

#[test]
fn a_new_history_has_one_message_and_others_do_not_exist() {
    let mut bench = Bench::preop();
    assert_eq!([0, 1, 2, 3, 4, 5].map(|sub| read(&mut bench, sub)), [6, 32, 6, 0, 1, 0]);
    assert_eq!(bench.upload(HISTORY, 7), Err(0x0609_0011));
    assert_eq!(bench.upload(HISTORY, 38), Err(0x0609_0011));
    assert_eq!(bench.upload_complete(HISTORY, 0), Err(0x0601_0004));
    assert_eq!(bench.download_complete(HISTORY, 0, &[0; 64]), Err(0x0601_0004));
}

/// Adds as many events.
fn add(bench: &mut Bench, count: usize) {
    for _ in 0..count {
        bench.download(0x1010, 1, &[1, 0]).unwrap();
    }
}

#[test]
fn the_oldest_message_makes_way_and_a_lost_one_shows_in_the_flags() {
    let mut bench = Bench::preop();
    add(&mut bench, 31);
    assert_eq!([0, 2, 5].map(|sub| read(&mut bench, sub)), [37, 37, 0]);
    add(&mut bench, 2);
    assert_eq!([0, 2, 5].map(|sub| read(&mut bench, sub)), [37, 7, 0x20]);
    bench.download(HISTORY, 3, &[7]).unwrap();
    add(&mut bench, 31);
    assert_eq!(
        [2, 3, 5].map(|sub| read(&mut bench, sub)),
        [6, 7, 0],
        "all that made way were acknowledged"
    );
    add(&mut bench, 1);
    assert_eq!(
        [2, 3, 5].map(|sub| read(&mut bench, sub)),
        [7, 0, 0],
        "the acknowledged message itself made way"
    );
    add(&mut bench, 1);
    assert_eq!(read(&mut bench, 5), 0x20);
}

#[test]
fn news_are_those_not_read_and_not_acknowledged() {
    let mut bench = Bench::preop();
    add(&mut bench, 2);
    assert_eq!(read(&mut bench, 4), 1);
    bench.upload(HISTORY, 7).unwrap();
    assert_eq!(read(&mut bench, 4), 1, "an older one was read");
    bench.upload(HISTORY, 8).unwrap();
    assert_eq!(read(&mut bench, 4), 0);
    add(&mut bench, 1);
    assert_eq!(read(&mut bench, 4), 1);
    bench.download(HISTORY, 3, &[9]).unwrap();
    assert_eq!([3, 4].map(|sub| read(&mut bench, sub)), [9, 0]);
    for wrong in [1, 5, 10, 255] {
        assert_eq!(bench.download(HISTORY, 3, &[wrong]), Err(0x0609_0030), "{wrong}");
    }
}

#[test]
fn writing_0_clears_history_and_file() {
    let mut bench = Bench::preop();
    add(&mut bench, 40);
    bench.download(HISTORY, 3, &[0]).unwrap();
    assert_eq!([0, 2, 3, 4, 5].map(|sub| read(&mut bench, sub)), [5, 0, 0, 0, 0]);
    let file = bench.read_file("eventlog.txt").unwrap();
    assert_eq!(file.iter().filter(|&&byte| byte == b'\n').count(), 1, "the heading");
    add(&mut bench, 1);
    assert_eq!([0, 2, 4].map(|sub| read(&mut bench, sub)), [6, 6, 1]);
}

#[test]
fn kinds_of_messages_can_be_left_out() {
    let mut bench = Bench::preop();
    for (flags, severities) in [(0x0000_u16, 3), (0x0002, 2), (0x000C, 1), (0x000E, 0)] {
        bench.download(HISTORY, 3, &[0]).unwrap();
        bench.download(HISTORY, 5, &flags.to_le_bytes()).unwrap();
        add(&mut bench, 1);
        bench.request(4);
        bench.request(0x12);
        bench.lamp.fault = 0x3110;
        bench.poll();
        bench.chip.receive();
        assert_eq!(read(&mut bench, 0), 5 + severities, "{flags:#x}");
        bench.download(HISTORY, 5, &0x000E_u16.to_le_bytes()).unwrap();
        bench.lamp.fault = 0;
        bench.poll();
        bench.chip.receive();
    }
    for flags in [0x0001_u16, 0x0010, 0x0040, 0x8000] {
        assert_eq!(bench.download(HISTORY, 5, &flags.to_le_bytes()), Err(0x0609_0030), "{flags:#x}");
    }
}

#[test]
fn whether_there_are_news_can_be_mapped() {
    let mut bench = Bench::preop();
    for (sub, value) in [(0, 0_u32), (1, 0x10F3_0401), (2, 0x0000_0007), (0, 2)] {
        let size = if sub == 0 { 1 } else { 4 };
        bench.download(0x1A00, sub, &value.to_le_bytes()[..size]).unwrap();
    }
    bench.set_process_data(3, 1);
    assert_eq!(bench.request(4), (4, 0));
    assert_eq!(bench.chip.inputs().unwrap(), [1]);
}

#[test]
fn the_log_outlasts_init() {
    let mut bench = Bench::op();
    bench.chip.expire_watchdog();
    bench.poll();
    bench.request(0x11);
    bench.request(2);
    assert_eq!(read(&mut bench, 2), 7);
}

#[test]
fn the_device_s_time_runs_in_ns_from_where_it_was_set_through_all_states() {
    let mut bench = Bench::preop();
    let time = |bench: &mut Bench| u64::from_le_bytes(bench.upload(0x10F8, 0).unwrap().try_into().unwrap());
    bench.advance(5);
    assert_eq!(time(&mut bench), 5);
    const SET: u64 = 1_700_000_000_000_000_000;
    bench.download(0x10F8, 0, &SET.to_le_bytes()).unwrap();
    assert_eq!(bench.download(0x10F8, 0, &[0; 4]), Err(0x0607_0010));
    bench.advance(MILLISECOND);
    assert_eq!(time(&mut bench), SET + MILLISECOND);
    bench.request(1);
    bench.advance(MILLISECOND);
    bench.request(2);
    bench.set_process_data(3, 6);
    assert_eq!(bench.request(4), (4, 0));
    bench.request(0x18);
    bench.chip.outputs(&[1, 0, 2]);
    bench.advance(7);
    assert_eq!((bench.chip.status(), time(&mut bench)), (8, SET + 2 * MILLISECOND + 7));
    add(&mut bench, 1);
    let (_, _, logged) = newest(&mut bench);
    assert_eq!(logged, "1700000000.002000007");
}
