//! Free run, sync manager, SYNC0 and SYNC1.

use slave::Sync;
use wire::al::AlState;
use wire::{AlEvents, EscAccess};

use crate::workbench::{Bench, MILLISECOND};

#[test]
fn set_ups_of_the_sync_unit_are_followed_or_refused_with_a_clear_code() {
    const SYNC0: u32 = 1_000_000;
    for (what, activation, cycle0, cycle1, answer) in [
        ("off", 0x00, SYNC0, 0, (4, 0)),
        ("signals without operation", 0x06, SYNC0, 0, (4, 0)),
        ("SYNC0", 0x03, SYNC0, 0, (4, 0)),
        ("SYNC0 by start time", 0x0A, SYNC0, 0, (4, 0)),
        ("shortest cycle", 0x03, 500_000, 0, (4, 0)),
        ("shorter than that", 0x03, 499_999, 0, (0x12, 0x36)),
        ("single shot", 0x03, 0, 0, (0x12, 0x36)),
        ("no signal", 0x01, SYNC0, 0, (0x12, 0x30)),
        ("SYNC1 alone", 0x05, SYNC0, 0, (0x12, 0x30)),
        ("SYNC1 with SYNC0", 0x07, SYNC0, 0, (4, 0)),
        ("SYNC1 after SYNC0", 0x07, SYNC0, 250_000, (4, 0)),
        ("SYNC1 longer than SYNC0", 0x07, SYNC0, 4_000_000, (0x12, 0x30)),
    ] {
        let mut bench = Bench::preop();
        bench.set_process_data(3, 6);
        bench.chip.set_sync_unit(activation, cycle0, cycle1);
        assert_eq!(bench.request(4), answer, "{what}");
    }
}

#[test]
fn the_masters_choice_must_fit_the_sync_unit() {
    for (outputs, inputs, activation, answer) in [
        (Some(0), None, 0, (4, 0)),
        (Some(1), None, 0, (4, 0)),
        (Some(2), None, 0, (0x12, 0x30)),
        (None, Some(2), 0, (0x12, 0x30)),
        (Some(2), Some(2), 3, (4, 0)),
        (None, Some(3), 3, (0x12, 0x30)),
        (None, Some(3), 7, (4, 0)),
        (Some(1), Some(0x22), 3, (4, 0)),
    ] {
        let mut bench = Bench::preop();
        bench.set_process_data(3, 6);
        bench.chip.set_sync_unit(activation, 1_000_000, 0);
        for (index, kind) in [(0x1C32, outputs), (0x1C33, inputs)] {
            if let Some(kind) = kind {
                bench.download(index, 1, &[kind, 0]).unwrap();
            }
        }
        assert_eq!(bench.request(4), answer, "{outputs:?} {inputs:?} {activation:02X}");
        if answer.0 == 0x12 {
            // The next master need not know of it.
            bench.request(0x11);
            bench.request(0x12);
            assert_eq!(bench.request(4), (4, 0));
        }
    }
}

#[test]
fn free_run_needs_three_buffers() {
    let mut bench = Bench::preop();
    bench.chip.set_sm(2, 0x1100, 3, 0x66, 1);
    bench.chip.set_sm(3, 0x1400, 6, 0x20, 1);
    bench.download(0x1C32, 1, &[0, 0]).unwrap();
    assert_eq!(bench.request(4), (0x12, 0x29));
    bench.download(0x1C32, 1, &[1, 0]).unwrap();
    assert_eq!(bench.request(0x14), (4, 0));
}

#[test]
fn sync_types_and_cycles_are_shown() {
    let shown = |bench: &mut Bench| [0x1C32, 0x1C33].map(|index| bench.upload(index, 1).unwrap()[0]);
    let mut bench = Bench::op();
    assert_eq!(shown(&mut bench), [1, 0x22]);
    for _ in 0..3 {
        bench.advance(2 * MILLISECOND);
        bench.chip.outputs(&[0; 3]);
        bench.tick();
    }
    assert_eq!(bench.upload(0x1C32, 2).unwrap(), 2_000_000_u32.to_le_bytes());
    let mut bench = Bench::op_with_sync0();
    assert_eq!(shown(&mut bench), [2, 2]);
    assert_eq!(bench.upload(0x1C33, 2).unwrap(), 1_000_000_u32.to_le_bytes());
    let mut bench = Bench::preop();
    bench.set_process_data(3, 6);
    bench.chip.set_sync_unit(7, 1_000_000, 0);
    bench.request(4);
    assert_eq!(shown(&mut bench), [2, 3]);
}

#[test]
fn with_the_sync_manager_outputs_take_effect_when_they_come_and_the_cycle_is_measured() {
    let mut bench = Bench::op();
    bench.lamp.objects.status = 0xBEEF;
    bench.now += MILLISECOND / 4;
    bench.chip.outputs(&[8, 0, 9]);
    let report = bench.tick();
    assert_eq!(
        report.sync,
        Some(Sync {
            cycle: Some(250_000),
            fresh: true
        })
    );
    assert_eq!(bench.lamp.objects.brightness, 8);
    assert_eq!(bench.chip.inputs().unwrap()[..2], [0xEF, 0xBE], "inputs follow the same event");
    assert_eq!(bench.advance(MILLISECOND / 4).sync, None);
}

#[test]
fn with_sync0_outputs_wait_for_it_and_inputs_follow_it() {
    let mut bench = Bench::op_with_sync0();
    bench.now += MILLISECOND / 2;
    bench.chip.outputs(&[33, 0, 44]);
    assert_eq!(bench.tick().sync, None);
    assert_ne!(bench.lamp.objects.brightness, 33);
    bench.lamp.objects.status = 0xCAFE;
    bench.tick();
    assert_ne!(bench.chip.inputs().unwrap()[..2], [0xFE, 0xCA], "not before SYNC0");
    bench.now += MILLISECOND / 2;
    bench.chip.sync0();
    assert_eq!(
        bench.tick().sync,
        Some(Sync {
            cycle: Some(1_000_000),
            fresh: true
        })
    );
    assert_eq!(bench.lamp.objects.brightness, 33);
    assert_eq!(bench.chip.inputs().unwrap()[..2], [0xFE, 0xCA]);
    // A cycle without outputs is one too.
    bench.now += MILLISECOND;
    bench.chip.sync0();
    assert_eq!(
        bench.tick().sync,
        Some(Sync {
            cycle: Some(1_000_000),
            fresh: false
        })
    );
}

fn number(bench: &mut Bench, index: u16, sub: u8) -> u32 {
    let mut bytes = bench.upload(index, sub).unwrap();
    bytes.resize(4, 0);
    u32::from_le_bytes(bytes.try_into().unwrap())
}

/// Calc and copy time, and delay time.
fn times(bench: &mut Bench, index: u16) -> [u32; 2] {
    [6, 9].map(|sub| number(bench, index, sub))
}

#[test]
fn with_sync0_the_longest_times_from_it_are_measured_on_request() {
    let mut bench = Bench::op_with_sync0();
    let cycle = |bench: &mut Bench, waited| {
        bench.now += MILLISECOND;
        bench.chip.outputs(&[1, 0, 2]);
        bench.chip.sync0_ago(waited, MILLISECOND);
        bench.poll();
        // The inputs follow with the next tick.
        bench.advance(3_000);
    };
    cycle(&mut bench, 40_000);
    assert_eq!(times(&mut bench, 0x1C32), [50_000, 50_000], "stated until measured");
    assert_eq!(times(&mut bench, 0x1C33), [50_000, 0]);
    for index in [0x1C32, 0x1C33] {
        bench.download(index, 8, &[1, 0]).unwrap();
    }
    assert_eq!((times(&mut bench, 0x1C32), times(&mut bench, 0x1C33)), ([50_000, 0], [0, 0]));
    for waited in [20_000, 35_000, 10_000] {
        cycle(&mut bench, waited);
    }
    assert_eq!(times(&mut bench, 0x1C32), [50_000, 35_000]);
    assert_eq!(times(&mut bench, 0x1C33), [38_000, 0]);
    // Each of the two for itself.
    bench.download(0x1C32, 8, &[0, 0]).unwrap();
    cycle(&mut bench, 60_000);
    assert_eq!((times(&mut bench, 0x1C32)[1], times(&mut bench, 0x1C33)[0]), (35_000, 63_000));
}

#[test]
fn a_pulse_between_two_readings_of_the_clock_measures_nothing() {
    let mut bench = Bench::op_with_sync0();
    bench.download(0x1C32, 8, &[1, 0]).unwrap();
    bench.now += MILLISECOND;
    bench.chip.sync0_ago(0, 2 * MILLISECOND);
    bench.tick();
    assert_eq!(times(&mut bench, 0x1C32)[1], 0);
}

#[test]
fn with_the_sync_manager_the_time_from_outputs_to_inputs_is_measured() {
    let mut bench = Bench::op();
    bench.download(0x1C33, 8, &[1, 0]).unwrap();
    for wait in [10_000, 30_000, 20_000] {
        bench.now += MILLISECOND;
        bench.chip.outputs(&[1, 0, 2]);
        bench.poll();
        bench.advance(wait);
    }
    assert_eq!(times(&mut bench, 0x1C33), [30_000, 0]);
}

#[test]
fn an_event_before_the_inputs_of_the_last_are_ready_counts_as_cycle_too_small() {
    let frame = |bench: &mut Bench| {
        bench.now += 20_000;
        bench.chip.outputs(&[1, 0, 2]);
        bench.poll();
    };
    let pulse = |bench: &mut Bench| {
        bench.now += MILLISECOND;
        bench.chip.outputs(&[1, 0, 2]);
        bench.poll();
        bench.chip.sync0();
        bench.poll();
    };
    for (mut bench, event) in [
        (Bench::op(), &frame as &dyn Fn(&mut Bench)),
        (Bench::op_with_sync0(), &pulse as &dyn Fn(&mut Bench)),
    ] {
        event(&mut bench);
        bench.tick();
        event(&mut bench);
        assert_eq!(number(&mut bench, 0x1C32, 0x0C), 0);
        event(&mut bench);
        event(&mut bench);
        assert_eq!([0x1C32, 0x1C33].map(|index| number(&mut bench, index, 0x0C)), [2, 2]);
    }
}

#[test]
fn a_sync0_that_nobody_served_counts_as_cycle_too_small() {
    let mut bench = Bench::op_with_sync0();
    bench.now += 2 * MILLISECOND;
    bench.chip.outputs(&[1, 0, 2]);
    bench.poll();
    bench.now += MILLISECOND;
    bench.chip.sync0();
    bench.tick();
    assert_eq!((bench.chip.status(), number(&mut bench, 0x1C32, 0x0C)), (8, 2));
}

#[test]
fn counters_start_anew_with_op() {
    let mut bench = Bench::op_with_sync0();
    for _ in 0..2 {
        bench.now += 2 * MILLISECOND;
        bench.chip.sync0();
        bench.tick();
    }
    assert_eq!(bench.chip.code(), 0x1A);
    assert_eq!([0x0B, 0x0C, 0x20].map(|sub| number(&mut bench, 0x1C33, sub)), [2, 2, 1]);
    bench.request(0x14);
    assert_eq!([0x0B, 0x0C, 0x20].map(|sub| number(&mut bench, 0x1C33, sub)), [2, 2, 0]);
    bench.request(8);
    bench.cycle();
    assert_eq!(bench.chip.status(), 8);
    assert_eq!([0x0B, 0x0C, 0x20].map(|sub| number(&mut bench, 0x1C33, sub)), [0, 0, 0]);
}

#[test]
fn sync_signals_are_acknowledged_in_every_mode() {
    for mut bench in [Bench::safeop(), Bench::op(), Bench::op_with_sync0()] {
        bench.chip.sync0();
        bench.chip.events |= AlEvents::SYNC1;
        bench.tick();
        assert!(!bench.chip.events().has(AlEvents::SYNC0 | AlEvents::SYNC1));
    }
}

#[test]
fn op_with_sync0_waits_for_outputs_and_sync0_in_either_order() {
    for outputs_first in [true, false] {
        let mut bench = Bench::preop();
        bench.set_process_data(3, 6);
        bench.chip.set_sync_unit(3, 1_000_000, 0);
        bench.request(4);
        bench.request(8);
        for step in 0..2 {
            assert_eq!(bench.chip.status(), 4, "step {step}");
            if (step == 0) == outputs_first {
                bench.chip.outputs(&[0; 3]);
            } else {
                bench.chip.sync0();
            }
            bench.advance(MILLISECOND / 10);
        }
        assert_eq!(bench.chip.status(), 8, "outputs first: {outputs_first}");
    }
}

#[test]
fn a_missing_sync0_and_missing_outputs_are_told_apart() {
    for (sync0, outputs, code) in [(false, false, 0x2D), (false, true, 0x2D), (true, false, 0x1B)] {
        let mut bench = Bench::preop();
        bench.set_process_data(3, 6);
        bench.chip.set_sync_unit(3, 1_000_000, 0);
        bench.request(4);
        bench.request(8);
        for _ in 0..8_950 {
            if outputs {
                bench.chip.outputs(&[0; 3]);
            }
            if sync0 {
                bench.chip.sync0();
            }
            bench.advance(MILLISECOND);
        }
        assert_eq!(
            (bench.chip.status(), bench.chip.code()),
            (0x14, code),
            "SYNC0 {sync0}, outputs {outputs}"
        );
    }
}

#[test]
fn a_sync_unit_set_up_in_safeop_is_followed_from_op_on() {
    let mut bench = Bench::safeop();
    bench.chip.set_sync_unit(3, 1_000_000, 0);
    bench.chip.outputs(&[0; 3]);
    bench.tick();
    assert_eq!(bench.request(8).0, 4, "now SYNC0 is waited for");
    bench.chip.sync0();
    assert_eq!(bench.advance(MILLISECOND).state, AlState::Op);

    let mut bench = Bench::safeop();
    bench.chip.set_sync_unit(5, 1_000_000, 0);
    assert_eq!(bench.request(8), (0x14, 0x30));
}

#[test]
fn op_ends_when_sync0_stops() {
    let mut bench = Bench::op_with_sync0();
    for _ in 0..20 {
        bench.chip.outputs(&[0; 3]);
        bench.advance(MILLISECOND / 10);
    }
    assert_eq!(bench.chip.status(), 8, "two cycles");
    bench.advance(1);
    assert_eq!((bench.chip.status(), bench.chip.code()), (0x14, 0x2C));
    assert!(!bench.chip.outputs(&[0; 3]));
    bench.request(0x14);
    assert!(bench.chip.outputs(&[0; 3]));
}

#[test]
fn op_ends_when_outputs_are_missing_before_sync0() {
    let mut bench = Bench::op_with_sync0();
    let miss = |bench: &mut Bench| {
        bench.chip.sync0();
        bench.advance(MILLISECOND);
        bench.chip.status()
    };
    assert_eq!(miss(&mut bench), 8, "one lost frame is forgiven");
    for _ in 0..3 {
        bench.cycle();
    }
    assert_eq!(miss(&mut bench), 8);
    assert_eq!(miss(&mut bench), 0x14);
    assert_eq!(bench.chip.code(), 0x1A);
    assert_eq!(bench.upload(0x1C32, 0x20).unwrap(), [1]);
    assert_eq!(bench.upload(0x1C32, 0x0B).unwrap(), [3, 0]);
    bench.request(0x14);
    assert_eq!(bench.upload(0x1C32, 0x20).unwrap(), [0]);
}

#[test]
fn the_limit_of_missing_outputs_is_10f1_02() {
    for (limit, misses) in [(1, 1), (7, 3), (0, 50)] {
        let mut bench = Bench::op_with_sync0();
        bench.download(0x10F1, 2, &[limit, 0]).unwrap();
        for _ in 0..misses - 1 {
            bench.chip.sync0();
            bench.advance(MILLISECOND);
        }
        assert_eq!(bench.chip.status(), 8, "limit {limit}");
        bench.chip.sync0();
        bench.advance(MILLISECOND);
        assert_eq!(bench.chip.status() == 0x14, limit != 0, "limit {limit}");
    }
}

#[test]
fn a_master_that_sends_single_frames_until_it_sees_op_stays_in_op() {
    let mut bench = Bench::preop();
    bench.set_process_data(3, 6);
    bench.chip.set_sync_unit(3, 1_000_000, 0);
    bench.request(4);
    bench.request(8);
    // SOEM: one frame every 50 ms or so while SYNC0 runs.
    for millisecond in 0..300 {
        if millisecond % 50 == 0 {
            bench.chip.outputs(&[0; 3]);
        }
        bench.chip.sync0();
        bench.advance(MILLISECOND);
    }
    assert_eq!(bench.chip.status(), 8);
    for _ in 0..100 {
        bench.cycle();
    }
    assert_eq!(bench.chip.status(), 8);
    // Now the cycle is known, and its end is noticed.
    for _ in 0..2 {
        bench.chip.sync0();
        bench.advance(MILLISECOND);
    }
    assert_eq!(bench.chip.code(), 0x1A);
}

#[test]
fn without_events_inputs_are_renewed_every_millisecond() {
    let mut bench = Bench::safeop();
    bench.lamp.objects.status = 1;
    bench.advance(MILLISECOND - 1);
    assert_ne!(bench.chip.inputs().unwrap()[..2], [1, 0]);
    bench.advance(1);
    assert_eq!(bench.chip.inputs().unwrap()[..2], [1, 0]);
}
