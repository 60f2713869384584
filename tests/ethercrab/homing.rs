//! Homing over the bus, from both sides of the switch.

use std::time::Duration;

use dictionary::AbortCode;
use ethercrab::MainDevice;
use ethercrab::subdevice_group::PreOp;
use rig::{PULSES_PER_TURN, Rig};
use usr2556e::master::bring_up::Group;
use usr2556e::master::process_data::mode;
use usr2556e::master::sdo::abort_code;

/// Edges of the switches in pulses from the middle of the axis.
const HOME_LEFT: f64 = 10_000.0;
const HOME_RIGHT: f64 = 15_000.0;
const NEGATIVE_LIMIT: f64 = -100_000.0;
const POSITIVE_LIMIT: f64 = 100_000.0;

/// Sets method, offset and speeds; motion and input filters are off, so that edges can be compared to the pulse.
fn prepare(method: i8, variant: u16, offset: i32) -> impl AsyncFnOnce(&MainDevice<'_>, &Group<PreOp>) {
    async move |main: &MainDevice<'_>, group: &Group<PreOp>| {
        let drive = group.subdevice(main, 0).unwrap();
        drive.sdo_write(0x6098, 0, method).await.unwrap();
        drive.sdo_write(0x204C, 0, variant).await.unwrap();
        drive.sdo_write(0x607C, 0, offset).await.unwrap();
        drive.sdo_write(0x6099, 1, 40_000_u32).await.unwrap();
        drive.sdo_write(0x6099, 2, 2_000_u32).await.unwrap();
        drive.sdo_write(0x2009, 0, 0_u16).await.unwrap();
        drive.sdo_write(0x204B, 0, 0_u16).await.unwrap();
    }
}

/// Homes with `method` of variant 0 from `start` turns; returns where home was found, in pulses from the middle of the axis.
fn home_from(start: f64, method: i8, offset: i32) -> Option<f64> {
    let rig = Rig::standing_at(start);
    let found = home_after(&rig, prepare(method, 0, offset));
    found.map(|position| rig.shaft() - f64::from(position - offset))
}

/// Homes once; returns the position that the axis stands at then, if home was found.
fn home_after(rig: &Rig, prepare: impl AsyncFnOnce(&MainDevice<'_>, &Group<PreOp>)) -> Option<i32> {
    rig.in_op_after(prepare, async |axis| {
        axis.outputs.mode = mode::HOMING;
        axis.enable().await.unwrap();
        let found = axis.home(Duration::from_secs(300)).await.unwrap();
        for _ in 0..20 {
            axis.cycle().await.unwrap();
        }
        found.then_some(axis.inputs.position)
    })
}

/// Asserts that home lies at an edge, but for what filter-free sampling at a speed explains: two ticks of travel and the shaft's lag.
fn assert_at(found: Option<f64>, edge: f64, speed: f64, what: &str) {
    let tolerance = speed * 250e-6 + 1.5;
    let found = found.unwrap_or_else(|| panic!("{what}: no home"));
    assert!(
        (found - edge).abs() <= tolerance,
        "{what}: home at {found:.2}, edge at {edge}, tolerance {tolerance:.1}"
    );
}

// manual: 1.1.1/modes 2.4.6.1/19 2.4.6.1/20 2.4.6.1/21
#[test]
fn home_switch_methods_end_on_the_same_edge_from_both_sides_and_from_on_the_switch() {
    for (method, edge) in [(19, HOME_LEFT), (20, HOME_LEFT), (21, HOME_RIGHT)] {
        for start in [-3.0, 1.2, 4.0] {
            let start: f64 = start;
            assert_at(
                home_from(start, method, 0),
                edge,
                2_000.0,
                &format!("method {method} from {start} turns"),
            );
        }
    }
}

// manual: 2.2.25/variant
#[test]
fn methods_that_turn_at_a_limit_end_on_their_edge_in_both_variants() {
    for (method, edge, beyond) in [(24, HOME_LEFT, 9.5), (28, HOME_RIGHT, -9.5)] {
        for (variant, start) in [(0, beyond), (0, 1.2), (1, beyond), (1, 1.2), (1, -3.0), (1, 4.0)] {
            let start: f64 = start;
            let rig = Rig::standing_at(start);
            let home = home_after(&rig, prepare(method, variant, 0)).map(|position| rig.shaft() - f64::from(position));
            assert_at(
                home,
                edge,
                2_000.0,
                &format!("method {method} of variant {variant} from {start} turns"),
            );
        }
    }
}

// manual: 2.4.6.1/17 2.4.6.1/18
#[test]
fn limit_switch_methods_end_on_their_limit_from_both_sides() {
    for (method, edge, beside, on) in [(17, NEGATIVE_LIMIT, -8.0, -10.5), (18, POSITIVE_LIMIT, 8.0, 10.5)] {
        assert_at(
            home_from(beside, method, 0),
            edge,
            40_000.0,
            &format!("method {method} towards the limit"),
        );
        assert_at(home_from(on, method, 0), edge, 2_000.0, &format!("method {method} off the limit"));
    }
}

// manual: 2.3.9/offset
#[test]
fn the_home_offset_is_what_the_edge_reads() {
    assert_at(home_from(-3.0, 19, 5_000), HOME_LEFT, 2_000.0, "with offset");
}

// manual: 2.4.6.1/35
#[test]
fn method_35_makes_the_present_position_home() {
    let start = 3.0;
    assert_at(home_from(start, 35, 123), start * PULSES_PER_TURN, 0.0, "method 35");
}

#[test]
fn a_method_the_drive_does_not_have_is_refused() {
    Rig::new(1).in_preop(async |main, _, group| {
        let drive = group.subdevice(main, 0).unwrap();
        for (method, refusal) in [
            (1_i8, Some(AbortCode::ValueTooLow)),
            (30, None),
            (31, Some(AbortCode::ValueRange)),
            (34, Some(AbortCode::ValueRange)),
            (35, None),
            (37, Some(AbortCode::ValueTooHigh)),
        ] {
            let answer = drive.sdo_write(0x6098, 0, method).await;
            assert_eq!(answer.err().as_ref().and_then(abort_code), refusal, "method {method}");
        }
    });
}

#[test]
fn a_switch_without_an_input_ends_in_a_homing_error() {
    let without_home = async |main: &MainDevice<'_>, group: &Group<PreOp>| {
        prepare(24, 0, 0)(main, group).await;
        let drive = group.subdevice(main, 0).unwrap();
        drive.sdo_write(0x2007, 5, 0_u16).await.unwrap();
    };
    assert_eq!(home_after(&Rig::standing_at(0.0), without_home), None);
}

#[test]
fn homing_again_finds_home_again() {
    let rig = Rig::standing_at(-2.0);
    let homes = rig.in_op_after(prepare(19, 0, 0), async |axis| {
        axis.outputs.mode = mode::HOMING;
        axis.enable().await.unwrap();
        let mut homes = Vec::new();
        for _ in 0..3 {
            assert!(axis.home(Duration::from_secs(60)).await.unwrap());
            for _ in 0..20 {
                axis.cycle().await.unwrap();
            }
            homes.push(rig.shaft() - f64::from(axis.inputs.position));
        }
        homes
    });
    for home in homes {
        assert_at(Some(home), HOME_LEFT, 2_000.0, "one of three in a row");
    }
}
