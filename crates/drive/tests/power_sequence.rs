//! How the drive is enabled, stopped, disabled, faulted and reset.

mod rig;

use board::Millivolts;
use drive::PowerState::*;
use drive::{Alarm, Light};
use rig::Rig;

/// A drive that runs at 20 000 pulses/s in PV.
fn running() -> Rig {
    let mut rig = Rig::enabled(3);
    rig.objects.target_velocity = 20_000;
    rig.until("at speed", |rig| rig.status(10) && rig.pulses_per_second() == 20_000);
    rig
}

/// Ticks until the state is left, and whether the motor was driven all the while.
fn ticks_in_state(rig: &mut Rig) -> (usize, bool) {
    let state = rig.state();
    let mut count = 0;
    let mut driven = true;
    while rig.state() == state {
        driven &= rig.is_powered();
        rig.tick();
        count += 1;
        assert!(count < 100_000);
    }
    (count, driven)
}

/// Ticks of a ramp from 20 000 pulses/s, up to the end of the last pulse.
fn is_ramp(ticks: usize, deceleration: usize) -> bool {
    let ramp = 20_000 * 20_000 / deceleration;
    (ramp - 2..ramp + 220).contains(&ticks)
}

// manual: 2.4.2/power-on 2.4.2/start
#[test]
fn enabling_from_ready_walks_through_switched_on_one_transition_a_tick() {
    for word in [0x0F, 0x1F, 0x10F] {
        let mut rig = Rig::new();
        let states = [0x06, word, word, word].map(|word| {
            rig.command(word);
            rig.state()
        });
        assert_eq!(states, [ReadyToSwitchOn, SwitchedOn, OperationEnabled, OperationEnabled]);
    }
}

#[test]
fn from_power_up_an_enable_command_alone_enables() {
    for word in [0x0F, 0x1F] {
        let mut rig = Rig::new();
        let states = [0, word, word, word].map(|word| {
            rig.command(word);
            rig.state()
        });
        assert_eq!(states, [SwitchOnDisabled, ReadyToSwitchOn, SwitchedOn, OperationEnabled]);
    }
}

#[test]
fn the_courtesy_ends_with_the_first_quick_stop() {
    let mut rig = Rig::enabled(1);
    rig.command(0x02);
    rig.until("disabled", |rig| rig.state() == SwitchOnDisabled);
    rig.objects.controlword = 0x0F;
    rig.ticks(10);
    assert_eq!(rig.state(), SwitchOnDisabled);
    rig.enable();
}

#[test]
fn the_courtesy_ends_with_the_first_fault() {
    let mut rig = Rig::new();
    rig.bus = Millivolts(70_000);
    rig.ticks(4);
    assert_eq!(rig.state(), Fault);
    rig.bus = Millivolts(24_000);
    rig.tick();
    rig.command(0x80);
    assert_eq!(rig.state(), SwitchOnDisabled);
    rig.objects.controlword = 0x0F;
    rig.ticks(10);
    assert_eq!(rig.state(), SwitchOnDisabled);
    rig.enable();
}

#[test]
fn nothing_is_enabled_outside_of_op() {
    let mut rig = Rig::new();
    rig.drive.set_network(false);
    for word in [0x06, 0x07, 0x0F, 0x0F, 0x0F] {
        rig.command(word);
        assert_eq!(rig.state(), SwitchOnDisabled);
    }
    assert!(!rig.status(9));
}

// manual: 1.1.2/supply 2.2.21/voltage 2.3.3/voltage 2.3.3/remote 2.4.2/power-on
#[test]
fn statusword_bits_4_and_9_follow_supply_and_network() {
    let mut rig = Rig::new();
    assert_eq!(rig.objects.statusword, 0x0250);
    rig.drive.set_network(false);
    rig.tick();
    assert_eq!(rig.objects.statusword, 0x0050);
    for (bus, enabled) in [(17_999, false), (18_000, true), (50_000, true), (50_001, false)] {
        rig.bus = Millivolts(bus);
        rig.tick();
        assert_eq!(rig.status(4), enabled, "{bus} mV");
        assert_eq!(i32::from(rig.objects.bus_voltage), bus / 10);
    }
}

#[test]
fn quick_stop_stops_as_its_option_says() {
    let mut rig = running();
    rig.objects.quick_stop_option = 0;
    rig.command(0x02);
    assert_eq!((rig.state(), rig.is_powered()), (QuickStopActive, false));
    rig.tick();
    assert_eq!(rig.state(), SwitchOnDisabled);

    for (option, deceleration) in [(1, 100_000), (2, 500_000)] {
        let mut rig = running();
        rig.objects.quick_stop_option = option;
        rig.command(0x02);
        let (ticks, driven) = ticks_in_state(&mut rig);
        assert!(is_ramp(ticks, deceleration) && driven, "{option}: {ticks}");
        assert_eq!((rig.state(), rig.is_powered()), (SwitchOnDisabled, false));
    }
}

#[test]
fn quick_stop_options_5_and_6_hold_the_motor_and_may_go_on() {
    for (option, deceleration) in [(5, 100_000), (6, 500_000)] {
        let mut rig = running();
        rig.objects.quick_stop_option = option;
        rig.command(0x02);
        assert!(!rig.status(10));
        let ticks = rig.until("standing", |rig| rig.status(10));
        assert!(is_ramp(ticks, deceleration), "{option}: {ticks}");
        rig.milliseconds(10);
        assert_eq!((rig.state(), rig.is_powered()), (QuickStopActive, true));
        rig.command(0x0F);
        assert_eq!(rig.state(), OperationEnabled);
        rig.until("at speed", |rig| rig.pulses_per_second() == 20_000);
    }
}

#[test]
fn disable_operation_ramps_first_and_shutdown_does_not_by_default() {
    let mut rig = running();
    rig.command(0x07);
    let (ticks, driven) = ticks_in_state(&mut rig);
    assert!(is_ramp(ticks, 100_000) && driven, "{ticks}");
    assert_eq!((rig.state(), rig.is_powered()), (SwitchedOn, false));

    let mut rig = running();
    rig.command(0x06);
    assert_eq!((rig.state(), rig.is_powered()), (ReadyToSwitchOn, false));
    assert!(!rig.drive.is_moving());
}

#[test]
fn the_options_of_shutdown_and_disable_operation_can_be_the_other_way_round() {
    let mut rig = running();
    rig.objects.disable_operation_option = 0;
    rig.command(0x07);
    assert_eq!((rig.state(), rig.is_powered()), (SwitchedOn, false));

    let mut rig = running();
    rig.objects.shutdown_option = 1;
    rig.command(0x06);
    let (ticks, driven) = ticks_in_state(&mut rig);
    assert!(is_ramp(ticks, 100_000) && driven, "{ticks}");
    assert_eq!(rig.state(), ReadyToSwitchOn);
}

#[test]
fn a_disable_command_that_is_taken_back_in_its_ramp_goes_on() {
    let mut rig = running();
    rig.objects.controlword = 0x07;
    rig.milliseconds(50);
    assert_eq!(rig.state(), OperationEnabled);
    assert!(rig.pulses_per_second() < 20_000);
    rig.command(0x0F);
    rig.until("at speed", |rig| rig.pulses_per_second() == 20_000);
}

#[test]
fn disable_voltage_frees_the_motor_at_once() {
    let mut rig = running();
    rig.command(0x00);
    assert_eq!((rig.state(), rig.is_powered()), (SwitchOnDisabled, false));
    let position = rig.objects.position;
    rig.milliseconds(20);
    assert_eq!(rig.objects.position, position);
}

#[test]
fn leaving_op_while_enabled_reacts_as_0x605e_says_and_ends_in_fault_0x7500() {
    for (option, deceleration) in [(1, 100_000), (2, 500_000)] {
        let mut rig = running();
        rig.objects.fault_reaction_option = option;
        rig.drive.set_network(false);
        rig.tick();
        assert_eq!((rig.state(), rig.objects.error_code), (FaultReactionActive, 0x7500));
        let (ticks, driven) = ticks_in_state(&mut rig);
        assert!(is_ramp(ticks, deceleration) && driven, "{option}: {ticks}");
        assert_eq!((rig.state(), rig.is_powered()), (Fault, false));
    }
    let mut rig = running();
    rig.objects.fault_reaction_option = 0;
    rig.drive.set_network(false);
    rig.tick();
    assert_eq!((rig.state(), rig.is_powered()), (FaultReactionActive, false));
    rig.tick();
    assert_eq!(rig.state(), Fault);
}

#[test]
fn leaving_op_while_not_enabled_is_no_fault_but_disables_switching_on() {
    for words in [&[0x06][..], &[0x06, 0x07]] {
        let mut rig = Rig::new();
        words.iter().for_each(|word| rig.command(*word));
        rig.drive.set_network(false);
        rig.tick();
        assert_eq!((rig.state(), rig.objects.error_code), (SwitchOnDisabled, 0));
    }
}

#[test]
fn a_communication_fault_can_be_reset_once_the_network_is_back() {
    let mut rig = running();
    rig.drive.set_network(false);
    rig.until("in fault", |rig| rig.state() == Fault);
    rig.command(0x00);
    rig.command(0x80);
    assert_eq!((rig.state(), rig.objects.error_code), (Fault, 0x7500));
    rig.drive.set_network(true);
    rig.tick();
    assert_eq!(rig.state(), Fault, "bit 7 does not act by its level");
    rig.command(0x00);
    rig.command(0x80);
    assert_eq!((rig.state(), rig.objects.error_code), (SwitchOnDisabled, 0));
    rig.command(0x0F);
    rig.ticks(5);
    assert_eq!(rig.state(), SwitchOnDisabled);
    rig.enable();
}

// manual: 2.2.14/overvoltage 2.2.14/cleared
#[test]
fn overvoltage_is_a_fault_that_stays_until_the_voltage_is_gone_and_a_reset_seen() {
    let mut rig = running();
    rig.bus = Millivolts(60_001);
    rig.ticks(2);
    assert_eq!(
        (rig.state(), rig.objects.error_code, rig.objects.alarm_code),
        (FaultReactionActive, 0x3110, 0x0004)
    );
    rig.until("in fault", |rig| rig.state() == Fault);
    assert_eq!(rig.objects.status_code & 0x23, 0x02);
    rig.command(0x80);
    assert_eq!(rig.state(), Fault);
    rig.bus = Millivolts(24_000);
    rig.command(0x00);
    rig.command(0x80);
    assert_eq!(
        (rig.state(), rig.objects.error_code, rig.objects.alarm_code),
        (SwitchOnDisabled, 0, 0)
    );
    assert_eq!(rig.objects.status_code & 0x23, 0x20);
}

#[test]
fn the_alarm_led_tells_whether_the_drive_is_enabled_and_which_fault_it_has() {
    let mut rig = Rig::new();
    assert_eq!((rig.drive.alarm(), rig.drive.alarm_light()), (Alarm::Disabled, Light::Green));
    rig.objects.mode = 3;
    rig.enable();
    assert_eq!((rig.drive.alarm(), rig.drive.alarm_light()), (Alarm::Enabled, Light::Green));
    rig.milliseconds(200);
    assert_eq!(rig.drive.alarm_light(), Light::Off);

    rig.bus = Millivolts(61_000);
    rig.until("fault", |rig| rig.state() == Fault);
    assert_eq!((rig.objects.error_code, rig.drive.alarm()), (0x3110, Alarm::Fault { red: 2 }));
    rig.bus = Millivolts(24_000);
    rig.ticks(2);
    rig.command(0x80);
    assert_eq!((rig.state(), rig.drive.alarm()), (SwitchOnDisabled, Alarm::Disabled));
}

#[test]
fn a_fault_of_the_network_is_not_among_the_alarms() {
    let mut rig = Rig::enabled(3);
    rig.drive.set_network(false);
    rig.until("fault", |rig| rig.state() == Fault);
    assert_eq!((rig.objects.error_code, rig.drive.alarm()), (0x7500, Alarm::Disabled));
}
