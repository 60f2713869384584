//! The motion filter, the units, and the objects that tell of motion: 0x2001, 0x2009, 0x200D, 0x200F, 0x2010, 0x2043, 0x2044, 0x606C.

mod rig;

use board::{Millivolts, Nanos};
use dictionary::AbortCode;
use drive::PowerState::*;
use proptest::prelude::*;
use rig::{IN_NEGATIVE_LIMIT, IN_OFFLINE, Rig};

const NEW: u16 = 0x1F;
const RELATIVE: u16 = 0x40;

fn axis(filter_time: u16, mode: i8) -> Rig {
    let mut rig = Rig::new();
    rig.objects.filter_time = filter_time;
    rig.objects.mode = mode;
    rig.enable();
    rig
}

fn move_by(rig: &mut Rig, distance: i32) -> usize {
    rig.objects.target_position = distance;
    rig.command(0x0F | RELATIVE);
    rig.command(NEW | RELATIVE);
    rig.until("there", |rig| rig.status(10))
}

fn angle(rig: &Rig) -> u32 {
    rig.drive.current_vector().expect("the power stage is on").angle.0
}

#[test]
fn every_motion_ends_by_the_filter_time_later_and_on_the_same_pulse() {
    let plain = move_by(&mut axis(0, 1), 3_000);
    for (microseconds, ticks) in [(0, 0), (49, 0), (99, 0), (100, 1), (6_400, 127), (25_599, 510), (25_600, 511)] {
        let mut rig = axis(microseconds, 1);
        let filtered = move_by(&mut rig, 3_000);
        assert_eq!(rig.objects.position, 3_000);
        assert_eq!(filtered - plain, ticks, "{microseconds} us");
    }
}

#[test]
fn at_constant_speed_the_axis_is_half_the_filter_time_behind() {
    for (microseconds, window) in [(1_000, 20), (6_400, 128), (25_600, 512)] {
        let mut rig = axis(microseconds, 8);
        for n in 1..=100 {
            rig.cycle(n * 200, Nanos(1_000_000));
        }
        // 10 pulses a tick; a mean over the window is that of its middle.
        let behind = 20_000 - rig.objects.position;
        assert!((behind - (window - 1) * 5).abs() <= 1, "{microseconds} us: {behind}");
    }
}

#[test]
fn another_filter_time_in_motion_waits_for_standstill_and_loses_nothing() {
    for (before, after) in [(25_600, 0), (0, 25_600), (6_400, 12_800)] {
        let mut rig = axis(before, 1);
        rig.objects.target_position = 5_000;
        rig.command(NEW);
        rig.milliseconds(100);
        rig.objects.filter_time = after;
        let mut least = i64::MAX;
        while !rig.status(10) {
            let speed = rig.drive.velocity().sub_pulses_per_tick();
            rig.tick();
            least = least.min(100_001 - (rig.drive.velocity().sub_pulses_per_tick() - speed).abs());
        }
        assert!(least >= 0, "the speed has jumped");
        assert_eq!((rig.objects.position, rig.shaft.round()), (5_000, 5_000.0));
        // From standstill on it counts.
        assert_eq!(move_by(&mut rig, 3_000), move_by(&mut axis(after, 1), 3_000));
    }
}

#[test]
fn resolution_and_direction_are_refused_in_motion_and_taken_at_standstill() {
    let mut rig = axis(6_400, 1);
    rig.objects.target_position = 5_000;
    rig.command(NEW);
    let mut refused = 0;
    while rig.drive.is_moving() {
        assert_eq!(rig.download(0x2001, 0, &20_000u16.to_le_bytes()), Err(AbortCode::DeviceState));
        assert_eq!(rig.download(0x200D, 0, &[1, 0]), Err(AbortCode::DeviceState));
        // What is there already may be written, as start-up lists and process data do.
        assert_eq!(rig.download(0x2001, 0, &10_000u16.to_le_bytes()), Ok(()));
        assert_eq!(rig.download(0x200D, 0, &[0, 0]), Ok(()));
        rig.tick();
        refused += 1;
    }
    assert!(refused > 1_000);
    assert_eq!(rig.objects.position, 5_000);

    let before = angle(&rig);
    rig.download(0x2001, 0, &20_000u16.to_le_bytes()).unwrap();
    rig.download(0x200D, 0, &[1, 0]).unwrap();
    rig.tick();
    assert_eq!(
        (angle(&rig), rig.objects.position),
        (before, 5_000),
        "neither shaft nor counter moves"
    );
    // 100 pulses of 20 000 a turn are a quarter of an electrical period, now backwards.
    move_by(&mut rig, 100);
    assert_eq!(before.wrapping_sub(angle(&rig)), 1 << 30);
}

#[test]
fn counter_and_field_are_exact_after_billions_of_pulses_at_any_resolution() {
    for resolution in [200u16, 333, 10_000, 65_535] {
        let mut rig = Rig::new();
        rig.objects.resolution = resolution;
        rig.objects.mode = 1;
        rig.objects.profile_velocity = i32::MAX;
        rig.objects.profile_acceleration = i32::MAX;
        rig.objects.profile_deceleration = i32::MAX;
        rig.enable();
        let mut travelled = 0i64;
        for distance in [
            1_000_000_007,
            1_999_999_999,
            1,
            2_000_000_000,
            -7,
            -2_000_000_000,
            -2_000_000_000,
            -1_000_000_000,
        ] {
            move_by(&mut rig, distance);
            travelled += i64::from(distance);
            assert_eq!(rig.objects.position, travelled as i32, "resolution {resolution}");
            let turn = i64::from(resolution);
            let expected = ((i128::from((travelled * 50).rem_euclid(turn)) << 32) / i128::from(turn)) as u32;
            let error = angle(&rig).wrapping_sub(expected) as i32;
            assert!(error.abs() <= 1, "resolution {resolution}, {travelled} pulses: {error} of 2^32");
        }
        assert_eq!(travelled, 0);
        assert_eq!(angle(&rig), 0);
    }
}

#[test]
fn a_changed_resolution_keeps_the_angle_of_the_field_however_often() {
    let mut rig = axis(0, 1);
    move_by(&mut rig, 77);
    let before = angle(&rig);
    for n in 0..10_000u32 {
        rig.objects.resolution = (200 + n * 37 % 60_000) as u16;
        rig.tick();
    }
    rig.objects.resolution = 10_000;
    rig.tick();
    let turned = angle(&rig).wrapping_sub(before) as i32;
    assert!(turned.abs() < 2_000, "{turned} of 2^32, one 43 000th of a pulse");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(50))]

    #[test]
    fn speeds_in_revolutions_a_minute_are_those_of_the_target_velocity_to_the_nearest(velocity: i32, resolution in 200u16..) {
        let mut rig = Rig::new();
        rig.objects.resolution = resolution;
        rig.objects.mode = 3;
        rig.objects.profile_acceleration = i32::MAX;
        rig.objects.target_velocity = velocity;
        rig.enable();
        rig.ticks(20_002);
        prop_assert_eq!(rig.pulses_per_second(), velocity);
        let exact = f64::from(velocity) * 60.0 / f64::from(resolution);
        prop_assert!((f64::from(rig.objects.velocity) - exact).abs() <= 0.5, "{} for {exact}", rig.objects.velocity);
        let shown = rig.objects.velocity.clamp(-3_000, 3_000);
        prop_assert_eq!(i32::from(rig.objects.speed_feedback), shown);
        prop_assert_eq!(i32::from(rig.objects.speed_reference), shown);
    }
}

#[test]
fn the_given_speed_is_before_the_filter_and_the_speed_feedback_behind_it() {
    let mut rig = axis(25_600, 3);
    rig.objects.profile_acceleration = i32::MAX;
    rig.objects.target_velocity = 100_000;
    rig.ticks(256);
    assert_eq!(
        (rig.objects.speed_reference, rig.objects.speed_feedback, rig.objects.velocity),
        (600, 300, 300)
    );
    rig.ticks(256);
    assert_eq!((rig.objects.speed_reference, rig.objects.speed_feedback), (600, 600));
}

#[test]
fn the_status_code_bit_by_bit() {
    let (enabled, failed, in_place, running, homed, ready) = (0x01, 0x02, 0x04, 0x08, 0x10, 0x20);
    let mut rig = Rig::at_power_up();
    assert_eq!(rig.objects.status_code, 0);
    rig.objects.filter_time = 0;
    rig.objects.soft_lock_time = 0;
    rig.objects.mode = 1;
    rig.drive.set_network(true);
    rig.tick();
    assert_eq!(rig.objects.status_code, ready);
    rig.enable();
    assert_eq!(rig.objects.status_code, ready | enabled | in_place);
    rig.objects.target_position = 100_000;
    rig.command(NEW);
    assert_eq!(rig.objects.status_code, ready | enabled | running);
    rig.command(0x10F);
    rig.until("halted", |rig| !rig.drive.is_moving());
    assert_eq!(rig.objects.status_code, ready | enabled | in_place);

    rig.objects.mode = 6;
    rig.objects.homing_method = 35;
    rig.command(0x0F);
    rig.command(NEW);
    rig.until("homed", |rig| rig.status(12));
    assert_eq!(rig.objects.status_code, ready | enabled | in_place | homed);
    rig.command(0x02);
    assert_eq!((rig.state(), rig.objects.status_code), (QuickStopActive, ready | homed));
    rig.command(0x00);
    assert_eq!((rig.state(), rig.objects.status_code), (SwitchOnDisabled, ready | homed));
    rig.bus = Millivolts(61_000);
    rig.ticks(4);
    assert_eq!((rig.state(), rig.objects.status_code), (Fault, failed | homed));
}

#[test]
fn the_position_is_cleared_in_any_state_and_mode_that_stands_but_not_while_csp_leads() {
    for mode in [0, 1, 3, 6, 8] {
        for word in [0x00, 0x06, 0x07, 0x0F, 0x02] {
            let mut rig = axis(0, 1);
            move_by(&mut rig, 1_234);
            rig.objects.quick_stop_option = 6;
            rig.objects.mode = mode;
            rig.command(0x0F);
            rig.command(word);
            rig.ticks(3);
            let led = mode == 8 && rig.state() == OperationEnabled;
            let expected = if led { Err(AbortCode::DeviceState) } else { Ok(()) };
            assert_eq!(rig.download(0x2010, 0, &[1, 0]), expected, "mode {mode}, {word:02X}");
            rig.tick();
            let position = if led { 1_234 } else { 0 };
            assert_eq!(
                (rig.objects.position, rig.objects.zero_position),
                (position, 0),
                "mode {mode}, {word:02X}"
            );
            assert_eq!(rig.shaft.round(), 1_234.0);
        }
    }
}

#[test]
fn each_enabling_locks_the_shaft_anew_and_csp_does_not_wait_for_it() {
    let mut rig = axis(0, 8);
    rig.objects.soft_lock_time = 100;
    for word in [0x07, 0x06, 0x00] {
        rig.command(word);
        rig.tick();
        assert_eq!(rig.amplitude(), None);
        rig.enable();
        assert!(rig.amplitude().unwrap() <= 30);
        let target = rig.objects.position + 10;
        rig.cycle(target, Nanos(1_000_000));
        assert_eq!(rig.objects.position, target);
        assert!(rig.amplitude().unwrap() < 3_000 / 5);
        rig.ticks(200);
        assert_eq!(rig.amplitude(), Some(3_000));
    }
    rig.inputs = IN_OFFLINE;
    rig.ticks(5);
    assert_eq!(rig.amplitude(), None);
    rig.inputs = IN_NEGATIVE_LIMIT;
    rig.tick();
    assert_eq!(rig.amplitude(), Some(15), "back in line, the current rises from zero");
}

#[test]
fn the_lock_time_is_a_tenth_of_a_millisecond_a_unit_and_zero_is_at_once() {
    for (value, ticks) in [(0u16, 1), (1, 2), (10, 20), (1_000, 2_000), (65_535, 131_070)] {
        let mut rig = Rig::new();
        rig.objects.soft_lock_time = value;
        rig.enable();
        let taken = (1..).find(|_| {
            let full = rig.amplitude() == Some(3_000);
            rig.tick();
            full
        });
        assert_eq!(taken, Some(ticks), "0x200A = {value}");
    }
}
