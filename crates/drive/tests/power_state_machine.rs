//! The power state machine, over every state and every controlword.

mod rig;

use drive::PowerState::{self, *};
use drive::controlword::{Command, Controlword};
use drive::power_state::Event;
use rig::Rig;

/// What a drive that stands, without fault and with default option codes, does with the controlword bits 7, 3, 2, 1, 0.
///
/// Rows of the standard's table: state, pattern of bits 7 3 2 1 0, next state. The first row that fits counts; none keeps the state.
const TABLE: &[(PowerState, &str, PowerState)] = &[
    (SwitchOnDisabled, "0x110", ReadyToSwitchOn),
    (ReadyToSwitchOn, "00111", SwitchedOn),
    (ReadyToSwitchOn, "01111", SwitchedOn),
    (ReadyToSwitchOn, "0xx0x", SwitchOnDisabled),
    (ReadyToSwitchOn, "0x01x", SwitchOnDisabled),
    (SwitchedOn, "01111", OperationEnabled),
    (SwitchedOn, "0x110", ReadyToSwitchOn),
    (SwitchedOn, "0xx0x", SwitchOnDisabled),
    (SwitchedOn, "0x01x", SwitchOnDisabled),
    (OperationEnabled, "00111", SwitchedOn),
    (OperationEnabled, "0x110", ReadyToSwitchOn),
    (OperationEnabled, "0xx0x", SwitchOnDisabled),
    (OperationEnabled, "0x01x", QuickStopActive),
    (QuickStopActive, "0xx0x", SwitchOnDisabled),
];

fn fits(pattern: &str, controlword: u16) -> bool {
    let bits = [7, 3, 2, 1, 0].map(|bit| controlword >> bit & 1);
    pattern
        .bytes()
        .zip(bits)
        .all(|(wanted, bit)| wanted == b'x' || u16::from(wanted - b'0') == bit)
}

fn expected(state: PowerState, controlword: u16) -> PowerState {
    TABLE
        .iter()
        .find(|(from, pattern, _)| *from == state && fits(pattern, controlword))
        .map_or(state, |row| row.2)
}

/// The state that the masks of CiA 402 find in a statusword.
fn decoded(statusword: u16) -> PowerState {
    let masks = [
        (0x4F, 0x00, NotReadyToSwitchOn),
        (0x4F, 0x40, SwitchOnDisabled),
        (0x6F, 0x21, ReadyToSwitchOn),
        (0x6F, 0x23, SwitchedOn),
        (0x6F, 0x27, OperationEnabled),
        (0x6F, 0x07, QuickStopActive),
        (0x4F, 0x0F, FaultReactionActive),
        (0x4F, 0x08, Fault),
    ];
    let mut states = masks.iter().filter(|(mask, value, _)| statusword & mask == *value);
    let state = states.next().unwrap_or_else(|| panic!("{statusword:04X} is no state")).2;
    assert!(states.next().is_none(), "{statusword:04X} is two states");
    state
}

// manual: 2.3.2/commands
#[test]
fn every_controlword_in_every_state_leads_where_the_standard_says() {
    for state in PowerState::ALL {
        for controlword in 0..=u16::MAX {
            let after = match Controlword(controlword).command() {
                Some(command) => state.after(Event::Command(command)),
                None => state,
            };
            assert_eq!(after, expected(state, controlword), "{state:?} {controlword:04X}");
        }
    }
}

#[test]
fn every_other_event_acts_in_its_states_only() {
    for state in PowerState::ALL {
        let after = |event| state.after(event);
        let only = |from, to| if state == from { to } else { state };
        assert_eq!(after(Event::Initialised), only(NotReadyToSwitchOn, SwitchOnDisabled));
        assert_eq!(after(Event::PowerUpEnable), only(SwitchOnDisabled, ReadyToSwitchOn));
        assert_eq!(after(Event::QuickStopCompleted), only(QuickStopActive, SwitchOnDisabled));
        assert_eq!(after(Event::Resume), only(QuickStopActive, OperationEnabled));
        assert_eq!(after(Event::FaultReactionCompleted), only(FaultReactionActive, Fault));
        assert_eq!(after(Event::FaultReset), only(Fault, SwitchOnDisabled));
        let faulty = if state == Fault { Fault } else { FaultReactionActive };
        assert_eq!(after(Event::FaultDetected), faulty);
    }
}

/// A drive in `state`, standing, whose power-up courtesy is over and whose controlword was 0 last.
fn drive_in(state: PowerState) -> Rig {
    let mut rig = match state {
        NotReadyToSwitchOn => {
            let mut rig = Rig::at_power_up();
            rig.drive.set_network(true);
            return rig;
        }
        _ => Rig::new(),
    };
    rig.command(0x06);
    rig.command(0x02);
    assert_eq!(rig.state(), SwitchOnDisabled);
    let walk: &[u16] = match state {
        NotReadyToSwitchOn | SwitchOnDisabled => &[],
        ReadyToSwitchOn => &[0x06],
        SwitchedOn => &[0x06, 0x07],
        OperationEnabled => &[0x06, 0x07, 0x0F],
        QuickStopActive => &[0x06, 0x07, 0x0F, 0x02],
        FaultReactionActive | Fault => &[0x06, 0x07, 0x0F],
    };
    walk.iter().for_each(|word| rig.command(*word));
    if matches!(state, FaultReactionActive | Fault) {
        rig.objects.controlword = 0;
        rig.drive.set_network(false);
        rig.tick();
        rig.drive.set_network(true);
    }
    if state == Fault {
        rig.tick();
    }
    assert_eq!(rig.state(), state);
    assert_eq!(decoded(rig.objects.statusword), state);
    rig
}

fn check_all_controlwords(rig: &Rig, expected: impl Fn(u16) -> PowerState) {
    let mut probe = rig.clone();
    for controlword in 0..=u16::MAX {
        probe.clone_from(rig);
        probe.command(controlword);
        assert_eq!(probe.state(), expected(controlword), "{:?} {controlword:04X}", rig.state());
        assert_eq!(decoded(probe.objects.statusword), probe.state(), "{controlword:04X}");
    }
}

// manual: 2.3.2/commands 2.3.3/states
#[test]
fn the_drive_makes_the_same_transitions_and_its_statusword_tells_them() {
    for state in [SwitchOnDisabled, ReadyToSwitchOn, SwitchedOn, OperationEnabled] {
        check_all_controlwords(&drive_in(state), |word| expected(state, word));
    }
}

#[test]
fn without_a_command_the_drive_starts_up_ends_a_quick_stop_and_ends_a_fault_reaction() {
    check_all_controlwords(&drive_in(NotReadyToSwitchOn), |_| SwitchOnDisabled);
    check_all_controlwords(&drive_in(QuickStopActive), |_| SwitchOnDisabled);
    check_all_controlwords(&drive_in(FaultReactionActive), |_| Fault);
}

#[test]
fn a_quick_stop_that_stays_is_left_by_enable_operation_and_disable_voltage_only() {
    for option in [5, 6] {
        let mut rig = drive_in(OperationEnabled);
        rig.objects.quick_stop_option = option;
        rig.command(0x02);
        check_all_controlwords(&rig, |word| match Controlword(word).command() {
            Some(Command::DisableVoltage) => SwitchOnDisabled,
            Some(Command::EnableOperation) => OperationEnabled,
            _ => QuickStopActive,
        });
    }
}

// manual: 2.3.2/reset
#[test]
fn a_fault_is_left_by_a_rising_edge_of_bit_7_only() {
    let mut rig = drive_in(Fault);
    check_all_controlwords(&rig, |word| if word & 0x80 != 0 { SwitchOnDisabled } else { Fault });
    rig.drive.set_network(false);
    rig.command(0x80);
    rig.drive.set_network(true);
    check_all_controlwords(&rig, |_| Fault);
}
