//! Profile position mode, handshake by handshake.

mod rig;

use proptest::prelude::*;
use rig::{IN_NEGATIVE_LIMIT, IN_POSITIVE_LIMIT, Rig};

const NEW: u16 = 0x1F;
const IMMEDIATE: u16 = 0x20;
const RELATIVE: u16 = 0x40;
const HALT: u16 = 0x100;
const ON_SET_POINT: u16 = 0x200;

/// Gives a set-point and takes bit 4 back; whether it was acknowledged.
fn send(rig: &mut Rig, target: i32, flags: u16) -> bool {
    rig.objects.target_position = target;
    rig.command(NEW | flags);
    let acknowledged = rig.status(12);
    rig.command(0x0F | flags);
    acknowledged
}

fn arrive(rig: &mut Rig) -> i32 {
    rig.until("at the target", |rig| rig.status(10));
    assert!(!rig.drive.is_moving());
    rig.objects.position
}

// manual: 2.3.2/pp-start 2.3.3/target 2.4.2/acknowledge 2.4.2/edge
#[test]
fn the_handshake_of_one_set_point() {
    let mut rig = Rig::enabled(1);
    assert_eq!((rig.status(10), rig.status(12)), (true, false));
    rig.objects.target_position = 5_000;
    rig.command(NEW);
    assert_eq!((rig.status(10), rig.status(12)), (false, true));
    rig.ticks(100);
    assert!(rig.status(12), "bit 4 is still set");
    rig.command(0x0F);
    assert_eq!((rig.status(10), rig.status(12)), (false, false));
    assert_eq!(arrive(&mut rig), 5_000);
    assert_eq!(rig.shaft.round(), 5_000.0);
}

// manual: 2.3.2/pp-start 2.4.2/edge
#[test]
fn set_points_are_latched_by_the_edge_and_not_by_the_level() {
    let mut rig = Rig::enabled(1);
    rig.objects.target_position = 1_000;
    rig.command(NEW);
    rig.objects.target_position = 9_000;
    rig.objects.profile_velocity = 1;
    rig.ticks(10);
    assert_eq!(arrive(&mut rig), 1_000);
    rig.ticks(100);
    assert_eq!(rig.objects.position, 1_000);
}

// manual: 2.4.2/start
#[test]
fn enabling_with_0x1f_starts_the_motion() {
    let mut rig = Rig::new();
    rig.objects.mode = 1;
    rig.objects.target_position = -700;
    rig.command(0x06);
    rig.command(NEW);
    rig.command(NEW);
    assert!(rig.status(12));
    assert_eq!(arrive(&mut rig), -700);
}

#[test]
fn a_motion_waits_for_the_shaft_lock() {
    let mut rig = Rig::new();
    rig.objects.mode = 1;
    rig.objects.soft_lock_time = 1000;
    rig.objects.target_position = 700;
    rig.command(0x06);
    rig.command(NEW);
    rig.command(NEW);
    assert!(rig.status(12) && !rig.status(10));
    rig.ticks(1_998);
    assert_eq!(rig.drive.position().sub_pulses(), 0);
    assert_eq!(arrive(&mut rig), 700);
}

// manual: 2.3.2/pp-relative 2.3.8/pp 2.4.2/absolute 2.4.2/relative
#[test]
fn absolute_and_relative_targets() {
    let mut rig = Rig::enabled(1);
    send(&mut rig, 10_000, 0);
    assert_eq!(arrive(&mut rig), 10_000);
    send(&mut rig, 20_000, RELATIVE);
    assert_eq!(arrive(&mut rig), 30_000);
    send(&mut rig, 20_000, 0);
    assert_eq!(arrive(&mut rig), 20_000);
    send(&mut rig, -25_000, RELATIVE);
    assert_eq!(arrive(&mut rig), -5_000);
}

#[test]
fn a_relative_target_counts_from_the_last_commanded_one_even_in_flight() {
    for flags in [RELATIVE, RELATIVE | IMMEDIATE, RELATIVE | ON_SET_POINT] {
        let mut rig = Rig::enabled(1);
        send(&mut rig, 10_000, 0);
        rig.milliseconds(100);
        assert!(send(&mut rig, 500, flags));
        assert_eq!(arrive(&mut rig), 10_500);
    }
}

// manual: 2.4.2/parameters 2.4.2/acknowledge
#[test]
fn the_buffer_takes_one_more_set_point_and_bit_12_stays_while_it_is_full() {
    let mut rig = Rig::enabled(1);
    assert!(send(&mut rig, 5_000, 0));
    assert!(!rig.status(12));
    assert!(send(&mut rig, 2_000, 0));
    assert!(rig.status(12), "no room for another one");
    send(&mut rig, 7_777, 0);
    assert!(rig.status(12));
    rig.until("at the first target", |rig| {
        rig.objects.position == 5_000 && rig.pulses_per_second() == 0
    });
    rig.until("free for another one", |rig| !rig.status(12));
    assert!(!rig.status(10), "the second one is under way");
    assert_eq!(arrive(&mut rig), 2_000);
}

// manual: 2.4.2/immediate
#[test]
fn an_immediate_set_point_replaces_active_and_buffered_ones() {
    let mut rig = Rig::enabled(1);
    send(&mut rig, 50_000, 0);
    send(&mut rig, 80_000, 0);
    rig.milliseconds(200);
    let before = rig.objects.position;
    rig.objects.profile_velocity = 30_000;
    assert!(send(&mut rig, -3_000, IMMEDIATE));
    assert!(!rig.status(12));
    rig.until("turned round", |rig| rig.pulses_per_second() < 0);
    assert!(rig.objects.position > before);
    assert_eq!(arrive(&mut rig), -3_000);
}

// manual: 2.4.2/one-by-one 2.4.2/chained
#[test]
fn change_on_set_point_passes_the_first_target_at_its_speed_and_a_plain_one_stops_there() {
    for (flags, slowest) in [(ON_SET_POINT, 9_990..=10_000), (0, 0..=0)] {
        let mut rig = Rig::enabled(1);
        send(&mut rig, 10_000, 0);
        rig.objects.profile_velocity = 4_000;
        send(&mut rig, 16_000, flags);
        rig.until("near the first target", |rig| rig.objects.position >= 9_000);
        let mut least = i32::MAX;
        while rig.objects.position <= 10_000 {
            rig.tick();
            least = least.min(rig.pulses_per_second());
        }
        assert!(slowest.contains(&least), "{least}");
        rig.until("at the new speed", |rig| rig.pulses_per_second() == 4_000);
        assert_eq!(arrive(&mut rig), 16_000);
    }
}

// manual: 2.3.2/pp-pause 2.3.12/deceleration
#[test]
fn halt_stops_with_the_profile_deceleration_and_its_end_continues() {
    let mut rig = Rig::enabled(1);
    send(&mut rig, 20_000, 0);
    rig.until("at speed", |rig| rig.pulses_per_second() == 10_000);
    rig.command(0x0F | HALT);
    let ticks = rig.until("standing", |rig| rig.status(10));
    assert!((1_998..2_220).contains(&ticks), "{ticks}");
    assert!(rig.objects.position < 20_000);
    rig.command(0x0F);
    assert!(!rig.status(10));
    assert_eq!(arrive(&mut rig), 20_000);
}

#[test]
fn a_set_point_given_in_halt_waits() {
    let mut rig = Rig::enabled(1);
    rig.command(0x0F | HALT);
    assert!(send(&mut rig, 300, HALT));
    rig.milliseconds(10);
    assert_eq!((rig.objects.position, rig.status(10)), (0, true));
    rig.command(0x0F);
    assert_eq!(arrive(&mut rig), 300);
}

// manual: 2.2.7/cw-limit 2.2.7/ccw-limit 2.3.13/limit
#[test]
fn a_limit_switch_stops_with_0x6085_and_leaves_only_the_way_back() {
    for (switch, sign) in [(IN_POSITIVE_LIMIT, 1), (IN_NEGATIVE_LIMIT, -1)] {
        let mut rig = Rig::enabled(1);
        send(&mut rig, sign * 50_000, 0);
        rig.until("at speed", |rig| rig.pulses_per_second() == sign * 10_000);
        rig.inputs = switch;
        rig.tick();
        assert!(rig.status(11));
        let ticks = rig.until("standing", |rig| !rig.drive.is_moving());
        assert!((398..620).contains(&ticks), "{ticks}");
        let stop = rig.objects.position;
        assert!(!rig.status(10), "the target was not reached");

        assert!(send(&mut rig, stop + sign * 1_000, 0));
        rig.milliseconds(50);
        assert_eq!((rig.objects.position, rig.status(10)), (stop, false));

        assert!(send(&mut rig, 0, 0));
        assert_eq!(arrive(&mut rig), 0);
        assert_eq!(rig.state(), drive::PowerState::OperationEnabled);
        rig.inputs = 0;
        rig.tick();
        assert!(!rig.status(11));
    }
}

#[test]
fn relative_moves_wrap_like_the_counter_and_absolute_ones_then_mean_the_counter() {
    let mut rig = Rig::enabled(1);
    rig.objects.profile_velocity = i32::MAX;
    rig.objects.profile_acceleration = i32::MAX;
    rig.objects.profile_deceleration = i32::MAX;
    send(&mut rig, i32::MAX, 0);
    assert_eq!(arrive(&mut rig), i32::MAX);
    for _ in 0..8 {
        send(&mut rig, 1_000, RELATIVE);
        arrive(&mut rig);
    }
    assert_eq!(rig.objects.position, i32::MIN + 7_999);
    send(&mut rig, i32::MIN, 0);
    assert_eq!(arrive(&mut rig), i32::MIN);
    for _ in 0..6 {
        send(&mut rig, i32::MAX, RELATIVE | IMMEDIATE);
        rig.ticks(10);
    }
    arrive(&mut rig);
    send(&mut rig, 12, 0);
    assert_eq!(arrive(&mut rig), 12);
}

#[test]
fn the_buffer_is_dropped_by_disabling_and_by_a_change_of_mode() {
    let mut rig = Rig::enabled(1);
    send(&mut rig, 50_000, 0);
    send(&mut rig, 90_000, 0);
    rig.milliseconds(200);
    rig.command(0x07);
    rig.until("disabled", |rig| rig.state() == drive::PowerState::SwitchedOn);
    let stop = rig.objects.position;
    rig.command(0x0F);
    rig.milliseconds(50);
    assert_eq!((rig.objects.position, rig.status(10)), (stop, true));

    send(&mut rig, 90_000, 0);
    rig.milliseconds(200);
    rig.objects.mode = 3;
    rig.tick();
    assert_eq!(rig.objects.mode_display, 3);
    rig.until("standing", |rig| rig.status(10));
    rig.objects.mode = 1;
    let stop = rig.objects.position;
    rig.milliseconds(50);
    assert_eq!((rig.objects.position, rig.status(10)), (stop, true));
}

// manual: 2.2.9/lag
#[test]
fn the_motion_filter_delays_the_end_and_does_not_shift_it() {
    let mut rig = Rig::new();
    rig.objects.filter_time = 25_600;
    rig.objects.mode = 1;
    rig.enable();
    send(&mut rig, 3_000, 0);
    let filtered = rig.until("at the target", |rig| rig.status(10));
    assert_eq!(rig.objects.position, 3_000);
    let mut rig = Rig::enabled(1);
    send(&mut rig, 3_000, 0);
    let plain = rig.until("at the target", |rig| rig.status(10));
    assert!((500..=520).contains(&(filtered - plain)), "{filtered} {plain}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn whatever_the_set_points_the_last_one_is_reached_exactly(
        steps in prop::collection::vec((-20_000i32..20_000, any::<[bool; 3]>(), 0usize..4_000, 0u16..25_600), 1..6),
    ) {
        let mut rig = Rig::enabled(1);
        rig.objects.profile_velocity = 200_000;
        rig.objects.profile_acceleration = 3_000_000;
        rig.objects.profile_deceleration = 1_000_000;
        rig.objects.filter_time = steps[0].3;
        let mut last = 0;
        for (target, [relative, immediate, fly], pause, _) in steps {
            let flags = if relative { RELATIVE } else { 0 } | if immediate { IMMEDIATE } else { 0 } | if fly { ON_SET_POINT } else { 0 };
            if !rig.status(12) && send(&mut rig, target, flags) {
                last = if relative { last + target } else { target };
            }
            rig.ticks(pause);
        }
        prop_assert_eq!(arrive(&mut rig), last);
        prop_assert!((rig.shaft - f64::from(last)).abs() < 0.01, "{} {}", rig.shaft, last);
    }
}

#[test]
fn each_set_point_has_its_own_speed_and_ramps_and_new_ones_in_the_objects_wait_for_the_next() {
    let mut rig = Rig::enabled(1);
    rig.objects.profile_acceleration = 400_000;
    rig.objects.profile_deceleration = 50_000;
    send(&mut rig, 10_000, 0);
    rig.objects.profile_velocity = 1;
    rig.objects.profile_acceleration = 1;
    rig.objects.profile_deceleration = 1;
    // One tick has gone since the edge; 10 000 pulses/s are reached after 500 and take 4 000 to lose.
    rig.ticks(498);
    assert_eq!(rig.pulses_per_second(), 10_000);
    let cruise = rig.until("braking", |rig| rig.pulses_per_second() < 10_000);
    let braking = rig.until("there", |rig| rig.status(10));
    assert_eq!(rig.objects.position, 10_000);
    // 125 pulses of acceleration, 1 000 of deceleration.
    assert!(
        (17_748..=17_752).contains(&cruise) && (3_997..=4_001).contains(&braking),
        "{cruise} {braking}"
    );
}

#[test]
fn an_immediate_set_point_takes_speed_and_ramps_along_without_a_jump() {
    let mut rig = Rig::enabled(1);
    send(&mut rig, 100_000, 0);
    rig.milliseconds(200);
    // Faster, then slower, then backwards, each with ramps of its own.
    for (target, speed, acceleration, deceleration) in [
        (120_000, 40_000, 300_000, 100_000),
        (120_000, 5_000, 100_000, 700_000),
        (0, 25_000, 200_000, 60_000),
    ] {
        rig.objects.profile_velocity = speed;
        rig.objects.profile_acceleration = acceleration;
        rig.objects.profile_deceleration = deceleration;
        rig.objects.target_position = target;
        rig.objects.controlword = NEW | IMMEDIATE;
        for _ in 0..4_400 {
            let before = rig.drive.velocity().sub_pulses_per_tick();
            rig.tick();
            let after = rig.drive.velocity().sub_pulses_per_tick();
            let change = (after - before) * if before == 0 { after.signum() } else { before.signum() };
            assert!(
                (-i64::from(deceleration)..=acceleration.into()).contains(&change),
                "{before} to {after}"
            );
            rig.objects.controlword = 0x0F;
        }
        let direction = if target == 0 { -1 } else { 1 };
        assert!((rig.pulses_per_second() - direction * speed).abs() <= 1);
    }
    assert_eq!(arrive(&mut rig), 0);
}

#[test]
fn an_immediate_target_too_near_to_stop_at_is_overrun_by_the_braking_distance_and_no_more() {
    let mut rig = Rig::enabled(1);
    send(&mut rig, 100_000, 0);
    rig.milliseconds(200);
    let here = rig.objects.position;
    send(&mut rig, here + 100, IMMEDIATE);
    let mut farthest = here;
    while !rig.status(10) {
        rig.tick();
        farthest = farthest.max(rig.objects.position);
    }
    // 10 000^2 / 200 000 = 500 pulses from the tick that sees the edge.
    assert!((499..=501).contains(&(farthest - here)), "{}", farthest - here);
    assert_eq!(rig.objects.position, here + 100);
}

#[test]
fn set_points_chained_on_the_fly_are_passed_at_the_speed_of_the_one_before_and_none_stands() {
    let mut rig = Rig::enabled(1);
    let speeds = [10_000, 5_000, 20_000, 8_000];
    rig.objects.profile_velocity = speeds[0];
    assert!(send(&mut rig, 10_000, 0));
    for (n, speed) in (2..).zip(&speeds[1..]) {
        rig.objects.profile_velocity = *speed;
        assert!(send(&mut rig, n * 10_000, ON_SET_POINT));
        let set_point = (n - 1) * 10_000;
        rig.until("before the set-point", |rig| rig.objects.position >= set_point - 20);
        while rig.drive.position().sub_pulses() < i64::from(set_point) * 400_000_000 {
            assert_eq!(rig.pulses_per_second(), speeds[n as usize - 2], "at {set_point}");
            assert!(!rig.status(10));
            rig.tick();
        }
        rig.tick();
        assert!(!rig.status(12), "there is room again");
    }
    assert_eq!(arrive(&mut rig), 40_000);
}

#[test]
fn a_chained_set_point_in_the_other_direction_is_stopped_at_and_one_too_near_slows_the_first_down() {
    let mut rig = Rig::enabled(1);
    send(&mut rig, 5_000, 0);
    send(&mut rig, 1_000, ON_SET_POINT);
    rig.until("at the first one", |rig| {
        rig.objects.position == 5_000 && rig.pulses_per_second() == 0
    });
    assert_eq!(arrive(&mut rig), 1_000);

    send(&mut rig, 10_000, 0);
    send(&mut rig, 10_100, ON_SET_POINT);
    rig.until("at the first one", |rig| rig.objects.position >= 10_000);
    // From here 100 pulses are left: sqrt(2 * 100 000 * 100) pulses/s.
    assert!((4_465..=4_490).contains(&rig.pulses_per_second()), "{}", rig.pulses_per_second());
    assert_eq!(arrive(&mut rig), 10_100);
}

#[test]
fn halt_keeps_both_set_points_and_takes_new_ones() {
    let mut rig = Rig::enabled(1);
    send(&mut rig, 20_000, 0);
    send(&mut rig, 5_000, 0);
    rig.milliseconds(300);
    rig.command(0x0F | HALT);
    rig.until("halted", |rig| rig.status(10));
    assert!(rig.status(12), "the buffer is full");
    let halted = rig.objects.position;
    assert!((1..20_000).contains(&halted));
    rig.command(0x0F);
    assert!(!rig.status(10));
    rig.until("at the first one", |rig| rig.objects.position == 20_000);
    rig.command(0x0F | HALT);
    rig.until("halted", |rig| rig.status(10));
    assert!(send(&mut rig, -3_000, HALT | IMMEDIATE));
    rig.milliseconds(20);
    rig.command(0x0F);
    assert_eq!(arrive(&mut rig), -3_000);
}

#[test]
fn a_set_point_that_is_where_the_motor_stands_is_acknowledged_and_reached_in_the_same_tick() {
    let mut rig = Rig::enabled(1);
    rig.command(NEW);
    assert_eq!((rig.status(10), rig.status(12)), (true, true));
}

#[test]
fn an_absolute_move_never_crosses_the_end_of_the_counter_and_a_relative_one_may() {
    let mut rig = Rig::enabled(1);
    rig.objects.profile_velocity = i32::MAX;
    rig.objects.profile_acceleration = i32::MAX;
    rig.objects.profile_deceleration = i32::MAX;
    send(&mut rig, i32::MIN, 0);
    assert_eq!(arrive(&mut rig), i32::MIN);
    // The whole range the long way, in some two seconds.
    send(&mut rig, i32::MAX, 0);
    let mut ticks = 0;
    while !rig.status(10) {
        let before = rig.objects.position;
        rig.tick();
        assert!(rig.objects.position >= before, "upwards all the way");
        ticks += 1;
    }
    assert!((40_000..80_000).contains(&ticks), "{ticks}");
    assert_eq!(rig.objects.position, i32::MAX);
    send(&mut rig, 1, RELATIVE);
    rig.ticks(220);
    assert_eq!((rig.objects.position, rig.status(10)), (i32::MIN, true));
    send(&mut rig, -1, RELATIVE);
    rig.ticks(220);
    assert_eq!((rig.objects.position, rig.status(10)), (i32::MAX, true));
    for distance in [i32::MIN, i32::MIN, i32::MAX, i32::MAX, 2] {
        let expected = rig.objects.position.wrapping_add(distance);
        send(&mut rig, distance, RELATIVE);
        assert_eq!(arrive(&mut rig), expected);
    }
}
