//! Current and direction of the field.

mod rig;

use board::{Milliamps, Sensors};
use rig::Rig;

fn angle(rig: &Rig) -> u32 {
    rig.drive.current_vector().expect("the power stage is on").angle.0
}

fn move_to(rig: &mut Rig, target: i32) {
    rig.objects.target_position = target;
    rig.command(0x0F);
    rig.command(0x1F);
    rig.until("there", |rig| rig.status(10));
}

// manual: 2.2.1/peak 2.2.10/ramp 2.2.10/time
#[test]
fn the_current_rises_in_twice_the_shaft_lock_time() {
    let mut rig = Rig::new();
    rig.objects.soft_lock_time = 1_000;
    rig.enable();
    let mut before = 0;
    for tick in 1..2_000 {
        let amplitude = rig.amplitude().unwrap();
        assert!((before..=before + 2).contains(&amplitude));
        assert_eq!(amplitude, 3_000 * tick / 2_000);
        before = amplitude;
        rig.tick();
    }
    assert_eq!(rig.amplitude(), Some(3_000));
}

// manual: 2.2.1/peak 2.2.3/time 2.2.4/current
#[test]
fn standby_comes_after_the_idle_time_and_ends_with_the_first_motion() {
    let mut rig = Rig::enabled(1);
    rig.objects.peak_current = 4_000;
    rig.objects.idle_current = 30;
    move_to(&mut rig, 1_000);
    rig.command(0x0F);
    rig.milliseconds(499);
    assert_eq!(rig.amplitude(), Some(4_000));
    rig.milliseconds(30);
    let falling = rig.amplitude().unwrap();
    assert!((1_300..3_900).contains(&falling), "{falling}");
    rig.milliseconds(30);
    assert_eq!(rig.amplitude(), Some(1_200));
    rig.objects.target_position = 0;
    rig.command(0x1F);
    assert!(rig.drive.is_moving());
    assert_eq!(rig.amplitude(), Some(4_000));
}

#[test]
fn standby_is_any_share_of_the_operating_current_and_its_objects_count_at_once() {
    for (percent, standby) in [(0, 0), (1, 30), (50, 1_500), (100, 3_000)] {
        let mut rig = Rig::enabled(1);
        rig.objects.idle_current = percent;
        rig.objects.idle_time = 200;
        rig.milliseconds(199);
        assert_eq!(rig.amplitude(), Some(3_000));
        rig.milliseconds(52);
        assert_eq!(rig.amplitude(), Some(standby), "{percent} %");
        rig.objects.idle_current = 80;
        rig.tick();
        assert_eq!(rig.amplitude(), Some(2_400));
        rig.objects.idle_time = 400;
        rig.tick();
        assert_eq!(rig.amplitude(), Some(3_000), "the longer time is not over");
    }
}

#[test]
fn targets_of_csp_that_do_not_move_let_standby_come_and_a_stop_in_another_state_too() {
    let mut rig = Rig::enabled(8);
    (0..600).for_each(|_| rig.cycle(0, board::Nanos(1_000_000)));
    assert_eq!(rig.amplitude(), Some(1_500));
    rig.cycle(1, board::Nanos(1_000_000));
    assert_eq!(rig.amplitude(), Some(3_000));
    rig.objects.quick_stop_option = 6;
    rig.command(0x02);
    rig.milliseconds(560);
    assert_eq!((rig.state(), rig.amplitude()), (drive::PowerState::QuickStopActive, Some(1_500)));
}

// manual: 2.2.2/turn
#[test]
fn a_turn_is_fifty_periods_at_any_resolution() {
    for resolution in [200u16, 333, 10_000, 51_200, 65_535] {
        let mut rig = Rig::new();
        rig.objects.resolution = resolution;
        rig.objects.mode = 1;
        rig.objects.profile_acceleration = 1_000;
        rig.enable();
        let start = angle(&rig);
        let quarter = i32::from(resolution) / 4;
        for k in [1, 3, -7] {
            move_to(&mut rig, quarter * k);
            let periods = 50.0 * f64::from(quarter * k) / f64::from(resolution);
            let expected = (periods.rem_euclid(1.0) * 2f64.powi(32)) as u32;
            let error = angle(&rig).wrapping_sub(start).wrapping_sub(expected) as i32;
            assert!(error.abs() < 64, "resolution {resolution}, {k} quarters: off by {error} of 2^32");
        }
    }
}

// manual: 2.2.13/reverse
#[test]
fn run_reverse_turns_the_field_the_other_way_and_changing_it_does_not_turn_it() {
    let mut rig = Rig::enabled(1);
    move_to(&mut rig, 1_010);
    let before = angle(&rig);
    rig.objects.run_reverse = 1;
    rig.objects.resolution = 20_000;
    rig.tick();
    assert_eq!(angle(&rig), before);
    move_to(&mut rig, 1_010 + 100);
    let quarter = before.wrapping_sub(angle(&rig)) as i32;
    assert!((quarter - (1 << 30)).abs() < 64, "{quarter}");
}

// manual: 2.4.4/feedback
#[test]
fn torque_is_the_measured_current_over_the_operating_current() {
    let mut rig = Rig::new();
    let sensors = Sensors {
        phase_currents: [Milliamps(-900), Milliamps(1_200)],
        ..Sensors::default()
    };
    rig.drive.tick(&sensors, &mut rig.objects);
    assert_eq!(rig.objects.torque, 500);
    let sensors = Sensors {
        phase_currents: [Milliamps(i32::MIN); 2],
        ..Sensors::default()
    };
    rig.drive.tick(&sensors, &mut rig.objects);
    assert!(rig.objects.torque > 10_000);
}
