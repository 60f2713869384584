//! States, their transitions, and the AL status codes.

use slave::Configuration;
use wire::al::{AlState, AlStatusCode};
use wire::register as reg;

use crate::workbench::{Bench, MILLISECOND, configuration};

fn bench_in(state: AlState) -> Bench {
    match state {
        AlState::Init => {
            let mut bench = Bench::new();
            bench.set_mailboxes(128);
            bench
        }
        AlState::PreOp => {
            let mut bench = Bench::preop();
            bench.set_process_data(3, 6);
            bench
        }
        AlState::SafeOp => {
            let mut bench = Bench::safeop();
            bench.chip.outputs(&[1, 0, 2]);
            bench
        }
        AlState::Op => Bench::op(),
        AlState::Boot => unreachable!("the stack has no bootstrap state"),
    }
}

/// What the standard's matrix says of a request in a state without a pending error: AL status and code.
fn expected(from: AlState, requested: u16) -> (u16, u16) {
    use AlState::{Init, Op, PreOp, SafeOp};
    let refused = |code: u16| (u16::from(from.code()) | 0x10, code);
    match (from, requested) {
        (_, 1) => (1, 0),
        (Init | PreOp | SafeOp | Op, 2) => (2, 0),
        (Init, 3) => refused(0x13),
        (_, 3) => refused(0x11),
        (PreOp | SafeOp | Op, 4) => (4, 0),
        (SafeOp | Op, 8) => (8, 0),
        (_, 4 | 8) => refused(0x11),
        _ => refused(0x12),
    }
}

const STATES: [AlState; 4] = [AlState::Init, AlState::PreOp, AlState::SafeOp, AlState::Op];

#[test]
fn every_request_in_every_state_gives_the_standards_answer() {
    for from in STATES {
        for requested in 0..16 {
            for acknowledge in [0, 0x10] {
                let mut bench = bench_in(from);
                let answer = bench.request(requested | acknowledge);
                assert_eq!(answer, expected(from, requested), "{from:?} <- {:02X}", requested | acknowledge);
                assert_eq!(u16::from(bench.slave.state().code()), answer.0 & 0x0F);
            }
        }
    }
}

#[test]
fn with_a_pending_error_only_init_and_acknowledged_requests_count() {
    for from in STATES {
        for requested in 0..16 {
            let mut bench = bench_in(from);
            let error = bench.request(0x0F);
            assert_eq!(error, (u16::from(from.code()) | 0x10, 0x12));
            let ignored = if requested == 1 { (1, 0) } else { error };
            assert_eq!(bench.request(requested), ignored, "{from:?} <- {requested:02X} without acknowledge");

            let mut bench = bench_in(from);
            bench.request(0x0F);
            assert_eq!(
                bench.request(requested | 0x10),
                expected(from, requested),
                "{from:?} <- {requested:02X} acknowledged"
            );
        }
    }
}

#[test]
fn an_error_is_acknowledged_by_the_present_status_as_igh_does() {
    for from in STATES {
        let mut bench = bench_in(from);
        let (status, _) = bench.request(0x07);
        assert_eq!(bench.request(status), (u16::from(from.code()), 0));
    }
}

#[test]
fn transitions_complete_in_the_poll_that_sees_the_request() {
    let mut bench = bench_in(AlState::Init);
    assert_eq!(bench.request(2), (2, 0));
    bench.set_process_data(3, 6);
    assert_eq!(bench.request(4), (4, 0));
    assert!(bench.chip.inputs().is_some(), "inputs are there as soon as SAFEOP is");
}

#[test]
fn mailbox_sync_managers_are_checked() {
    type Setup = fn(&mut Bench);
    let bad: [(&str, Setup); 13] = [
        ("too short", |bench| bench.chip.set_sm(0, 0x1000, 35, 0x26, 1)),
        ("too long", |bench| bench.chip.set_sm(0, 0x1000, 129, 0x26, 1)),
        ("answer too short", |bench| bench.chip.set_sm(1, 0x1080, 35, 0x22, 1)),
        ("answer too long", |bench| bench.chip.set_sm(1, 0x1060, 129, 0x22, 1)),
        ("disabled", |bench| bench.chip.set_sm(0, 0x1000, 128, 0x26, 0)),
        ("answer disabled", |bench| bench.chip.set_sm(1, 0x1080, 128, 0x22, 0)),
        ("direction", |bench| bench.chip.set_sm(0, 0x1000, 128, 0x22, 1)),
        ("answer direction", |bench| bench.chip.set_sm(1, 0x1080, 128, 0x26, 1)),
        ("three buffers", |bench| bench.chip.set_sm(0, 0x1000, 128, 0x24, 1)),
        ("below the window", |bench| bench.chip.set_sm(0, 0x0F80, 128, 0x26, 1)),
        ("beyond the window", |bench| bench.chip.set_sm(1, 0x1081, 128, 0x22, 1)),
        ("at the end of memory", |bench| bench.chip.set_sm(1, 0xFFFF, 128, 0x22, 1)),
        ("overlap", |bench| bench.chip.set_sm(1, 0x107F, 128, 0x22, 1)),
    ];
    for (what, setup) in bad {
        let mut bench = Bench::new();
        bench.set_mailboxes(128);
        setup(&mut bench);
        assert_eq!(bench.request(2), (0x11, 0x16), "{what}");

        let mut bench = Bench::preop();
        setup(&mut bench);
        bench.tick();
        assert_eq!((bench.chip.status(), bench.chip.code()), (0x11, 0x16), "{what}, while running");
    }
    for length in [36, 64, 127, 128] {
        Bench::preop_with(configuration(), length);
    }
}

#[test]
fn process_data_sync_managers_are_checked() {
    type Setup = fn(&mut Bench);
    let bad: [(&str, Setup, u16); 18] = [
        ("outputs too short", |bench| bench.set_process_data(2, 6), 0x1D),
        ("outputs too long", |bench| bench.set_process_data(4, 6), 0x1D),
        ("inputs too short", |bench| bench.set_process_data(3, 5), 0x1E),
        ("inputs too long", |bench| bench.set_process_data(3, 7), 0x1E),
        ("both wrong: inputs go first", |bench| bench.set_process_data(4, 7), 0x1E),
        ("no outputs", |bench| bench.set_process_data(0, 6), 0x1D),
        ("no inputs", |bench| bench.set_process_data(3, 0), 0x1E),
        ("outputs off", |bench| bench.chip.set_sm(2, 0x1100, 3, 0x64, 0), 0x1D),
        ("inputs off", |bench| bench.chip.set_sm(3, 0x1400, 6, 0x20, 0), 0x1E),
        ("outputs read", |bench| bench.chip.set_sm(2, 0x1100, 3, 0x60, 1), 0x1D),
        ("inputs written", |bench| bench.chip.set_sm(3, 0x1400, 6, 0x24, 1), 0x1E),
        ("outputs of no mode", |bench| bench.chip.set_sm(2, 0x1100, 3, 0x65, 1), 0x1D),
        ("outputs below the window", |bench| bench.chip.set_sm(2, 0x0FF0, 3, 0x64, 1), 0x1D),
        ("inputs beyond the memory", |bench| bench.chip.set_sm(3, 0x2FEF, 6, 0x20, 1), 0x1E),
        ("outputs on the mailbox", |bench| bench.chip.set_sm(2, 0x10FD, 3, 0x64, 1), 0x1D),
        ("inputs on the mailbox", |bench| bench.chip.set_sm(3, 0x10FF, 6, 0x20, 1), 0x1E),
        (
            "inputs on a buffer of the outputs",
            |bench| bench.chip.set_sm(3, 0x1108, 6, 0x20, 1),
            0x1E,
        ),
        (
            "watchdog without time",
            |bench| bench.chip.set(reg::PROCESS_WATCHDOG_TIME, &[0, 0]),
            0x1F,
        ),
    ];
    for (what, setup, code) in bad {
        let mut bench = Bench::preop();
        bench.set_process_data(3, 6);
        setup(&mut bench);
        assert_eq!(bench.request(4), (0x12, code), "{what}");
        if code != 0x1F {
            let mut bench = Bench::safeop();
            setup(&mut bench);
            bench.tick();
            assert_eq!((bench.chip.status(), bench.chip.code()), (0x12, code), "{what}, while running");
        }
    }
    for (start, fits) in [(0x1109, true), (0x2FEE, true)] {
        let mut bench = Bench::preop();
        bench.set_process_data(3, 6);
        bench.chip.set_sm(3, start, 6, 0x20, 1);
        assert_eq!(bench.request(4) == (4, 0), fits, "inputs at {start:04X}");
    }
}

#[test]
fn interrupt_and_watchdog_bits_of_the_outputs_are_the_masters_choice() {
    for control in [0x04, 0x24, 0x44, 0x64, 0x74] {
        let mut bench = Bench::preop();
        bench.set_process_data(3, 6);
        bench.chip.set_sm(2, 0x1100, 3, control, 1);
        assert_eq!(bench.request(4), (4, 0), "{control:02X}");
    }
}

#[test]
fn a_moved_sync_manager_ends_safeop_and_an_identical_one_does_not() {
    let mut bench = Bench::op();
    bench.set_process_data(3, 6);
    bench.set_mailboxes(128);
    bench.tick();
    assert_eq!(bench.chip.status(), 8);
    bench.chip.set_sm(2, 0x1200, 3, 0x64, 1);
    bench.tick();
    assert_eq!((bench.chip.status(), bench.chip.code()), (0x12, 0x1D));
}

#[test]
fn a_master_that_starts_again_finds_the_device_ready() {
    for state in STATES {
        let mut bench = bench_in(state);
        bench.chip.set_sync_unit(3, 1_000_000, 0);
        bench.chip.sync0();
        // ethercrab requests INIT and clears the sync managers right behind.
        bench.chip.request(0x11);
        bench.tick();
        bench.chip.clear_sms();
        bench.tick();
        assert_eq!((bench.chip.status(), bench.chip.code()), (1, 0), "{state:?}");
        bench.chip.set_sync_unit(0, 0, 0);
        bench.set_mailboxes(128);
        assert_eq!(bench.request(0x12), (2, 0));
        bench.set_process_data(3, 6);
        assert_eq!(bench.request(4), (4, 0));
        bench.request(8);
        assert!(bench.chip.outputs(&[5, 0, 0]));
        bench.tick();
        assert_eq!(bench.chip.status(), 8);
    }
}

#[test]
fn init_and_clearing_in_the_same_poll_is_a_request_for_init() {
    let mut bench = Bench::op();
    bench.chip.request(0x11);
    bench.chip.clear_sms();
    bench.tick();
    assert_eq!((bench.chip.status(), bench.chip.code()), (1, 0));
    assert!(bench.chip.history.iter().all(|status| status & 0x10 == 0));
}

#[test]
fn a_wait_for_op_ends_before_the_masters_time_out() {
    let mut bench = Bench::safeop();
    bench.request(8);
    bench.advance(8_949 * MILLISECOND);
    assert_eq!(bench.chip.status(), 4);
    // Asking again does not start the wait anew.
    bench.request(8);
    bench.advance(MILLISECOND);
    assert_eq!((bench.chip.status(), bench.chip.code()), (0x14, 0x1B));
    bench.request(0x14);
    bench.request(8);
    bench.chip.outputs(&[0; 3]);
    assert_eq!(bench.tick().state, AlState::Op);
}

#[test]
fn a_wait_for_op_can_be_called_off() {
    let mut bench = Bench::safeop();
    bench.request(8);
    assert_eq!(bench.request(4), (4, 0));
    bench.chip.outputs(&[0; 3]);
    assert_eq!(bench.tick().state, AlState::SafeOp);
}

#[test]
fn outputs_before_the_request_count_as_long_as_they_are_recent() {
    let mut bench = Bench::safeop();
    bench.chip.outputs(&[0; 3]);
    bench.tick();
    assert_eq!(bench.request(8).0, 8);

    let mut bench = Bench::safeop();
    bench.chip.outputs(&[0; 3]);
    bench.tick();
    bench.chip.expire_watchdog();
    bench.tick();
    assert_eq!(bench.request(8).0, 4);
    bench.chip.outputs(&[0; 3]);
    assert_eq!(bench.tick().state, AlState::Op);
}

#[test]
fn outputs_of_preop_do_not_count() {
    let mut bench = Bench::preop();
    bench.set_process_data(3, 6);
    bench.chip.outputs(&[9, 0, 9]);
    bench.request(4);
    assert_eq!(bench.request(8).0, 4);
}

#[test]
fn an_expired_watchdog_ends_op_and_shuts_the_outputs_until_acknowledged() {
    let mut bench = Bench::op();
    bench.chip.expire_watchdog();
    let report = bench.tick();
    assert_eq!(
        (report.state, report.error, report.status_code),
        (AlState::SafeOp, true, AlStatusCode::SyncManagerWatchdog)
    );
    assert_eq!((bench.chip.status(), bench.chip.code()), (0x14, 0x1B));
    assert!(!bench.chip.outputs(&[1, 0, 1]), "the working counter drops");
    bench.lamp.objects.status = 0x4321;
    bench.advance(MILLISECOND);
    assert_eq!(bench.chip.inputs().unwrap()[..2], [0x21, 0x43], "inputs go on");

    assert_eq!(bench.request(8), (0x14, 0x1B), "ignored without acknowledge");
    assert_eq!(bench.request(0x14), (4, 0));
    assert_eq!(bench.request(8).0, 4, "new outputs must come first");
    assert!(bench.chip.outputs(&[1, 0, 1]));
    assert_eq!(bench.tick().state, AlState::Op);
}

#[test]
fn outputs_that_do_not_trigger_the_watchdog_are_not_watched() {
    let mut bench = Bench::preop();
    bench.set_process_data(3, 6);
    bench.chip.set_sm(2, 0x1100, 3, 0x24, 1);
    bench.request(4);
    bench.request(8);
    bench.chip.outputs(&[0; 3]);
    assert_eq!(bench.tick().state, AlState::Op);
    bench.chip.expire_watchdog();
    assert_eq!(bench.tick().state, AlState::Op);
}

#[test]
fn a_device_without_outputs_enters_op_at_once() {
    let mut bench = Bench::preop_with(
        Configuration {
            rx_assignment: &[],
            ..configuration()
        },
        128,
    );
    bench.set_process_data(0, 6);
    assert_eq!(bench.request(4), (4, 0));
    assert_eq!(bench.request(8), (8, 0));
}

#[test]
fn mappings_that_make_up_no_image_are_refused() {
    const WIDE: &[u32] = &[0x0000_00FF; 12];
    for (mapping, code) in [
        ((0x1600, &[0x2FFF_0010_u32][..]), 0x25),
        ((0x1600, &[0x6041_0010]), 0x25),
        ((0x1600, WIDE), 0x25),
        ((0x1A00, &[0x2000_0008]), 0x24),
        ((0x1A00, &[0x6502_0020]), 0x24),
    ] {
        let mappings: &'static [(u16, &'static [u32])] = Box::leak(Box::new([mapping]));
        let mut bench = Bench::preop_with(
            Configuration {
                mappings,
                ..configuration()
            },
            128,
        );
        bench.set_process_data(3, 6);
        assert_eq!(bench.request(4), (0x12, code), "{mapping:08X?}");
    }
    for (rx, tx, code) in [
        (&[0x1600, 0x1600][..], &[][..], 0x25),
        (&[], &[0x1A03], 0x24),
        (&[0x1A00], &[], 0x25),
    ] {
        let mut bench = Bench::preop_with(
            Configuration {
                rx_assignment: rx,
                tx_assignment: tx,
                ..configuration()
            },
            128,
        );
        bench.set_process_data(3, 6);
        assert_eq!(bench.request(4), (0x12, code), "{rx:04X?} {tx:04X?}");
    }
}

#[test]
fn a_broken_set_up_found_by_a_request_falls_as_far_as_it_is_broken() {
    // Requests and changes of sync managers are seen in one poll; the request goes first.
    for (index, from, status, code) in [(0, 4, 0x11, 0x16), (1, 8, 0x11, 0x16), (2, 8, 0x12, 0x1D), (3, 8, 0x12, 0x1E)] {
        let mut bench = if from == 4 { Bench::preop() } else { Bench::safeop() };
        bench.set_process_data(3, 6);
        bench.chip.set_sm(index, 0, 0, 0, 0);
        assert_eq!(bench.request(from), (status, code), "sync manager {index}");
    }
}
