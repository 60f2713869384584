//! Every way to stop in every mode: which ramp, which state, and no jump in speed.

mod rig;

use board::{Millivolts, Nanos};
use drive::PowerState::{self, *};
use rig::{IN_NEGATIVE_LIMIT, IN_OFFLINE, IN_POSITIVE_LIMIT, Rig};

const PP: i8 = 1;
const PV: i8 = 3;
const HOMING: i8 = 6;
const CSP: i8 = 8;

/// Pulses/s in all of these tests.
const SPEED: i32 = 20_000;

/// The decelerations, all different: 0x6084, 0x6085, 0x609A.
const PROFILE: i32 = 100_000;
const QUICK: i32 = 500_000;
const HOMING_RAMP: i32 = 200_000;

/// How a stop stops.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Ramp {
    Coast,
    /// With the mode's own deceleration.
    Slow,
    Quick,
}

impl Ramp {
    fn deceleration(self, mode: i8) -> Option<i32> {
        match self {
            Self::Coast => None,
            Self::Slow if mode == HOMING => Some(HOMING_RAMP),
            Self::Slow => Some(PROFILE),
            Self::Quick => Some(QUICK),
        }
    }
}

/// A drive that runs in a mode, whose master goes on sending targets in CSP.
struct Running {
    rig: Rig,
    mode: i8,
    ticks: i32,
}

impl Running {
    fn new(mode: i8) -> Self {
        let mut rig = Rig::new();
        rig.objects.input_1_function = 5;
        rig.objects.mode = mode;
        rig.objects.profile_velocity = SPEED;
        rig.objects.target_velocity = SPEED;
        rig.objects.target_position = if mode == PP { i32::MAX } else { 0 };
        rig.objects.homing_method = 18;
        rig.objects.homing_speed_fast = SPEED as u32;
        rig.objects.homing_acceleration = HOMING_RAMP as u32;
        rig.enable();
        if mode != CSP {
            rig.command(0x1F);
            rig.objects.controlword = 0x0F;
        }
        let mut running = Self { rig, mode, ticks: 0 };
        for _ in 0..10_000 {
            running.tick();
        }
        assert_eq!(running.rig.pulses_per_second(), SPEED, "mode {mode}");
        assert!(running.rig.is_powered());
        running
    }

    /// A tick; every twentieth begins a cycle of CSP.
    fn tick(&mut self) {
        if self.mode == CSP && self.ticks % 20 == 0 {
            self.rig.objects.target_position = self.ticks + 20;
            self.rig.drive.synchronize(&self.rig.objects, Some(Nanos(1_000_000)));
        }
        self.ticks += 1;
        self.rig.tick();
    }

    /// Ticks until the motor stands; checks in each that the ramp is kept and no mode bit but that of PV tells more.
    fn stop(&mut self, ramp: Ramp, what: &str) {
        let what = format!("{what}, mode {}", self.mode);
        let Some(deceleration) = ramp.deceleration(self.mode) else {
            self.tick();
            assert!(!self.rig.is_powered() && !self.rig.drive.is_moving(), "{what}");
            return;
        };
        let mut ticks = 0;
        loop {
            let before = self.rig.drive.velocity().sub_pulses_per_tick();
            self.tick();
            let fall = before - self.rig.drive.velocity().sub_pulses_per_tick();
            assert!(
                (0..=i64::from(deceleration)).contains(&fall) || before < 2_000_000,
                "{what}: {fall}"
            );
            if !self.rig.drive.is_moving() {
                break;
            }
            assert!(self.rig.is_powered(), "{what}");
            ticks += 1;
        }
        let expected = SPEED * 20_000 / deceleration;
        assert!((expected - 2..expected + 220).contains(&ticks), "{what}: {ticks} ticks");
        assert!(self.rig.drive.position().is_whole_pulse(), "{what}");
    }

    /// Ticks a few times more and checks that the drive stays in `state`, standing.
    fn rests(&mut self, state: PowerState, powered: bool, what: &str) {
        let position = self.rig.objects.position;
        for _ in 0..100 {
            self.tick();
        }
        let found = (self.rig.state(), self.rig.is_powered(), self.rig.objects.position);
        assert_eq!(found, (state, powered, position), "{what}, mode {}", self.mode);
    }
}

#[test]
fn quick_stop_by_each_option_code() {
    for mode in [PP, PV, HOMING, CSP] {
        for (option, ramp, end) in [
            (0, Ramp::Coast, SwitchOnDisabled),
            (1, Ramp::Slow, SwitchOnDisabled),
            (2, Ramp::Quick, SwitchOnDisabled),
            (5, Ramp::Slow, QuickStopActive),
            (6, Ramp::Quick, QuickStopActive),
        ] {
            let mut running = Running::new(mode);
            running.rig.objects.quick_stop_option = option;
            running.rig.objects.controlword = 0x02;
            let what = format!("0x605A = {option}");
            running.stop(ramp, &what);
            assert_eq!(running.rig.state(), QuickStopActive);
            // Bit 10 tells standstill, also in the tick before the state is left.
            assert_eq!(running.rig.objects.statusword & 0x3400, 0x0400, "{what}, mode {mode}");
            running.tick();
            running.rests(end, end == QuickStopActive, &what);
        }
    }
}

#[test]
fn shutdown_and_disable_operation_by_each_option_code() {
    for mode in [PP, PV, HOMING, CSP] {
        for (word, option, ramp, end) in [
            (0x06, 0, Ramp::Coast, ReadyToSwitchOn),
            (0x06, 1, Ramp::Slow, ReadyToSwitchOn),
            (0x07, 0, Ramp::Coast, SwitchedOn),
            (0x07, 1, Ramp::Slow, SwitchedOn),
        ] {
            let mut running = Running::new(mode);
            running.rig.objects.shutdown_option = option;
            running.rig.objects.disable_operation_option = option;
            running.rig.objects.controlword = word;
            let what = format!("controlword {word:02X}, option {option}");
            running.stop(ramp, &what);
            running.tick();
            running.rests(end, false, &what);
        }
    }
}

#[test]
fn the_statusword_tells_operation_enabled_and_no_mode_bits_while_a_disable_ramp_runs() {
    for mode in [PP, PV, HOMING, CSP] {
        let mut running = Running::new(mode);
        running.rig.objects.controlword = 0x07;
        running.tick();
        assert_eq!(running.rig.objects.statusword, 0x0237, "mode {mode}");
    }
}

#[test]
fn losing_op_and_overvoltage_by_each_option_code() {
    for mode in [PP, PV, HOMING, CSP] {
        for (option, ramp) in [(0, Ramp::Coast), (1, Ramp::Slow), (2, Ramp::Quick)] {
            for code in [0x7500, 0x3110] {
                let what = format!("0x605E = {option}, fault {code:04X}");
                let mut running = Running::new(mode);
                running.rig.objects.fault_reaction_option = option;
                match code {
                    0x7500 => running.rig.drive.set_network(false),
                    _ => {
                        running.rig.bus = Millivolts(61_000);
                        running.tick();
                    }
                }
                running.stop(ramp, &what);
                assert_eq!(
                    (running.rig.state(), running.rig.objects.error_code),
                    (FaultReactionActive, code),
                    "{what}"
                );
                running.tick();
                running.rests(Fault, false, &what);
            }
        }
    }
}

#[test]
fn a_fault_in_another_ramp_takes_over_with_its_own() {
    for mode in [PP, PV, HOMING, CSP] {
        for word in [0x02, 0x07] {
            let mut running = Running::new(mode);
            running.rig.objects.quick_stop_option = 5;
            running.rig.objects.fault_reaction_option = 2;
            running.rig.objects.controlword = word;
            (0..200).for_each(|_| running.tick());
            let speed = running.rig.pulses_per_second();
            assert!((17_900..=19_100).contains(&speed) && !(mode == HOMING && speed > 18_100), "{speed}");
            running.rig.drive.set_network(false);
            let mut ticks = 0;
            while running.rig.drive.is_moving() {
                running.tick();
                ticks += 1;
            }
            assert!((700..1_000).contains(&ticks), "with 0x6085: {ticks}");
            running.tick();
            running.rests(Fault, false, "a fault in a ramp");
            // The network comes back, the fault stays until it is reset.
            running.rig.drive.set_network(true);
            running.rig.objects.controlword = 0x0F;
            running.rests(Fault, false, "the network is back");
        }
    }
}

#[test]
fn a_second_fault_in_the_reaction_changes_neither_ramp_nor_code() {
    let mut running = Running::new(PV);
    running.rig.drive.set_network(false);
    running.tick();
    running.rig.bus = Millivolts(61_000);
    running.stop(Ramp::Slow, "a second fault");
    assert_eq!(running.rig.objects.error_code, 0x7500);
}

#[test]
fn emergency_stop_uses_0x6085_whatever_the_options_and_ends_switched_off() {
    for mode in [PP, PV, HOMING, CSP] {
        for option in [0, 1, 2, 5, 6] {
            let mut running = Running::new(mode);
            running.rig.objects.quick_stop_option = option;
            running.rig.inputs = 1;
            running.stop(Ramp::Quick, "emergency stop");
            running.tick();
            running.rests(SwitchOnDisabled, false, "emergency stop");
            for word in [0x06, 0x0F] {
                running.rig.objects.controlword = word;
                running.rests(SwitchOnDisabled, false, "the input is still on");
            }
            running.rig.inputs = 0;
            running.rests(SwitchOnDisabled, false, "the enable command is an old one");
        }
    }
}

#[test]
fn halt_slows_down_and_stays_enabled() {
    for mode in [PP, PV, HOMING, CSP] {
        let mut running = Running::new(mode);
        running.rig.objects.controlword = 0x10F;
        running.stop(Ramp::Slow, "halt");
        running.rests(OperationEnabled, true, "halt");
        assert_eq!(running.rig.status(10), mode != CSP, "bit 10 in mode {mode}");
    }
}

#[test]
fn a_limit_switch_stops_with_0x6085_in_every_mode_and_ramp() {
    for mode in [PP, PV, CSP] {
        let mut running = Running::new(mode);
        running.rig.inputs = IN_POSITIVE_LIMIT;
        running.stop(Ramp::Quick, "limit switch");
        running.rests(OperationEnabled, true, "limit switch");
        assert!(running.rig.status(11) && !running.rig.status(10));
    }
    for mode in [PP, PV, HOMING, CSP] {
        let mut running = Running::new(mode);
        running.rig.objects.controlword = 0x07;
        running.rig.inputs = IN_POSITIVE_LIMIT;
        running.stop(Ramp::Quick, "limit switch while being disabled");
        let mut running = Running::new(mode);
        running.rig.objects.controlword = 0x07;
        running.rig.inputs = IN_NEGATIVE_LIMIT;
        running.stop(Ramp::Slow, "the other limit switch");
    }
}

#[test]
fn motor_offline_frees_the_shaft_in_every_mode_and_nothing_moves_by_itself_afterwards() {
    for mode in [PP, PV, HOMING, CSP] {
        let mut running = Running::new(mode);
        running.rig.objects.target_velocity = 0;
        running.rig.inputs = IN_OFFLINE;
        running.stop(Ramp::Coast, "motor offline");
        running.rests(OperationEnabled, false, "motor offline");
        running.mode = 0;
        running.rig.inputs = 0;
        running.rests(OperationEnabled, true, "back in line");
    }
}

#[test]
fn emergency_stop_makes_a_slower_ramp_under_way_a_quick_one() {
    for mode in [PP, PV, HOMING, CSP] {
        for (word, operational, end) in [(0x02, true, SwitchOnDisabled), (0x07, true, SwitchOnDisabled), (0x0F, false, Fault)] {
            let mut running = Running::new(mode);
            running.rig.objects.quick_stop_option = 5;
            running.rig.objects.controlword = word;
            running.rig.drive.set_network(operational);
            (0..200).for_each(|_| running.tick());
            // Pressed for ten ticks is pressed.
            running.rig.inputs = 1;
            (0..10).for_each(|_| running.tick());
            running.rig.inputs = 0;
            let mut ticks = 0;
            while running.rig.drive.is_moving() {
                running.tick();
                ticks += 1;
            }
            // From 19 000 or, in homing, 18 000 pulses/s with 500 000 pulses/s^2.
            assert!((700..970).contains(&ticks), "mode {mode}, {word:02X}: {ticks}");
            running.rig.objects.controlword = 0x0F;
            running.tick();
            running.rests(end, false, "after the emergency stop");
        }
    }
}

#[test]
fn a_fault_in_an_emergency_stop_does_not_make_it_slower_but_may_let_go() {
    for (option, ticks) in [(1, 600..900), (2, 600..900), (0, 1..2)] {
        let mut running = Running::new(PV);
        running.rig.objects.fault_reaction_option = option;
        running.rig.inputs = 1;
        (0..50).for_each(|_| running.tick());
        running.rig.drive.set_network(false);
        let mut taken = 0;
        while running.rig.state() != Fault {
            running.tick();
            assert!(option != 0 || !running.rig.is_powered(), "let go");
            taken += 1;
        }
        assert!(ticks.contains(&(taken - 1)), "0x605E = {option}: {taken}");
    }
}
