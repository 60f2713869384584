//! The touch probes (manual 2.3.17 to 2.3.22, 2.4.5).

mod rig;

use board::{Nanos, TICK};
use dictionary::AbortCode;
use proptest::prelude::*;
use rig::Rig;

const IN1: u8 = 1;
const IN2: u8 = 2;
const SUB_PULSES_PER_PULSE: f64 = 4e8;

/// A drive that runs at `speed` pulses/s, with IN1 as `function`, 7 or 8.
fn running(speed: i32, function: u16) -> Rig {
    let mut rig = Rig::enabled(3);
    rig.objects.input_1_function = function;
    rig.objects.target_velocity = speed;
    rig.objects.profile_acceleration = i32::MAX;
    rig.until("at speed", |rig| rig.pulses_per_second() == speed);
    rig
}

/// The latched positions of one probe, rising and falling edge, and their counts.
fn latched(rig: &Rig, probe: usize) -> ([i32; 2], [u16; 2]) {
    let objects = &rig.objects;
    if probe == 0 {
        (
            [objects.probe_1_positive as i32, objects.probe_1_negative as i32],
            [objects.probe_1_positive_count, objects.probe_1_negative_count],
        )
    } else {
        (
            [objects.probe_2_positive as i32, objects.probe_2_negative as i32],
            [objects.probe_2_positive_count, objects.probe_2_negative_count],
        )
    }
}

enum Change {
    Function(u16),
    Signal(bool),
}
use Change::{Function, Signal};

/// Step of the manual's table, what changes, what 0x60B9 then shows, and which edge's position is latched.
const STEPS: [(&str, Change, u16, Option<usize>); 11] = [
    ("1, 2", Function(0x31), 0b001, None),
    ("3 to 4a", Signal(true), 0b011, Some(0)),
    ("5 to 6a", Signal(false), 0b111, Some(1)),
    ("a second rising edge", Signal(true), 0b111, None),
    ("a second falling edge", Signal(false), 0b111, None),
    ("7 to 8a", Function(0x21), 0b101, None),
    ("9, 10", Function(0x31), 0b101, None),
    ("11 to 12a", Signal(true), 0b111, Some(0)),
    ("13 to 14a", Function(0x30), 0b000, None),
    ("disabled, falling", Signal(false), 0b000, None),
    ("disabled, rising", Signal(true), 0b000, None),
];

// manual: 2.3.17/probe-1 2.3.17/probe-2 2.3.17/edges 2.3.18/probe-1 2.3.18/probe-2 2.3.19/position 2.3.20/position
// manual: 2.3.21/position 2.3.22/position 2.4.5/1-2 2.4.5/3-4a 2.4.5/5-6a 2.4.5/7-8a 2.4.5/9-10 2.4.5/11-12a 2.4.5/13-14a
#[test]
fn the_fourteen_steps_of_the_manual_with_each_probe_in_both_directions() {
    for (probe, speed) in [(0, 10_000), (1, 10_000), (0, -10_000), (1, -10_000)] {
        let mut rig = running(speed, 7 + probe as u16);
        let (mut positions, mut counts) = ([0; 2], [0; 2]);
        for (step, change, status, edge) in &STEPS {
            match change {
                Function(function) => rig.objects.probe_function = function << (8 * probe),
                Signal(on) => rig.inputs = u8::from(*on) * IN1,
            }
            rig.tick();
            if let Some(edge) = *edge {
                positions[edge] = rig.objects.position;
                counts[edge] += 1;
            }
            for _ in 0..20 {
                assert_eq!(rig.objects.probe_status, status << (8 * probe), "probe {probe}, step {step}");
                assert_eq!(latched(&rig, probe), (positions, counts), "probe {probe}, step {step}");
                assert_eq!(latched(&rig, 1 - probe), Default::default(), "the other probe, step {step}");
                rig.tick();
            }
        }
    }
}

// manual: 2.2.7/probe-1 2.2.7/probe-2 2.4.5/settings
#[test]
fn both_probes_latch_each_its_own_input() {
    let mut rig = running(10_000, 7);
    rig.objects.input_2_function = 8;
    rig.objects.probe_function = 0x1131;
    rig.ticks(10);
    rig.inputs = IN2;
    rig.tick();
    assert_eq!(rig.objects.probe_status, 0x0301);
    let second = rig.objects.position;
    rig.ticks(10);
    rig.inputs = IN1 | IN2;
    rig.tick();
    let first = rig.objects.position;
    rig.inputs = 0;
    rig.tick();
    assert_eq!(rig.objects.probe_status, 0x0307, "falling edges of probe 2 are not asked for");
    assert_eq!(latched(&rig, 0), ([first, rig.objects.position], [1, 1]));
    assert_eq!(latched(&rig, 1), ([second, 0], [1, 0]));
}

#[test]
fn a_level_that_is_there_already_is_no_edge() {
    for ticks_before in [20, 1, 0] {
        let mut rig = running(10_000, 7);
        rig.inputs = IN1;
        rig.ticks(ticks_before);
        rig.objects.probe_function = 0x31;
        rig.ticks(20);
        assert_eq!(rig.objects.probe_status, 1, "on for {ticks_before} ticks");
        rig.inputs = 0;
        rig.tick();
        assert_eq!(rig.objects.probe_status, 0b101);
        rig.inputs = IN1;
        rig.tick();
        assert_eq!(rig.objects.probe_status, 0b111);
    }
}

// manual: 2.4.5/settings
#[test]
fn polarity_decides_what_rises_and_writing_it_is_no_edge() {
    let mut rig = running(10_000, 7);
    rig.objects.probe_function = 0x31;
    rig.ticks(2);
    rig.objects.input_polarity = 0x3E;
    rig.ticks(2);
    assert_eq!(rig.objects.probe_status, 1);
    rig.inputs = IN1;
    rig.tick();
    assert_eq!(
        rig.objects.probe_status, 0b101,
        "current is what a normally closed input falls with"
    );
    rig.inputs = 0;
    rig.tick();
    assert_eq!(rig.objects.probe_status, 0b111);
    rig.objects.input_1_function = 0;
    rig.objects.probe_function = 0;
    rig.tick();
    rig.objects.probe_function = 0x31;
    rig.ticks(2);
    rig.objects.input_1_function = 7;
    rig.ticks(2);
    assert_eq!(rig.objects.probe_status, 1, "nor is giving the function to an input that is valid");
}

#[test]
fn inputs_of_one_probe_rise_with_the_first_and_fall_with_the_last() {
    let mut rig = running(100_000, 7);
    rig.objects.input_2_function = 7;
    rig.objects.probe_function = 0x31;
    rig.ticks(2);
    // Both in one tick: of the five pulses, the first input's edge lies four back, the second's one.
    rig.inputs = IN1 | IN2;
    rig.level_ages[0] = Nanos(40_000);
    rig.level_ages[1] = Nanos(10_000);
    rig.tick();
    assert_eq!(latched(&rig, 0).0[0], rig.objects.position - 4);
    rig.inputs = IN2;
    rig.tick();
    assert_eq!(rig.objects.probe_status, 0b011, "the other input still holds the signal");
    rig.inputs = IN1 | IN2;
    rig.tick();
    rig.inputs = 0;
    rig.tick();
    assert_eq!(latched(&rig, 0).0[1], rig.objects.position - 1);
    assert_eq!(latched(&rig, 0).1, [1, 1]);
}

// manual: 2.3.17/reserved
#[test]
fn bit_1_of_the_first_step_is_reserved_and_changes_nothing() {
    let mut rig = running(10_000, 7);
    rig.objects.probe_function = 0x13;
    rig.tick();
    for _ in 0..3 {
        rig.inputs = IN1;
        rig.tick();
        assert_eq!((latched(&rig, 0).1, rig.objects.probe_status), ([1, 0], 0b011));
        rig.inputs = 0;
        rig.ticks(5);
    }
}

// manual: 2.3.17/reserved
#[test]
fn functions_that_the_probes_do_not_have_are_refused_by_sdo_and_ignored_by_pdo() {
    let mut rig = running(10_000, 7);
    for bit in 0..16 {
        let expected = if [0, 1, 4, 5, 8, 9, 12, 13].contains(&bit) {
            Ok(())
        } else {
            Err(AbortCode::ValueRange)
        };
        assert_eq!(rig.download(0x60B8, 0, &(1_u16 << bit).to_le_bytes()), expected, "bit {bit}");
    }
    rig.objects.probe_function = 0xCCDD;
    rig.tick();
    rig.inputs = IN1;
    rig.tick();
    assert_eq!(rig.objects.probe_status, 0b011);
}

#[test]
fn the_filter_delays_what_is_shown_but_not_what_is_latched() {
    let mut rig = running(100_000, 7);
    rig.objects.input_filter = 60;
    rig.objects.probe_function = 0x31;
    rig.ticks(2);
    // A pulse that the filter rejects.
    rig.inputs = IN1;
    rig.ticks(60);
    rig.inputs = 0;
    rig.ticks(100);
    assert_eq!(rig.objects.probe_status, 1);
    rig.inputs = IN1;
    rig.level_ages[0] = Nanos(30_000);
    rig.tick();
    let at = rig.objects.position - 3;
    rig.level_ages[0] = Nanos(0);
    rig.ticks(59);
    assert_eq!(rig.objects.probe_status, 1, "not yet for 3 ms");
    rig.tick();
    assert_eq!(rig.objects.probe_status, 0b011);
    assert_eq!(latched(&rig, 0), ([at, 0], [1, 0]));
}

#[test]
fn an_origin_that_moves_under_a_waiting_edge_moves_it_and_what_was_shown_stays() {
    let mut rig = Rig::enabled(1);
    rig.objects.input_1_function = 7;
    rig.objects.probe_function = 0x31;
    rig.objects.target_position = 1_237;
    rig.command(0x1F);
    rig.until("half way", |rig| rig.objects.position >= 700);
    rig.objects.input_filter = 60_000;
    rig.inputs = IN1;
    rig.tick();
    let at = rig.objects.position;
    rig.until("there", |rig| rig.status(10));
    rig.download(0x2010, 0, &[1, 0]).unwrap();
    rig.until("latched", |rig| rig.objects.probe_status == 0b011);
    assert_eq!((rig.objects.position, latched(&rig, 0).0), (0, [at - 1_237, 0]));
    rig.objects.target_position = 100;
    rig.command(0x0F);
    rig.command(0x1F);
    rig.ticks(2);
    rig.until("there", |rig| rig.status(10));
    rig.download(0x2010, 0, &[1, 0]).unwrap();
    rig.ticks(2);
    assert_eq!(latched(&rig, 0).0, [at - 1_237, 0]);
}

#[test]
fn the_longest_filter_at_the_greatest_speed_still_latches_the_pulse() {
    for (speed, direction) in [(i32::MAX, 1), (i32::MIN + 1, -1)] {
        let mut rig = running(speed, 7);
        rig.objects.input_filter = u16::MAX;
        rig.objects.probe_function = 0x31;
        rig.ticks(2);
        rig.inputs = IN1;
        rig.tick();
        let at = rig.objects.position;
        rig.ticks(65_535);
        assert_eq!(latched(&rig, 0).0[0], at, "direction {direction}");
    }
}

/// A stretch of time with a steady level: ticks, and how long before its first tick it began.
fn stretch() -> impl Strategy<Value = (usize, u64)> {
    (1_usize..120, 0..=TICK.0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn positions_are_those_of_the_edges_whatever_speed_and_filter(
        speeds in prop::array::uniform3(-400_000_i32..=400_000),
        acceleration in 10_000_i32..10_000_000,
        filter in 0_u16..80,
        stretches in prop::collection::vec(stretch(), 1..40),
    ) {
        let mut rig = running(speeds[0], 7);
        rig.objects.input_filter = filter;
        rig.objects.profile_acceleration = acceleration;
        rig.objects.profile_deceleration = acceleration;
        rig.objects.probe_function = 0x31;
        rig.ticks(1);
        let (mut steady, mut counts, mut level) = (false, [0; 2], false);
        for (number, &(ticks, age)) in stretches.iter().enumerate() {
            level = !level;
            rig.objects.target_velocity = speeds[number % 3];
            rig.inputs = u8::from(level) * IN1;
            rig.level_ages[0] = Nanos(age);
            let before = rig.drive.position().sub_pulses() as f64;
            rig.tick();
            rig.level_ages[0] = Nanos(0);
            let after = rig.drive.position().sub_pulses() as f64;
            rig.ticks(ticks - 1);
            if level != steady && ticks > usize::from(filter) {
                steady = level;
                let edge = usize::from(!level);
                counts[edge] += 1;
                let at = (after - (after - before) * age as f64 / TICK.0 as f64) / SUB_PULSES_PER_PULSE;
                let (positions, _) = latched(&rig, 0);
                prop_assert!((f64::from(positions[edge]) - at).abs() <= 0.501, "{} for {at}", positions[edge]);
                // Armed again for the next edge.
                for function in [0x01, 0x31] {
                    rig.objects.probe_function = function;
                    rig.tick();
                }
            }
            prop_assert_eq!(latched(&rig, 0).1, counts);
        }
    }
}
