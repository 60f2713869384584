//! What inputs do to the drive, and what outputs tell.

mod rig;

use board::{OutputLevels, PowerStage};
use dictionary::AbortCode;
use drive::PowerState::*;
use rig::{IN_HOME, IN_NEGATIVE_LIMIT, IN_OFFLINE, IN_POSITIVE_LIMIT, Rig};

fn running() -> Rig {
    let mut rig = Rig::enabled(3);
    rig.objects.target_velocity = 20_000;
    rig.until("at speed", |rig| rig.pulses_per_second() == 20_000);
    rig
}

// manual: 2.2.7/state 2.2.22/level 2.2.24/time 2.3.23/inputs 2.3.23/switches
#[test]
fn the_input_objects_show_raw_levels_and_valid_signals() {
    let mut rig = Rig::new();
    rig.inputs = IN_POSITIVE_LIMIT | IN_HOME | 0x01;
    rig.tick();
    assert_eq!((rig.objects.input_level, rig.objects.digital_inputs), (0x15, 0x0015_0006));
    rig.objects.input_polarity = 0;
    rig.tick();
    assert_eq!((rig.objects.input_level, rig.objects.digital_inputs), (0x15, 0x002A_0001));
    rig.inputs = IN_NEGATIVE_LIMIT;
    rig.objects.input_polarity = 0x3F;
    rig.objects.input_filter = 60;
    rig.ticks(60);
    assert_eq!(
        (rig.objects.input_level, rig.objects.digital_inputs),
        (0x08, 0x0015_0006),
        "2049 is not filtered"
    );
    rig.tick();
    assert_eq!(rig.objects.digital_inputs, 0x0008_0001);
}

// manual: 2.2.7/emergency-stop
#[test]
fn emergency_stop_stops_quickly_and_wants_a_new_enable_sequence() {
    for option in [0, 1, 2, 5, 6] {
        let mut rig = running();
        rig.objects.quick_stop_option = option;
        rig.objects.input_1_function = 5;
        rig.inputs = 0x01;
        rig.tick();
        assert_eq!((rig.state(), rig.is_powered()), (QuickStopActive, true));
        let ticks = rig.until("disabled", |rig| rig.state() == SwitchOnDisabled);
        assert!((798..1_020).contains(&ticks), "0x6085, whatever the option: {ticks}");
        assert!(!rig.is_powered());
        for word in [0x06, 0x0F, 0x0F, 0x0F] {
            rig.command(word);
            assert_eq!(rig.state(), SwitchOnDisabled);
        }
        rig.inputs = 0;
        rig.ticks(10);
        assert_eq!((rig.state(), rig.objects.error_code), (SwitchOnDisabled, 0));
        rig.enable();
    }
}

#[test]
fn emergency_stop_at_power_up_ends_the_courtesy() {
    let mut rig = Rig::new();
    rig.objects.input_1_function = 5;
    rig.inputs = 0x01;
    rig.command(0x0F);
    rig.inputs = 0;
    rig.ticks(10);
    assert_eq!(rig.state(), SwitchOnDisabled);
}

// manual: 2.2.7/offline
#[test]
fn motor_offline_frees_the_shaft_and_the_release_holds_it_again() {
    let mut rig = running();
    rig.objects.soft_lock_time = 100;
    rig.inputs = IN_OFFLINE;
    rig.tick();
    assert_eq!((rig.state(), rig.actuators.stage), (OperationEnabled, PowerStage::Off));
    let position = rig.objects.position;
    rig.milliseconds(10);
    assert_eq!((rig.objects.position, rig.objects.velocity), (position, 0));
    rig.inputs = 0;
    rig.tick();
    assert_eq!(rig.amplitude(), Some(15), "the shaft is locked anew");
    rig.until("at speed", |rig| rig.pulses_per_second() == 20_000);
}

#[test]
fn set_points_are_not_taken_while_the_motor_is_offline() {
    let mut rig = Rig::enabled(1);
    rig.inputs = IN_OFFLINE;
    rig.objects.target_position = 1_000;
    rig.command(0x1F);
    assert!(!rig.status(12));
    rig.inputs = 0;
    rig.milliseconds(50);
    assert_eq!((rig.objects.position, rig.status(12)), (0, false));
}

/// A drive in fault whose cause is gone, with IN1 and IN2 that clear faults.
fn faulty() -> Rig {
    let mut rig = Rig::new();
    (rig.objects.input_1_function, rig.objects.input_2_function) = (4, 4);
    rig.drive.parameters_lost();
    rig.until("in fault", |rig| rig.state() == Fault);
    rig
}

// manual: 2.2.7/fault-clear
#[test]
fn each_of_several_fault_clear_inputs_counts_by_its_own_edge() {
    let mut rig = faulty();
    rig.inputs = 0x01;
    rig.tick();
    assert_eq!(rig.state(), SwitchOnDisabled);
    rig.drive.parameters_lost();
    rig.until("in fault again", |rig| rig.state() == Fault);
    rig.inputs = 0x03;
    rig.tick();
    assert_eq!(rig.state(), SwitchOnDisabled, "IN1 that is held does not hide IN2");
}

#[test]
fn neither_polarity_nor_function_nor_power_on_make_an_edge_that_clears_faults() {
    let mut rig = faulty();
    rig.objects.input_polarity = 0;
    rig.ticks(10);
    assert_eq!(rig.state(), Fault);
    rig.objects.input_1_function = 0;
    rig.tick();
    rig.objects.input_1_function = 4;
    rig.ticks(10);
    assert_eq!(rig.state(), Fault);
    let mut rig = Rig::at_power_up();
    rig.objects.input_1_function = 4;
    rig.inputs = 0x01;
    rig.drive.parameters_lost();
    rig.ticks(100);
    assert_eq!(rig.state(), Fault);
}

// manual: 1.3/counts 1.3.1/settings 2.2.7/general 2.2.7/cw-limit 2.2.7/ccw-limit 2.2.7/home 2.2.7/emergency-stop 2.2.7/offline
// manual: 2.2.7/probe-1 2.2.7/probe-2 2.2.8/polarity 2.2.22/level 2.3.23/inputs 2.3.23/reserved
#[test]
fn every_function_works_at_every_input_in_both_polarities_and_at_two_inputs_at_once() {
    type Sign = fn(&Rig) -> bool;
    let signals: [(u16, Sign); 8] = [
        (0, |_| false),
        (1, |rig| rig.objects.digital_inputs & 0b010 != 0 && rig.status(11)),
        (2, |rig| rig.objects.digital_inputs & 0b001 != 0 && rig.status(11)),
        (3, |rig| rig.objects.digital_inputs & 0b100 != 0),
        (5, |rig| rig.state() == QuickStopActive),
        (6, |rig| !rig.is_powered()),
        (7, |rig| rig.objects.probe_status == 0x0103),
        (8, |rig| rig.objects.probe_status == 0x0301),
    ];
    for (function, is_active) in signals {
        for input in 1..=6 {
            for twin in [input, input % 6 + 1] {
                for normally_open in [true, false] {
                    let mut rig = Rig::new();
                    for number in 1..=6 {
                        let wanted = if number == input || number == twin { function } else { 0 };
                        rig.download(0x2007, number, &wanted.to_le_bytes()).unwrap();
                    }
                    let at_rest = if normally_open { 0x00 } else { 0x3F };
                    rig.objects.input_polarity = u16::from(0x3F & !at_rest);
                    rig.inputs = at_rest;
                    rig.objects.probe_function = 0x1111;
                    rig.objects.mode = 3;
                    rig.tick();
                    rig.enable();
                    let case = format!("function {function}, IN{input} and IN{twin}, normally open {normally_open}");
                    assert_eq!(rig.objects.digital_inputs, 0, "{case}");
                    assert!(!is_active(&rig), "{case}");
                    rig.inputs ^= 1 << (input - 1);
                    rig.tick();
                    assert_eq!(is_active(&rig), function != 0, "{case}");
                    assert_eq!(rig.objects.digital_inputs & !0b111, 0x1_0000 << (input - 1), "{case}");
                    assert_eq!(rig.objects.input_level, u16::from(rig.inputs), "{case}");
                }
            }
        }
    }
}

// manual: 2.2.7/fault-clear
#[test]
fn a_fault_clear_input_resets_on_its_rising_edge() {
    let mut rig = running();
    rig.objects.input_2_function = 4;
    rig.inputs = 0x02;
    rig.drive.set_network(false);
    rig.until("in fault", |rig| rig.state() == Fault);
    rig.drive.set_network(true);
    rig.ticks(10);
    assert_eq!(rig.state(), Fault);
    rig.inputs = 0;
    rig.tick();
    rig.inputs = 0x02;
    rig.tick();
    assert_eq!((rig.state(), rig.objects.error_code), (SwitchOnDisabled, 0));
}

// manual: 1.3/counts 1.3.2/settings 2.2.5/alarm 2.2.5/brake 2.2.5/in-place 2.2.23/level
#[test]
fn alarm_brake_and_in_place_outputs() {
    let mut rig = with_brake();
    assert_eq!((rig.actuators.outputs, rig.objects.output_level), (OutputLevels(0b00), 0b11));
    rig.objects.soft_lock_time = 50;
    rig.objects.mode = 1;
    rig.enable();
    assert_eq!(
        rig.actuators.outputs,
        OutputLevels(0b00),
        "the brake stays shut until the shaft is held"
    );
    rig.ticks(100);
    assert_eq!((rig.actuators.outputs, rig.objects.output_level), (OutputLevels(0b10), 0b01));
    rig.objects.output_1_function = 3;
    rig.tick();
    assert_eq!(rig.actuators.outputs, OutputLevels(0b11));
    rig.objects.target_position = 2_000;
    rig.command(0x1F);
    assert_eq!(rig.actuators.outputs, OutputLevels(0b10));
    rig.until("there", |rig| rig.status(10));
    assert_eq!(rig.actuators.outputs, OutputLevels(0b11));
    rig.objects.output_1_function = 1;
    rig.drive.set_network(false);
    rig.tick();
    assert_eq!(
        (rig.state(), rig.actuators.outputs),
        (FaultReactionActive, OutputLevels(0b01)),
        "alarm, and the brake shuts"
    );
}

/// A drive as delivered, with the brake on OUT2.
fn with_brake() -> Rig {
    let mut rig = Rig::new();
    rig.objects.output_2_function = 2;
    rig.tick();
    rig
}

const BRAKE: u8 = 0b10;

/// Ticks for which the shut brake is still backed by the motor; asserts that the state stays and the motor holds all the while.
fn ticks_until_the_brake_holds(rig: &mut Rig) -> usize {
    let (state, amplitude) = (rig.state(), rig.amplitude());
    let mut ticks = 0;
    while rig.actuators.outputs.0 & BRAKE == 0 && rig.is_powered() {
        assert_eq!((rig.state(), rig.amplitude()), (state, amplitude), "after {ticks} ticks");
        rig.tick();
        ticks += 1;
    }
    ticks
}

// manual: 2.2.5/brake
#[test]
fn the_brake_shuts_50_ms_before_a_motor_that_was_stopped_is_switched_off() {
    let disable: fn(&mut Rig) = |rig| rig.objects.controlword = 0x07;
    let shut_down: fn(&mut Rig) = |rig| {
        rig.objects.shutdown_option = 1;
        rig.objects.controlword = 0x06;
    };
    let quick_stop: fn(&mut Rig) = |rig| rig.objects.controlword = 0x02;
    let emergency_stop: fn(&mut Rig) = |rig| {
        rig.objects.quick_stop_option = 6;
        rig.objects.input_1_function = 5;
        rig.inputs = 0x01;
    };
    let fault: fn(&mut Rig) = |rig| rig.drive.set_network(false);
    for (velocity, (leave, state)) in [0, 20_000].into_iter().flat_map(|velocity| {
        [
            (disable, SwitchedOn),
            (shut_down, ReadyToSwitchOn),
            (quick_stop, SwitchOnDisabled),
            (emergency_stop, SwitchOnDisabled),
            (fault, Fault),
        ]
        .map(|case| (velocity, case))
    }) {
        let mut rig = with_brake();
        rig.objects.mode = 3;
        rig.enable();
        rig.objects.target_velocity = velocity;
        rig.until("at speed", |rig| rig.pulses_per_second() == velocity);
        assert_eq!(rig.actuators.outputs.0 & BRAKE, BRAKE);
        leave(&mut rig);
        rig.until("standing", |rig| {
            assert!(rig.actuators.outputs.0 & BRAKE == 0 || rig.drive.is_moving());
            !rig.drive.is_moving()
        });
        assert_eq!(ticks_until_the_brake_holds(&mut rig), 1_001, "{state:?}");
        assert_eq!((rig.state(), rig.is_powered()), (state, false));
    }
}

// manual: 2.2.5/brake
#[test]
fn the_brake_shuts_with_the_current_where_the_motor_coasts() {
    let disable_voltage: fn(&mut Rig) = |rig| rig.objects.controlword = 0x00;
    let shut_down: fn(&mut Rig) = |rig| rig.objects.controlword = 0x06;
    let offline: fn(&mut Rig) = |rig| rig.inputs = IN_OFFLINE;
    for (leave, state) in [
        (disable_voltage, SwitchOnDisabled),
        (shut_down, ReadyToSwitchOn),
        (offline, OperationEnabled),
    ] {
        let mut rig = with_brake();
        rig.enable();
        assert_eq!(rig.actuators.outputs.0 & BRAKE, BRAKE);
        leave(&mut rig);
        rig.tick();
        assert_eq!((rig.state(), rig.is_powered(), rig.actuators.outputs.0 & BRAKE), (state, false, 0));
    }
}

#[test]
fn the_brake_stays_open_in_a_quick_stop_that_holds_and_opens_again_for_a_disable_command_taken_back() {
    let mut rig = with_brake();
    rig.objects.quick_stop_option = 6;
    rig.enable();
    rig.command(0x02);
    rig.milliseconds(100);
    assert_eq!(
        (rig.state(), rig.is_powered(), rig.actuators.outputs.0 & BRAKE),
        (QuickStopActive, true, BRAKE)
    );
    rig.command(0x0F);
    rig.objects.controlword = 0x07;
    rig.milliseconds(40);
    assert_eq!((rig.state(), rig.actuators.outputs.0 & BRAKE), (OperationEnabled, 0));
    rig.command(0x0F);
    assert_eq!((rig.state(), rig.actuators.outputs.0 & BRAKE), (OperationEnabled, BRAKE));
}

// manual: 2.2.15/enabled 2.2.15/in-place 2.2.15/running 2.2.15/ready 2.2.15/reserved
#[test]
fn the_status_code_tells_enabled_in_place_and_running() {
    let mut rig = Rig::new();
    assert_eq!(rig.objects.status_code, 0x20);
    rig.objects.mode = 1;
    rig.enable();
    assert_eq!(rig.objects.status_code, 0x25);
    rig.objects.target_position = 2_000;
    rig.command(0x1F);
    rig.ticks(10);
    assert_eq!(rig.objects.status_code, 0x29);
}

// manual: 1.1.1/open-loop 2.2.11/gains 2.2.17/open-loop 2.3.4/modes
#[test]
fn vetoes_that_depend_on_the_state() {
    let mut rig = Rig::new();
    rig.download(0x200B, 1, &[1, 0]).unwrap();
    for sub in 2..=4 {
        assert_eq!(rig.download(0x200B, sub, &[200, 0]), Err(AbortCode::DeviceState));
    }
    rig.download(0x200B, 1, &[0, 0]).unwrap();
    for sub in 2..=4 {
        assert_eq!(rig.download(0x200B, sub, &[200, 0]), Ok(()));
    }
    for mode in i8::MIN..=i8::MAX {
        let expected = if [0, 1, 3, 6, 8].contains(&mode) {
            Ok(())
        } else {
            Err(AbortCode::ValueRange)
        };
        assert_eq!(rig.download(0x6060, 0, &mode.to_le_bytes()), expected, "{mode}");
    }
    assert_eq!(rig.download(0x6060, 0, &[1, 0]), Err(AbortCode::LengthMismatch));
    for (option, expected) in [
        (2i16, Ok(())),
        (3, Err(AbortCode::ValueRange)),
        (6, Ok(())),
        (7, Err(AbortCode::ValueTooHigh)),
    ] {
        assert_eq!(rig.download(0x605A, 0, &option.to_le_bytes()), expected);
    }
    assert_eq!(rig.download(0x2011, 0, &[1, 0]), Err(AbortCode::ValueTooHigh));
}

// manual: 2.3.4/modes 2.3.5/mode
#[test]
fn an_unsupported_mode_by_pdo_keeps_the_mode_there_is() {
    let mut rig = Rig::enabled(8);
    for mode in [0, 2, 4, 9, -1] {
        rig.objects.mode = mode;
        rig.tick();
        assert_eq!(rig.objects.mode_display, 8);
    }
    rig.objects.mode = 3;
    rig.tick();
    assert_eq!(rig.objects.mode_display, 3);
}

// manual: 2.2.16/clear 2.2.16/standstill 2.3.6/position
#[test]
fn the_position_can_be_cleared_at_standstill_and_the_field_stays() {
    let mut rig = Rig::enabled(1);
    rig.objects.target_position = 1_237;
    rig.command(0x1F);
    rig.milliseconds(50);
    assert_eq!(rig.download(0x2010, 0, &[1, 0]), Err(AbortCode::DeviceState));
    rig.objects.zero_position = 1;
    rig.tick();
    assert!(rig.objects.position > 0, "by PDO it does not act either");
    rig.until("there", |rig| rig.status(10));
    let before = rig.actuators.stage;
    rig.download(0x2010, 0, &[1, 0]).unwrap();
    rig.tick();
    assert_eq!((rig.objects.position, rig.objects.zero_position), (0, 0));
    assert_eq!(rig.actuators.stage, before);
    rig.objects.target_position = 100;
    rig.command(0x4F);
    rig.command(0x5F);
    rig.until("there", |rig| rig.status(10));
    assert_eq!((rig.objects.position, rig.shaft.round()), (100, 1_337.0));
    rig.objects.mode = 8;
    rig.ticks(2);
    assert_eq!(rig.download(0x2010, 0, &[1, 0]), Err(AbortCode::DeviceState));
}
