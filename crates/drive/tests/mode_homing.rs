//! Homing mode against switches that the shaft meets, with the default filters on.

mod rig;

use dictionary::AbortCode;
use drive::PowerState;
use rig::{Rig, Travel};

const RUNNING: (bool, bool, bool) = (false, false, false);
const IDLE: (bool, bool, bool) = (false, false, true);
const DONE: (bool, bool, bool) = (false, true, true);
const FAILED: (bool, bool, bool) = (true, false, true);

/// Edges of the home switch and the limits of travel, in shaft pulses.
const HOME: std::ops::Range<f64> = 3_000.0..4_000.0;
const NEGATIVE_END: f64 = -12_000.0;
const POSITIVE_END: f64 = 12_000.0;

/// A homing axis that stands at `start`, enabled, with all filters as delivered if `filtered`.
fn axis(start: i32, filtered: bool) -> Rig {
    let mut rig = Rig::new();
    if filtered {
        rig.objects.filter_time = 6_400;
        rig.objects.input_filter = 60;
    }
    rig.objects.mode = 1;
    rig.enable();
    rig.objects.target_position = start;
    rig.command(0x1F);
    rig.until("at the start", |rig| rig.status(10));
    rig.command(0x0F);
    rig.travel = Some(Travel {
        negative_limit_below: NEGATIVE_END,
        positive_limit_from: POSITIVE_END,
        home: HOME,
    });
    rig.objects.mode = 6;
    rig.milliseconds(20);
    rig
}

fn home(rig: &mut Rig, method: i8) -> (bool, bool, bool) {
    rig.objects.homing_method = method;
    rig.command(0x1F);
    assert_eq!(rig.homing_bits(), RUNNING, "bits drop in the cycle of the start");
    rig.command(0x0F);
    rig.until("over", |rig| rig.status(10));
    assert!(!rig.drive.is_moving());
    rig.homing_bits()
}

// manual: 2.2.15/homed 2.3.9/offset 2.4.6/parameters 2.4.6/status 2.4.6.1/17 2.4.6.1/18 2.4.6.1/19 2.4.6.1/20 2.4.6.1/21
#[test]
fn every_method_from_every_side_ends_with_its_edge_at_the_home_offset() {
    let (near, far) = (HOME.start, HOME.end);
    let cases = [
        (17, -12_500, NEGATIVE_END),
        (17, 0, NEGATIVE_END),
        (17, 3_500, NEGATIVE_END),
        (18, 12_500, POSITIVE_END),
        (18, 0, POSITIVE_END),
        (18, 3_500, POSITIVE_END),
        (19, -2_000, near),
        (19, 3_500, near),
        (19, 8_000, near),
        (20, -2_000, near),
        (20, 3_500, near),
        (20, 8_000, near),
        (21, -2_000, far),
        (21, 3_500, far),
        (21, 8_000, far),
    ];
    for (method, start, edge) in cases {
        for (filtered, delay) in [(false, 2.0), (true, 32.0)] {
            let mut rig = axis(start, filtered);
            rig.objects.home_offset = 777;
            assert_eq!(home(&mut rig, method), DONE, "method {method} from {start}");
            // The counter reads 777 at the edge as the drive saw it, up to the filter's delay after the switch.
            let at_edge = rig.shaft - f64::from(rig.objects.position - 777);
            assert!((at_edge - edge).abs() <= delay, "method {method} from {start}: {at_edge}");
            assert_eq!(rig.objects.status_code & 0x10, 0x10);
        }
    }
}

// manual: 2.3.13/homing
#[test]
fn what_is_travelled_after_the_edge_stays_visible() {
    let mut rig = axis(0, false);
    assert_eq!(home(&mut rig, 17), DONE);
    // 10 000^2 / (2 * 500 000), and up to a pulse more to stand on one.
    assert!((-102..=-98).contains(&rig.objects.position), "{}", rig.objects.position);
}

#[test]
fn homing_can_be_repeated_on_the_switch_and_finds_the_same_place() {
    let mut rig = axis(-2_000, false);
    home(&mut rig, 19);
    let origin = rig.shaft - f64::from(rig.objects.position);
    for _ in 0..3 {
        assert_eq!(home(&mut rig, 19), DONE);
        assert!((rig.shaft - f64::from(rig.objects.position) - origin).abs() < 1.5);
    }
}

// manual: 2.4.6.1/35
#[test]
fn method_35_takes_the_present_position_and_still_shows_a_run() {
    let mut rig = axis(5_000, true);
    rig.objects.home_offset = -300;
    rig.objects.homing_method = 35;
    let angle = rig.actuators.stage;
    rig.command(0x1F);
    rig.tick();
    assert_eq!((rig.objects.position, rig.actuators.stage), (-300, angle));
    assert_eq!(rig.homing_bits(), RUNNING);
    let ticks = rig.until("done", |rig| rig.homing_bits() == DONE);
    assert!(ticks >= 190, "masters with cycles of some milliseconds see it run: {ticks}");
}

#[test]
fn the_field_does_not_jump_when_the_counter_is_set() {
    let mut rig = axis(-2_000, false);
    rig.objects.home_offset = 1_234_567;
    rig.objects.homing_method = 19;
    rig.command(0x1F);
    let mut shaft = rig.shaft;
    rig.until("over", |rig| rig.status(10));
    assert!((rig.shaft - HOME.start).abs() < 60.0, "{}", rig.shaft);
    rig.objects.mode = 1;
    for _ in 0..100 {
        rig.tick();
        assert!((rig.shaft - shaft).abs() < 6_000.0);
        shaft = rig.shaft;
    }
}

#[test]
fn the_mode_and_the_start_may_come_in_one_frame() {
    let mut rig = axis(0, false);
    rig.objects.mode = 8;
    rig.milliseconds(10);
    rig.objects.mode = 6;
    rig.objects.homing_method = 17;
    rig.command(0x1F);
    assert_eq!((rig.homing_bits(), rig.objects.mode_display), (RUNNING, 6));
    rig.until("done", |rig| rig.homing_bits() == DONE);
}

#[test]
fn homing_starts_straight_after_enabling() {
    let mut rig = Rig::new();
    rig.objects.mode = 6;
    rig.objects.homing_method = 35;
    rig.command(0x06);
    rig.objects.controlword = 0x1F;
    rig.until("done", |rig| rig.homing_bits() == DONE);
}

// manual: 2.3.2/homing-start
#[test]
fn bit_4_may_fall_and_a_second_edge_while_running_changes_nothing() {
    let mut rig = axis(0, false);
    rig.objects.homing_method = 17;
    rig.command(0x1F);
    rig.command(0x0F);
    rig.milliseconds(200);
    rig.command(0x1F);
    assert_eq!(rig.pulses_per_second(), -10_000);
    assert_eq!(rig.homing_bits(), RUNNING);
    rig.until("done", |rig| rig.homing_bits() == DONE);
}

// manual: 2.3.2/homing-start 2.3.2/homing-pause 2.3.16/ramps 2.4.6/stop 2.4.6/status
#[test]
fn halt_interrupts_and_a_new_edge_starts_again() {
    let mut rig = axis(0, false);
    rig.objects.homing_method = 17;
    rig.command(0x1F);
    rig.milliseconds(200);
    rig.command(0x11F);
    assert_eq!(rig.homing_bits(), RUNNING, "still moving");
    let ticks = rig.until("standing", |rig| rig.homing_bits() == IDLE);
    assert!((1_998..2_220).contains(&ticks), "0x609A: {ticks}");
    rig.command(0x1F);
    rig.milliseconds(100);
    assert_eq!(
        (rig.homing_bits(), rig.drive.is_moving()),
        (IDLE, false),
        "the end of halt is no start"
    );
    rig.command(0x0F);
    assert_eq!(home(&mut rig, 17), DONE);
}

#[test]
fn a_change_of_mode_interrupts_and_brakes() {
    let mut rig = axis(0, false);
    rig.objects.homing_method = 17;
    rig.command(0x1F);
    rig.milliseconds(200);
    rig.objects.mode = 1;
    rig.tick();
    assert_eq!(rig.objects.mode_display, 1);
    rig.until("standing", |rig| rig.status(10));
    rig.objects.mode = 6;
    rig.milliseconds(20);
    assert_eq!(rig.homing_bits(), IDLE);
    assert_eq!(rig.objects.status_code & 0x10, 0);
}

// manual: 2.4.6/parameters 2.4.6/status
#[test]
fn what_cannot_be_homed_is_a_homing_error_and_no_fault() {
    let start = |method: i8, prepare: fn(&mut Rig)| {
        let mut rig = axis(0, false);
        prepare(&mut rig);
        rig.objects.homing_method = method;
        rig.command(0x1F);
        assert_eq!(rig.homing_bits(), FAILED, "method {method}");
        assert_eq!((rig.state(), rig.objects.error_code), (PowerState::OperationEnabled, 0));
        rig.command(0x0F);
        rig
    };
    start(31, |_| {});
    start(17, |rig| rig.objects.input_4_function = 0);
    start(19, |rig| rig.objects.input_5_function = 0);
    start(19, |rig| {
        rig.inputs = rig::IN_NEGATIVE_LIMIT | rig::IN_POSITIVE_LIMIT;
        rig.tick();
    });
    let mut rig = start(31, |_| {});
    assert_eq!(home(&mut rig, 17), DONE, "a new start clears the error");
}

#[test]
fn a_search_that_finds_nothing_ends_in_an_error() {
    let mut rig = axis(0, false);
    rig.travel.as_mut().unwrap().home = 1e9..2e9;
    rig.objects.homing_method = 19;
    rig.command(0x1F);
    rig.until("given up", |rig| rig.status(13));
    assert_eq!(rig.homing_bits(), (true, false, false), "it still moves");
    rig.until("standing", |rig| !rig.drive.is_moving());
    assert_eq!((rig.homing_bits(), rig.state()), (FAILED, PowerState::OperationEnabled));
    assert!((rig.shaft - NEGATIVE_END).abs() < 10.0, "at the second limit, {}", rig.shaft);
}

#[test]
fn without_limit_switches_it_searches_until_it_is_stopped() {
    let mut rig = axis(0, false);
    rig.objects.input_3_function = 0;
    rig.objects.input_4_function = 0;
    rig.travel.as_mut().unwrap().home = 1e9..2e9;
    rig.objects.homing_method = 24;
    rig.command(0x1F);
    rig.milliseconds(20_000);
    assert_eq!((rig.homing_bits(), rig.pulses_per_second()), (RUNNING, 2_000));
    rig.command(0x10F);
    rig.until("standing", |rig| rig.homing_bits() == IDLE);
}

#[test]
fn halted_in_front_of_a_limit_it_brakes_there_with_the_deceleration_at_switches() {
    let mut rig = axis(-11_000, false);
    rig.objects.homing_acceleration = 100_000;
    rig.objects.homing_method = 27;
    rig.command(0x1F);
    rig.until("close", |rig| rig.shaft < NEGATIVE_END + 20.0);
    rig.objects.homing_acceleration = 10;
    rig.command(0x11F);
    rig.until("standing", |rig| rig.homing_bits() == IDLE);
    // 10 000^2 / (2 * 500 000)
    assert!((rig.shaft - NEGATIVE_END + 100.0).abs() < 3.0, "{}", rig.shaft);
}

#[test]
fn method_and_variant_are_those_of_the_start() {
    let mut rig = axis(0, false);
    rig.objects.homing_method = 17;
    rig.command(0x1F);
    rig.milliseconds(100);
    rig.objects.homing_method = 18;
    rig.objects.homing_variant = 1;
    rig.until("done", |rig| rig.homing_bits() == DONE);
    assert!((rig.shaft - f64::from(rig.objects.position) - NEGATIVE_END).abs() < 2.0);
}

#[test]
fn methods_that_the_drive_does_not_have_are_refused_by_sdo() {
    let mut rig = Rig::new();
    for method in 17..=35_u8 {
        let answer = match method {
            31..=34 => Err(AbortCode::ValueRange),
            _ => Ok(()),
        };
        assert_eq!(rig.download(0x6098, 0, &[method]), answer, "method {method}");
    }
    assert_eq!(rig.download(0x6098, 0, &[16]), Err(AbortCode::ValueTooLow));
    assert_eq!(rig.download(0x6098, 0, &[36]), Err(AbortCode::ValueTooHigh));
    assert_eq!(rig.objects.homing_method, 35);
}
