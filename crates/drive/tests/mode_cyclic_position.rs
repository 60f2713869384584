//! Cyclic synchronous position mode.

mod rig;

use board::{Milliamps, Nanos, PowerStage, TICK};
use rig::{IN_NEGATIVE_LIMIT, IN_POSITIVE_LIMIT, Rig};

const MILLISECOND: Nanos = Nanos(1_000_000);

fn sine(cycle: i32, cycles_a_period: f64) -> i32 {
    (20_000.0 * (1.0 - (f64::from(cycle) / cycles_a_period * std::f64::consts::TAU).cos())) as i32
}

// manual: 2.3.8/csp 2.4.4/targets
#[test]
fn a_sine_is_followed_exactly_at_every_cycle() {
    for (cycle, ticks) in [
        (Nanos(500_000), 10),
        (MILLISECOND, 20),
        (Nanos(2_000_000), 40),
        (Nanos(4_000_000), 80),
    ] {
        let mut rig = Rig::enabled(8);
        for n in 0..1_000 {
            rig.cycle(sine(n, 500.0), cycle);
            assert_eq!(rig.objects.position, sine(n, 500.0), "cycle {n} of {ticks} ticks");
            assert!(rig.status(12) && rig.status(10));
        }
        assert_eq!(rig.objects.position, rig.shaft.round() as i32);
    }
}

#[test]
fn between_two_targets_the_motion_is_a_straight_line() {
    let mut rig = Rig::enabled(8);
    rig.objects.target_position = 200;
    rig.drive.synchronize(&rig.objects, Some(MILLISECOND));
    for n in 1..=20 {
        rig.tick();
        assert_eq!(rig.objects.position, n * 10);
    }
    rig.tick();
    assert_eq!(rig.objects.position, 200, "without a new target it stands");
}

#[test]
fn targets_count_at_the_synchronisation_only() {
    let mut rig = Rig::enabled(8);
    rig.cycle(100, MILLISECOND);
    rig.objects.target_position = 300;
    rig.milliseconds(5);
    assert_eq!(rig.objects.position, 100);
    rig.cycle(300, MILLISECOND);
    assert_eq!(rig.objects.position, 300);
}

#[test]
fn without_a_nominal_cycle_the_time_between_synchronisations_counts() {
    let mut rig = Rig::enabled(8);
    for n in 0..10 {
        rig.objects.target_position = n * 80;
        rig.drive.synchronize(&rig.objects, None);
        if n == 9 {
            rig.ticks(20);
            assert_eq!(rig.objects.position, 8 * 80 + 40);
            rig.ticks(20);
            assert_eq!(rig.objects.position, 9 * 80);
        }
        rig.ticks(40);
    }
}

#[test]
fn on_entry_the_set_point_is_where_the_axis_is() {
    let mut rig = Rig::new();
    rig.objects.mode = 8;
    rig.objects.target_position = 5_000;
    rig.command(0x06);
    rig.command(0x0F);
    rig.drive.synchronize(&rig.objects, Some(MILLISECOND));
    rig.tick();
    assert!(rig.status(12));
    rig.ticks(19);
    assert_eq!(rig.objects.position, 0);
}

#[test]
fn bits_10_and_12_are_0_unless_operation_is_enabled() {
    let mut rig = Rig::new();
    rig.objects.mode = 8;
    for word in [0x06, 0x07] {
        rig.command(word);
        assert!(!rig.status(10) && !rig.status(12));
    }
    rig.command(0x0F);
    assert_eq!(rig.objects.statusword, 0x1637);
}

// manual: 2.2.9/lag
#[test]
fn the_motion_filter_lags_by_its_time() {
    let mut rig = Rig::new();
    rig.objects.filter_time = 5_000;
    rig.objects.mode = 8;
    rig.enable();
    for n in 1..=100 {
        rig.cycle(n * 100, MILLISECOND);
    }
    // 100 ticks of filter and a speed of 5 pulses a tick: half the window behind.
    let lag = 10_000 - rig.objects.position;
    assert!((245..=250).contains(&lag), "{lag}");
    rig.milliseconds(5);
    assert_eq!(rig.objects.position, 10_000);
}

#[test]
fn halt_stops_with_0x6084_and_is_not_following() {
    let mut rig = Rig::enabled(8);
    for n in 1..=50 {
        rig.cycle(n * 10, MILLISECOND);
    }
    rig.objects.controlword = 0x10F;
    rig.cycle(510, MILLISECOND);
    assert!(!rig.status(12) && !rig.status(10));
    rig.until("standing", |rig| !rig.drive.is_moving());
    let stop = rig.objects.position;
    assert!((998..=1_002).contains(&stop), "10 000^2 / 200 000 = 500 pulses: {stop}");
    rig.cycle(stop + 50, MILLISECOND);
    assert_eq!(rig.objects.position, stop);
    rig.objects.controlword = 0x0F;
    rig.tick();
    rig.cycle(stop + 10, MILLISECOND);
    assert_eq!(rig.objects.position, stop + 10);
}

#[test]
fn a_limit_switch_stops_and_only_targets_away_from_it_are_followed() {
    for (switch, sign) in [(IN_POSITIVE_LIMIT, 1), (IN_NEGATIVE_LIMIT, -1)] {
        let mut rig = Rig::enabled(8);
        for n in 1..=100 {
            rig.cycle(sign * n * 10, MILLISECOND);
        }
        rig.inputs = switch;
        rig.cycle(sign * 1_010, MILLISECOND);
        assert!(rig.status(11) && !rig.status(12));
        for n in 102..=200 {
            rig.cycle(sign * n * 10, MILLISECOND);
        }
        let stop = rig.objects.position;
        assert!(
            (1_095..=1_102).contains(&(stop * sign)),
            "10 000^2 / 1 000 000 = 100 pulses: {stop}"
        );
        assert!(rig.status(11) && !rig.status(12));
        for n in (0..=200).rev() {
            let target = sign * n * 10;
            rig.cycle(target, MILLISECOND);
            let away = target * sign < stop * sign;
            assert_eq!(rig.objects.position, if away { target } else { stop });
            assert_eq!(rig.status(12), away || target == stop, "{target}");
        }
        assert_eq!(rig.state(), drive::PowerState::OperationEnabled);
    }
}

#[test]
fn after_another_mode_in_flight_it_brakes_first_and_follows_from_where_it_stands() {
    let mut rig = Rig::enabled(3);
    rig.objects.target_velocity = 10_000;
    rig.until("at speed", |rig| rig.status(10));
    rig.objects.mode = 8;
    rig.tick();
    assert_eq!(rig.objects.mode_display, 8);
    assert!(!rig.status(12));
    rig.until("following", |rig| rig.status(12));
    let stop = rig.objects.position;
    rig.cycle(stop, MILLISECOND);
    assert_eq!(rig.objects.position, stop);
}

#[test]
fn the_shorter_way_is_taken_where_the_counter_wraps() {
    let mut rig = Rig::enabled(1);
    rig.objects.profile_velocity = i32::MAX;
    rig.objects.profile_acceleration = i32::MAX;
    rig.objects.profile_deceleration = i32::MAX;
    rig.objects.target_position = i32::MAX;
    rig.command(0x1F);
    rig.until("at the end", |rig| rig.status(10));
    rig.objects.mode = 8;
    rig.ticks(2);
    rig.cycle(i32::MIN + 4, MILLISECOND);
    assert_eq!(rig.objects.position, i32::MIN + 4);
    assert_eq!(rig.pulses_per_second(), 5_000);
}

/// Targets at 10 pulses a cycle until the switch has stopped the axis; the position, and the cycles so far.
fn stopped_at(switch: u8, sign: i32) -> (Rig, i32) {
    let mut rig = Rig::enabled(8);
    (1..=100).for_each(|n| rig.cycle(sign * n * 10, MILLISECOND));
    rig.inputs = switch;
    (101..=200).for_each(|n| rig.cycle(sign * n * 10, MILLISECOND));
    assert!(!rig.drive.is_moving());
    (rig, 200)
}

#[test]
fn a_limit_switch_that_is_released_does_not_make_the_axis_jump_to_the_masters_target() {
    for (switch, sign) in [(IN_POSITIVE_LIMIT, 1), (IN_NEGATIVE_LIMIT, -1)] {
        let (mut rig, cycles) = stopped_at(switch, sign);
        let stop = rig.objects.position;
        rig.inputs = 0;
        for n in (stop * sign / 10 + 1..cycles).rev() {
            rig.cycle(sign * n * 10, MILLISECOND);
            assert_eq!((rig.objects.position, rig.status(12)), (stop, false), "{n}");
        }
        // The master has come back to where the axis stands: from here on it is followed, also beyond.
        rig.cycle(stop - sign, MILLISECOND);
        assert_eq!((rig.objects.position, rig.status(12)), (stop - sign, true));
        rig.cycle(stop + sign * 9, MILLISECOND);
        assert_eq!((rig.objects.position, rig.status(12)), (stop + sign * 9, true));
    }
}

/// Follows a sine whose synchronisations come at multiples of `cycle`, in or between ticks; checks the position at each of them, without a
/// nominal cycle from the third one on.
fn follow(cycle: u64, is_nominal: bool) {
    let mut rig = Rig::enabled(8);
    let mut cycles = 0;
    let target = |n: u64| sine(n as i32, 1e9 / cycle as f64);
    for tick in 0..40_000 {
        let latest = tick * TICK.0 / cycle;
        if latest * cycle + TICK.0 > tick * TICK.0 && latest == cycles {
            if cycles > if is_nominal { 0 } else { 2 } {
                assert_eq!(rig.objects.position, target(cycles), "cycle {cycles} of {cycle} ns");
            }
            cycles += 1;
            rig.objects.target_position = target(cycles);
            rig.drive.synchronize(&rig.objects, is_nominal.then_some(Nanos(cycle)));
        }
        rig.tick();
        assert!(rig.status(10) && rig.status(12));
    }
    assert!(cycles >= 2_000_000_000 / cycle);
}

#[test]
fn any_cycle_from_500_us_up_is_followed_exactly_whole_ticks_or_not() {
    for microseconds in [500, 525, 625, 750, 999, 1_000, 1_001, 1_333, 2_000, 2_500, 4_000, 10_000, 100_000] {
        follow(microseconds * 1_000, true);
    }
    follow(976_562, true);
}

#[test]
fn a_cycle_of_whole_ticks_is_followed_exactly_without_being_told() {
    for microseconds in [500, 750, 1_000, 2_000, 4_000, 10_000] {
        follow(microseconds * 1_000, false);
    }
}

#[test]
fn a_jump_of_the_target_is_travelled_within_its_cycle() {
    let mut rig = Rig::enabled(8);
    rig.cycle(10, MILLISECOND);
    for target in [1_000_000, -2_000_000, 0] {
        rig.cycle(target, MILLISECOND);
        assert_eq!((rig.objects.position, rig.status(12)), (target, true));
        rig.cycle(target, MILLISECOND);
        assert_eq!((rig.objects.position, rig.pulses_per_second()), (target, 0));
    }
}

#[test]
fn a_late_target_is_waited_for_and_a_missing_one_is_made_up_for_by_the_next() {
    let mut rig = Rig::enabled(8);
    rig.cycle(100, MILLISECOND);
    rig.ticks(3);
    assert_eq!((rig.objects.position, rig.pulses_per_second()), (100, 0), "late by three ticks");
    assert!(rig.status(12), "a late target is no loss of the command");
    rig.cycle(200, MILLISECOND);
    assert_eq!(rig.objects.position, 200);
    // Synchronisation with outputs that did not come: the old target is there again.
    rig.cycle(200, MILLISECOND);
    assert_eq!((rig.objects.position, rig.pulses_per_second()), (200, 0));
    rig.cycle(400, MILLISECOND);
    assert_eq!((rig.objects.position, rig.pulses_per_second()), (400, 200_000));
}

#[test]
fn targets_sent_before_enabling_or_in_another_mode_are_not_followed() {
    let mut rig = Rig::enabled(1);
    rig.cycle(5_000, MILLISECOND);
    rig.objects.mode = 8;
    rig.drive.synchronize(&rig.objects, Some(MILLISECOND));
    rig.ticks(40);
    assert_eq!((rig.objects.position, rig.status(12)), (0, true));
    rig.command(0x07);
    rig.cycle(6_000, MILLISECOND);
    rig.command(0x0F);
    rig.ticks(40);
    assert_eq!((rig.objects.position, rig.status(12)), (0, true));
    rig.cycle(7, MILLISECOND);
    assert_eq!(rig.objects.position, 7);
}

#[test]
fn targets_do_not_count_while_the_motor_waits_for_its_first_current() {
    let mut rig = Rig::new();
    rig.objects.auto_pi = 1;
    rig.objects.mode = 8;
    rig.enable();
    // Somebody turns the shaft so fast that the diodes conduct, and the offsets of the sensors stay unknown.
    for n in 1..=1_000 {
        rig.readings = Some([Milliamps(300 * (n % 2)), Milliamps(0)]);
        rig.objects.target_position = n;
        rig.drive.synchronize(&rig.objects, None);
        rig.tick();
        assert_eq!((rig.actuators.stage, rig.objects.position), (PowerStage::Off, 0));
        assert!(!rig.drive.is_moving() && !rig.status(12));
    }
    rig.readings = Some([Milliamps(0); 2]);
    rig.until("on", |rig| rig.actuators.stage != PowerStage::Off);
    rig.cycle(1_000, MILLISECOND);
    rig.cycle(1_010, MILLISECOND);
    assert_eq!(rig.objects.position, 1_010);
}
