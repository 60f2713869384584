//! Every fault the drive detects: where it shows, how the motor stops, and what clears it.

mod rig;

use board::{Milliamps, Millivolts};
use drive::Alarm;
use drive::PowerState::*;
use rig::Rig;

struct Case {
    code: u16,
    alarm_bit: u16,
    alarm: Alarm,
    provoke: fn(&mut Rig),
    /// What takes the cause away.
    cure: fn(&mut Rig),
    /// Whether the cause outlasts the power stage.
    lasts: bool,
    /// Whether the motor is stopped as 0x605E says, and not switched off at once.
    stops: bool,
}

const CASES: [Case; 6] = [
    Case {
        code: 0x7500,
        alarm_bit: 0,
        alarm: Alarm::Disabled,
        provoke: |rig| rig.drive.set_network(false),
        cure: |rig| rig.drive.set_network(true),
        lasts: true,
        stops: true,
    },
    Case {
        code: 0x3110,
        alarm_bit: 0x0004,
        alarm: Alarm::Fault { red: 2 },
        provoke: |rig| rig.bus = Millivolts(60_001),
        cure: |rig| rig.bus = Millivolts(60_000),
        lasts: true,
        stops: true,
    },
    Case {
        code: 0x5530,
        alarm_bit: 0,
        alarm: Alarm::Fault { red: 6 },
        provoke: |rig| rig.drive.parameters_lost(),
        cure: |_| (),
        lasts: false,
        stops: true,
    },
    Case {
        code: 0x3210,
        alarm_bit: 0x0001,
        alarm: Alarm::Fault { red: 3 },
        provoke: |rig| rig.bus = Millivolts(14_999),
        cure: |rig| rig.bus = Millivolts(18_000),
        lasts: true,
        stops: true,
    },
    Case {
        code: 0x2211,
        alarm_bit: 0x0002,
        alarm: Alarm::Fault { red: 1 },
        provoke: |rig| rig.readings = Some([Milliamps(0), Milliamps(-12_001)]),
        cure: |rig| rig.readings = None,
        lasts: false,
        stops: false,
    },
    Case {
        code: 0x7122,
        alarm_bit: 0,
        alarm: Alarm::Fault { red: 7 },
        provoke: |rig| {
            rig.objects.error_detection = 0x0080;
            rig.readings = Some([Milliamps(0), Milliamps(2_000)]);
        },
        cure: |rig| rig.readings = None,
        lasts: false,
        stops: false,
    },
];

/// What clears a fault: bit 7 of the controlword, or IN1 with function 4; both with what comes before the next attempt.
const RESETS: [fn(&mut Rig); 2] = [
    |rig| {
        rig.command(0x00);
        rig.command(0x80);
    },
    |rig| {
        rig.inputs = 0;
        rig.tick();
        rig.inputs = 1;
        rig.tick();
    },
];

/// A drive that runs in PV, with an alarm on OUT1 and fault clearance on IN1.
fn running(error_detection: u16) -> Rig {
    let mut rig = Rig::enabled(3);
    rig.objects.error_detection = error_detection;
    rig.objects.input_1_function = 4;
    rig.objects.target_velocity = 20_000;
    rig.until("at speed", |rig| rig.pulses_per_second() == 20_000);
    rig
}

/// 0x603F, 0x200E, the failed bit of 0x200F, and the alarm output.
fn shown(rig: &Rig) -> (u16, u16, bool, bool) {
    let objects = &rig.objects;
    let output = rig.actuators.outputs.0 & 1 == 1;
    (objects.error_code, objects.alarm_code, objects.status_code & 0x02 != 0, output)
}

// manual: 1.6/disabled 1.6/working 1.6/overvoltage 1.6/parameters 2.2.5/alarm 2.2.7/fault-clear 2.2.14/overvoltage
// manual: 2.2.14/reserved 2.2.14/cleared 2.2.15/failed 2.3.1/object 2.3.1/cleared 2.3.1/7500 2.3.1/3110 2.3.1/5530 2.3.2/reset
// manual: 1.6/overcurrent 1.6/phase-loss 2.2.14/overcurrent 2.3.1/2211 2.3.1/7122 2.3.1/3210
#[test]
fn each_fault_shows_in_all_its_places_stops_as_0x605e_says_and_is_cleared_once_its_cause_is_gone() {
    for case in &CASES {
        for (option, ramp) in [(0, 0), (1, 4_000), (2, 800)] {
            for (reset, error_detection) in RESETS.into_iter().zip([0x0080, 0]) {
                let context = format!("{:04X} with option {option}", case.code);
                let mut rig = running(error_detection);
                rig.objects.fault_reaction_option = option;
                (case.provoke)(&mut rig);
                rig.until("detected", |rig| rig.state() == FaultReactionActive);
                assert_eq!(shown(&rig), (case.code, case.alarm_bit, true, true), "{context}");
                let ticks = rig.until("in fault", |rig| rig.state() == Fault);
                let ramp = if case.stops { ramp } else { 0 };
                assert!((ramp..ramp + 230).contains(&ticks), "{context}: {ticks}");
                assert_eq!(shown(&rig), (case.code, case.alarm_bit, true, true), "{context}");
                assert_eq!((rig.is_powered(), rig.drive.alarm()), (false, case.alarm), "{context}");
                if case.lasts {
                    reset(&mut rig);
                    assert_eq!(rig.state(), Fault, "{context}: the cause is still there");
                }
                (case.cure)(&mut rig);
                rig.tick();
                rig.milliseconds(10);
                assert_eq!(rig.state(), Fault, "{context}: nobody has cleared it");
                reset(&mut rig);
                assert_eq!((rig.state(), shown(&rig)), (SwitchOnDisabled, (0, 0, false, false)), "{context}");
                assert_eq!(rig.drive.alarm(), Alarm::Disabled, "{context}");
                rig.enable();
                assert_eq!(rig.drive.alarm(), Alarm::Enabled, "{context}");
            }
        }
    }
}

#[test]
fn a_fault_of_a_motor_that_is_off_is_shown_and_cleared_alike_but_the_network_may_go() {
    for case in &CASES[1..3] {
        let mut rig = Rig::new();
        (case.provoke)(&mut rig);
        rig.until("in fault", |rig| rig.state() == Fault);
        assert_eq!(shown(&rig), (case.code, case.alarm_bit, true, true));
    }
    let mut rig = Rig::new();
    rig.drive.set_network(false);
    rig.milliseconds(10);
    assert_eq!((rig.state(), shown(&rig)), (SwitchOnDisabled, (0, 0, false, false)));
}

// manual: 1.1.2/supply 2.3.3/voltage
#[test]
fn a_supply_out_of_range_but_not_dangerous_is_told_by_bit_4_and_no_fault() {
    for millivolts in [15_000, 17_999, 50_001, 60_000] {
        let mut rig = running(0x0080);
        rig.bus = Millivolts(millivolts);
        rig.milliseconds(10);
        assert_eq!((rig.state(), rig.status(4), rig.objects.error_code), (OperationEnabled, false, 0));
        assert_eq!(rig.pulses_per_second(), 20_000);
    }
}

// manual: 1.6/internal-voltage 2.2.14/internal-voltage 2.3.1/3150 2.3.1/3151
#[test]
fn a_current_sensor_that_reads_more_than_5_percent_without_a_current_is_a_fault_of_its_circuit_as_long_as_it_does() {
    for (phase, code) in [(0, 0x3150), (1, 0x3151)] {
        for sign in [-1, 1] {
            let mut readings = [Milliamps(20); 2];
            readings[phase] = Milliamps(640 * sign);
            let mut rig = Rig::new();
            rig.readings = Some(readings);
            rig.milliseconds(10);
            assert_eq!(rig.state(), SwitchOnDisabled, "5 percent are allowed");
            readings[phase] = Milliamps(641 * sign);
            rig.readings = Some(readings);
            rig.until("in fault", |rig| rig.state() == Fault);
            assert_eq!(shown(&rig), (code, 0x0001, true, true));
            assert_eq!(rig.drive.alarm(), Alarm::Fault { red: 3 });
            RESETS[0](&mut rig);
            assert_eq!(rig.state(), Fault, "the cause is still there");
            rig.readings = None;
            rig.milliseconds(10);
            RESETS[0](&mut rig);
            assert_eq!((rig.state(), shown(&rig)), (SwitchOnDisabled, (0, 0, false, false)));
        }
    }
}

// manual: 1.6/mask
#[test]
fn with_bit_7_of_0x2056_at_0_a_lost_phase_is_no_fault() {
    let mut rig = running(0xFF7F);
    rig.readings = Some([Milliamps(0); 2]);
    rig.milliseconds(100);
    assert_eq!((rig.state(), rig.objects.error_code), (OperationEnabled, 0));
    rig.objects.error_detection = 0x0080;
    rig.until("detected", |rig| rig.state() == Fault);
    assert_eq!(rig.objects.error_code, 0x7122);
}

#[test]
fn a_stop_that_pumps_the_bus_beyond_63_v_ends_at_once() {
    let mut rig = running(0);
    rig.bus = Millivolts(62_000);
    rig.until("stopping", |rig| rig.state() == FaultReactionActive);
    rig.milliseconds(10);
    assert_eq!((rig.state(), rig.is_powered()), (FaultReactionActive, true));
    rig.bus = Millivolts(63_001);
    rig.ticks(2);
    assert_eq!((rig.state(), rig.is_powered()), (Fault, false));
}
