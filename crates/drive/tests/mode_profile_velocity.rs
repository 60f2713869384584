//! Profile velocity mode.

mod rig;

use rig::{IN_NEGATIVE_LIMIT, IN_POSITIVE_LIMIT, Rig};

const RUN: u16 = 0x0F;
const HALT: u16 = 0x10F;

fn speed(rig: &mut Rig, milliseconds: usize) -> i32 {
    rig.milliseconds(milliseconds);
    rig.pulses_per_second()
}

// manual: 2.3.2/pv-pause 2.3.3/target 2.4.3/parameters 2.4.3/start 2.4.3/A 2.4.3/B 2.4.3/C 2.4.3/D 2.4.3/E 2.4.3/F 2.4.3/G
#[test]
fn halt_and_target_act_as_in_the_manuals_table() {
    let (v1, v2) = (10_000, 25_000);
    let mut rig = Rig::enabled(3);
    rig.command(HALT);
    rig.tick();
    assert_eq!(rig.pulses_per_second(), 0, "start");
    assert!(rig.status(10) && rig.status(12));

    rig.objects.target_velocity = v1;
    rig.command(RUN);
    assert!(!rig.status(10));
    assert_eq!(speed(&mut rig, 50), 5_005, "A: accelerates at 0x6083");
    assert_eq!(speed(&mut rig, 60), v1);
    assert!(rig.status(10) && !rig.status(12));

    rig.command(HALT);
    let slowing = speed(&mut rig, 50);
    assert!((4_990..=5_005).contains(&slowing), "B: decelerates at 0x6084, {slowing}");

    rig.command(RUN);
    assert!(rig.pulses_per_second() >= slowing, "C: accelerates before it stood");
    assert_eq!(speed(&mut rig, 60), v1);

    rig.objects.target_velocity = v2;
    rig.tick();
    assert!(!rig.status(10));
    assert_eq!(speed(&mut rig, 150), v2, "D");

    rig.objects.target_velocity = 0;
    assert_eq!(speed(&mut rig, 265), 0, "E");
    assert!(rig.status(10) && rig.status(12));

    rig.command(HALT);
    assert_eq!(speed(&mut rig, 20), 0, "F");
    rig.objects.target_velocity = v1;
    assert_eq!(speed(&mut rig, 20), 0, "G");
    assert!(rig.status(10), "with halt, bit 10 tells standstill");
}

// manual: 2.3.11/acceleration 2.3.12/deceleration 2.3.25/speed 2.4.3/direction 2.4.3/reversal
#[test]
fn a_reversal_decelerates_to_zero_and_accelerates_from_there() {
    let mut rig = Rig::enabled(3);
    rig.objects.profile_deceleration = 400_000;
    rig.objects.target_velocity = 10_000;
    rig.until("forward", |rig| rig.status(10));
    rig.objects.target_velocity = -10_000;
    rig.tick();
    let down = rig.until("turning", |rig| rig.pulses_per_second() <= 0);
    let up = rig.until("backward", |rig| rig.status(10));
    assert!((498..502).contains(&down) && (1_998..2_002).contains(&up), "{down} {up}");
}

// manual: 2.2.19/speed 2.2.20/speed 2.3.7/speed 2.3.25/speed
#[test]
fn speed_is_shown_in_revolutions_a_minute() {
    let mut rig = Rig::enabled(3);
    rig.objects.target_velocity = -20_000;
    rig.until("at speed", |rig| rig.status(10));
    assert_eq!(
        (rig.objects.velocity, rig.objects.speed_feedback, rig.objects.speed_reference),
        (-120, -120, -120)
    );
    rig.objects.target_velocity = 1_000_000;
    rig.objects.profile_acceleration = i32::MAX;
    rig.objects.profile_deceleration = i32::MAX;
    rig.until("at speed", |rig| rig.status(10));
    assert_eq!(
        (rig.objects.velocity, rig.objects.speed_feedback, rig.objects.speed_reference),
        (6_000, 3_000, 3_000)
    );
}

#[test]
fn a_filtered_velocity_is_reached_when_the_filter_has_it() {
    let mut rig = Rig::new();
    rig.objects.filter_time = 6_400;
    rig.objects.mode = 3;
    rig.enable();
    rig.objects.target_velocity = 7_001;
    let ticks = rig.until("at speed", |rig| !rig.status(12) && rig.status(10));
    assert_eq!(rig.pulses_per_second(), 7_001);
    assert!((1_400 + 126..1_400 + 132).contains(&ticks), "{ticks}");
}

// manual: 2.3.13/limit
#[test]
fn a_limit_switch_stops_with_0x6085_and_lets_the_other_direction_run() {
    for (switch, sign) in [(IN_POSITIVE_LIMIT, 1), (IN_NEGATIVE_LIMIT, -1)] {
        let mut rig = Rig::enabled(3);
        rig.objects.target_velocity = sign * 10_000;
        rig.until("at speed", |rig| rig.status(10));
        rig.inputs = switch;
        let ticks = rig.until("standing", |rig| rig.status(12));
        assert!((398..620).contains(&ticks), "{ticks}");
        assert!(rig.status(11) && !rig.status(10));
        rig.milliseconds(10);
        assert_eq!(rig.pulses_per_second(), 0);
        rig.objects.target_velocity = -sign * 5_000;
        rig.until("away", |rig| rig.pulses_per_second() == -sign * 5_000);
        assert_eq!(rig.state(), drive::PowerState::OperationEnabled);
    }
}

// manual: 2.2.16/counter
#[test]
fn running_on_for_longer_than_the_counter_wraps_it() {
    let mut rig = Rig::enabled(3);
    rig.objects.profile_acceleration = i32::MAX;
    rig.objects.profile_deceleration = i32::MAX;
    rig.objects.target_velocity = i32::MAX;
    let mut wraps = 0;
    for _ in 0..300_000 {
        let before = rig.objects.position;
        rig.tick();
        wraps += u32::from(rig.objects.position < before);
    }
    assert_eq!(wraps, 7);
}

#[test]
fn a_limit_switch_that_is_released_does_not_start_the_motor_again() {
    for (switch, sign) in [(IN_POSITIVE_LIMIT, 1), (IN_NEGATIVE_LIMIT, -1)] {
        for (what, word, target) in [("a halt", HALT, 10_000), ("zero", RUN, 0), ("the way back", RUN, -1)] {
            let mut rig = Rig::enabled(3);
            rig.objects.target_velocity = sign * 10_000;
            rig.until("at speed", |rig| rig.status(10));
            // A cam that is shorter than the stop.
            rig.inputs = switch;
            rig.ticks(20);
            rig.inputs = 0;
            let ticks = rig.until("standing", |rig| rig.status(12));
            assert!((378..600).contains(&ticks), "{ticks}");
            assert_eq!(speed(&mut rig, 100), 0);
            assert!(!rig.status(10) && !rig.status(11));

            rig.objects.target_velocity = sign * target;
            rig.command(word);
            rig.tick();
            rig.objects.target_velocity = sign * 10_000;
            rig.command(RUN);
            assert_eq!(speed(&mut rig, 200), sign * 10_000, "after {what}");
        }
    }
}

#[test]
fn on_a_limit_switch_from_the_start_only_the_way_back_runs() {
    let mut rig = Rig::enabled(3);
    rig.inputs = IN_POSITIVE_LIMIT;
    rig.objects.target_velocity = 10_000;
    assert_eq!(speed(&mut rig, 50), 0);
    rig.inputs = 0;
    assert_eq!(speed(&mut rig, 50), 0, "the command is an old one");
    rig.inputs = IN_POSITIVE_LIMIT;
    rig.objects.target_velocity = -10_000;
    assert_eq!(speed(&mut rig, 110), -10_000);
    rig.objects.target_velocity = 10_000;
    assert_eq!(speed(&mut rig, 300), 0);
    assert!(!rig.status(10) && rig.status(11) && rig.status(12));
}

#[test]
fn each_leg_of_a_reversal_takes_the_time_of_its_own_ramp_in_both_directions() {
    for sign in [1, -1] {
        let mut rig = Rig::enabled(3);
        rig.objects.profile_acceleration = 50_000;
        rig.objects.profile_deceleration = 200_000;
        rig.objects.target_velocity = sign * 20_000;
        assert!((7_999..=8_001).contains(&rig.until("forward", |rig| rig.status(10))));
        rig.objects.target_velocity = -sign * 20_000;
        let down = rig.until("turning", |rig| rig.pulses_per_second() * sign <= 0);
        let up = rig.until("backward", |rig| rig.status(10));
        assert!((1_999..=2_001).contains(&down) && (7_999..=8_001).contains(&up), "{down} {up}");
    }
}

#[test]
fn new_ramps_and_speeds_count_from_the_tick_that_sees_them() {
    let mut rig = Rig::enabled(3);
    rig.objects.target_velocity = 30_000;
    assert_eq!(speed(&mut rig, 100), 10_000);
    rig.objects.profile_acceleration = 200_000;
    assert_eq!(speed(&mut rig, 50), 20_000);
    rig.objects.target_velocity = 15_000;
    rig.objects.profile_deceleration = 50_000;
    assert_eq!(speed(&mut rig, 50), 17_500);
    assert_eq!(speed(&mut rig, 51), 15_000);
    assert!(rig.status(10));
}
