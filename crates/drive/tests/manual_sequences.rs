//! What the manual's descriptions of the modes tell users to do, step by step, and what then happens.

mod rig;

use drive::PowerState::*;
use rig::{Rig, Travel};

/// Ticks at a constant rate of change, at peak speed, and from there to rest.
fn shape(rig: &mut Rig, peak: i32) -> (usize, i32, usize) {
    let up = rig.until("at the peak", |rig| rig.pulses_per_second().abs() >= peak);
    let highest = rig.pulses_per_second();
    rig.until("slowing down", |rig| rig.pulses_per_second().abs() < peak);
    (up, highest, rig.until("at rest", |rig| !rig.drive.is_moving()))
}

/// Whether a ramp took as many ticks as it should, up to the last pulse's.
fn is_about(ticks: usize, expected: usize) -> bool {
    (expected - 3..expected + 40).contains(&ticks)
}

// manual: 2.3.10/speed 2.3.11/acceleration 2.3.12/deceleration 2.4.2/parameters
#[test]
fn a_profile_position_has_the_speed_and_the_ramps_of_its_objects() {
    let mut rig = Rig::enabled(1);
    rig.objects.profile_velocity = 5_000;
    rig.objects.profile_acceleration = 50_000;
    rig.objects.profile_deceleration = 25_000;
    rig.objects.target_position = 10_000;
    rig.command(0x1F);
    let (up, highest, down) = shape(&mut rig, 5_000);
    assert!(is_about(up, 2_000) && is_about(down, 4_000), "{up} {down}");
    assert_eq!((highest, rig.objects.position), (5_000, 10_000));
}

// manual: 2.4.3/mode 2.4.3/enable 2.3.2/pv-pause
#[test]
fn profile_velocity_is_enabled_by_06_and_010f_stands_and_starts_with_000f() {
    let mut rig = Rig::new();
    assert_eq!(rig.state(), SwitchOnDisabled);
    rig.objects.mode = 3;
    rig.objects.target_velocity = 5_000;
    rig.command(0x0006);
    assert_eq!((rig.state(), rig.objects.mode_display), (ReadyToSwitchOn, 3));
    rig.command(0x010F);
    rig.milliseconds(50);
    assert_eq!((rig.state(), rig.drive.is_moving()), (OperationEnabled, false));
    rig.command(0x000F);
    rig.until("at speed", |rig| rig.pulses_per_second() == 5_000);
}

// manual: 2.4.3/torque 2.4.3/free
#[test]
fn a_motor_stopped_in_profile_velocity_holds_and_one_that_is_disabled_is_free() {
    for (word, target) in [(0x010F, 5_000), (0x000F, 0), (0x010F, 0)] {
        let mut rig = Rig::enabled(3);
        rig.objects.target_velocity = target;
        rig.command(word);
        rig.milliseconds(2_000);
        assert_eq!(rig.amplitude(), Some(1_500), "{word:04X}, {target}: standby current");
        rig.command(0x0000);
        assert_eq!((rig.state(), rig.amplitude()), (SwitchOnDisabled, None));
    }
}

// manual: 2.4.4/mode 2.4.4/enable
#[test]
fn cyclic_position_is_enabled_by_06_and_0f_and_follows() {
    let mut rig = Rig::new();
    rig.objects.mode = 8;
    assert_eq!(rig.state(), SwitchOnDisabled);
    rig.command(0x0006);
    assert_eq!(rig.state(), ReadyToSwitchOn);
    rig.objects.controlword = 0x000F;
    for cycle in 0..100 {
        rig.cycle(10 * cycle, board::Nanos(1_000_000));
    }
    assert_eq!((rig.objects.mode_display, rig.objects.position), (8, 990));
}

/// A drive left of its home switch in homing mode, switched on as the manual says.
fn homing() -> Rig {
    let mut rig = Rig::new();
    rig.travel = Some(Travel {
        negative_limit_below: -20_000.0,
        positive_limit_from: 20_000.0,
        home: 8_000.0..9_000.0,
    });
    rig.objects.mode = 6;
    rig.objects.homing_method = 19;
    rig.objects.homing_acceleration = 50_000;
    rig.objects.homing_speed_fast = 5_000;
    rig.objects.homing_speed_slow = 1_000;
    rig.command(0x06);
    rig.command(0x0F);
    rig.tick();
    assert_eq!((rig.state(), rig.objects.mode_display), (OperationEnabled, 6));
    rig
}

// manual: 2.3.13/homing 2.3.15/speeds 2.3.16/ramps 2.4.6/mode 2.4.6/enable 2.4.6/start
#[test]
fn homing_has_the_speeds_of_0x6099_and_the_ramps_of_0x609a_and_0x6085() {
    let mut rig = homing();
    rig.command(0x1F);
    let (up, highest, down) = shape(&mut rig, 5_000);
    assert!(is_about(up, 2_000), "0x609A: {up}");
    assert!((198..=205).contains(&down), "0x6085 at the switch: {down}");
    assert_eq!(highest, 5_000);
    let mut slowest = 0;
    rig.until("done", |rig| rig.status(12));
    while rig.drive.is_moving() {
        slowest = slowest.min(rig.pulses_per_second());
        rig.tick();
    }
    assert!((-1_000..0).contains(&slowest), "it left the edge slowly: {slowest}");

    let mut rig = homing();
    rig.command(0x1F);
    rig.until("at speed", |rig| rig.pulses_per_second() == 5_000);
    rig.command(0x11F);
    let down = rig.until("standing", |rig| !rig.drive.is_moving());
    assert!(is_about(down, 2_000), "0x609A: {down}");
}

// manual: 2.4.6.1/35 2.4.6.2/35
#[test]
fn method_35_takes_the_present_position_in_both_variants() {
    for variant in [0, 1] {
        let mut rig = homing();
        rig.objects.homing_variant = variant;
        rig.objects.homing_method = 35;
        rig.objects.home_offset = 77;
        rig.command(0x1F);
        rig.until("done", |rig| rig.status(12));
        assert_eq!((rig.objects.position, rig.shaft.round()), (77, 0.0), "variant {variant}");
    }
}

// manual: 2.3.3/reserved
#[test]
fn no_state_shows_the_reserved_bits_of_the_statusword() {
    for mode in [0, 1, 3, 6, 8] {
        let mut rig = Rig::new();
        rig.objects.mode = mode;
        for word in [0x00, 0x06, 0x07, 0x0F, 0x1F, 0x3F, 0x10F, 0x02, 0x00, 0x80, 0xFFFF] {
            rig.objects.controlword = word;
            for _ in 0..5 {
                rig.tick();
                assert_eq!(rig.objects.statusword & 0x0180, 0, "mode {mode}, {word:04X}");
            }
        }
        rig.drive.parameters_lost();
        rig.ticks(5);
        assert_eq!(rig.objects.statusword & 0x0188, 0x0008, "mode {mode}, fault");
    }
}

// manual: 2.2.12/open-loop
#[test]
fn the_motor_parameters_a_user_sets_do_not_act_in_open_loop() {
    let mut plain = Rig::enabled(3);
    let mut other = plain.clone();
    for (sub, value) in [(4, 10_000_u16), (5, 10), (6, 1_000)] {
        other.download(0x200C, sub, &value.to_le_bytes()).unwrap();
    }
    for rig in [&mut plain, &mut other] {
        rig.objects.target_velocity = 50_000;
    }
    for _ in 0..20_000 {
        plain.tick();
        other.tick();
        assert_eq!(plain.drive.current_vector(), other.drive.current_vector());
        assert_eq!(plain.drive.position(), other.drive.position());
        assert_eq!(plain.objects.statusword, other.objects.statusword);
    }
}
