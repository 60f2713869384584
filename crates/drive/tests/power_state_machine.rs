//! The power state machine, over every state and every controlword.

mod rig;

use board::Millivolts;
use drive::PowerState::{self, *};
use drive::controlword::{Command, Controlword};
use drive::power_state::Event;
use proptest::prelude::*;
use rig::{IN_NEGATIVE_LIMIT, IN_POSITIVE_LIMIT, Rig};

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
    drive_in_mode(state, 0)
}

fn drive_in_mode(state: PowerState, mode: i8) -> Rig {
    let mut rig = Rig::at_power_up();
    rig.drive.set_network(true);
    rig.objects.mode = mode;
    rig.objects.filter_time = 0;
    rig.objects.input_filter = 0;
    rig.objects.soft_lock_time = 0;
    if state == NotReadyToSwitchOn {
        return rig;
    }
    rig.tick();
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

#[test]
fn an_enable_command_walks_one_transition_a_tick_and_no_other_command_does() {
    let ready = drive_in(ReadyToSwitchOn);
    let mut probe = ready.clone();
    for controlword in 0..=u16::MAX {
        probe.clone_from(&ready);
        probe.command(controlword);
        probe.command(controlword);
        let first = expected(ReadyToSwitchOn, controlword);
        assert_eq!(probe.state(), expected(first, controlword), "{controlword:04X}");
        assert_eq!(probe.state() == OperationEnabled, controlword & 0x8F == 0x0F, "{controlword:04X}");
    }
}

#[test]
fn at_power_up_the_enable_commands_alone_lead_on_and_after_a_quick_stop_shutdown_alone_does() {
    let mut rig = Rig::new();
    let leads_on = |word: u16| {
        if word & 0x8F == 0x0F || fits("0x110", word) {
            ReadyToSwitchOn
        } else {
            SwitchOnDisabled
        }
    };
    check_all_controlwords(&rig, leads_on);
    // No controlword but one that has led to a quick stop changes that.
    for word in [0x00, 0x02, 0x80, 0x07, 0x8F] {
        rig.command(word);
        check_all_controlwords(&rig, leads_on);
    }
    check_all_controlwords(&drive_in(SwitchOnDisabled), |word| expected(SwitchOnDisabled, word));
}

/// Bits 13, 12 and 10 of a drive that stands, enabled, with all set-points 0 and no command yet.
fn mode_bits(state: PowerState, mode: i8) -> u16 {
    match (state, mode) {
        (QuickStopActive, _) => 0x0400,
        // Target reached, and in PV speed zero, in CSP follows the command.
        (OperationEnabled, 1 | 6) => 0x0400,
        (OperationEnabled, 3 | 8) => 0x1400,
        _ => 0,
    }
}

#[test]
fn every_bit_of_the_statusword_in_every_state_and_mode() {
    const STATE_BITS: [(PowerState, u16); 7] = [
        (SwitchOnDisabled, 0x40),
        (ReadyToSwitchOn, 0x21),
        (SwitchedOn, 0x23),
        (OperationEnabled, 0x27),
        (QuickStopActive, 0x07),
        (FaultReactionActive, 0x0F),
        (Fault, 0x08),
    ];
    for mode in [0, 1, 3, 6, 8] {
        for (state, bits) in STATE_BITS {
            for (bus, bit_4) in [(24_000, 0x0010), (17_000, 0), (55_000, 0)] {
                for (inputs, bit_11) in [(0, 0), (IN_POSITIVE_LIMIT, 0x0800), (IN_NEGATIVE_LIMIT, 0x0800)] {
                    // These last for one tick only: what is looked at is the tick that enters them.
                    let mut rig = match state {
                        QuickStopActive | FaultReactionActive => drive_in_mode(OperationEnabled, mode),
                        _ => drive_in_mode(state, mode),
                    };
                    rig.bus = Millivolts(bus);
                    rig.inputs = inputs;
                    match state {
                        QuickStopActive => rig.objects.controlword = 0x02,
                        FaultReactionActive => rig.drive.set_network(false),
                        _ => {}
                    }
                    rig.tick();
                    let remote = if state == FaultReactionActive { 0 } else { 0x0200 };
                    let expected = bits | bit_4 | remote | bit_11 | mode_bits(state, mode);
                    assert_eq!(rig.state(), state);
                    assert_eq!(
                        rig.objects.statusword, expected,
                        "{state:?}, mode {mode}, {bus} mV, inputs {inputs:02X}"
                    );
                }
            }
        }
    }
}

#[test]
fn no_controlword_sets_a_reserved_bit_or_the_warning_in_any_mode() {
    for mode in [0, 1, 3, 6, 8] {
        for state in [SwitchOnDisabled, ReadyToSwitchOn, SwitchedOn, OperationEnabled, Fault] {
            let rig = drive_in_mode(state, mode);
            let mut probe = rig.clone();
            // Bits 10 to 15 of the controlword are reserved and have been swept above.
            for controlword in 0..0x400 {
                probe.clone_from(&rig);
                probe.command(controlword);
                assert_eq!(probe.objects.statusword & 0xC180, 0, "{state:?}, mode {mode}, {controlword:04X}");
                assert_eq!(decoded(probe.objects.statusword), probe.state());
            }
        }
    }
}

/// What a standing drive does, in the words of the standard and of the decisions on it.
#[derive(Clone, Copy, Debug)]
struct Model {
    state: PowerState,
    /// Neither fault nor quick stop since power-up.
    courtesy: bool,
    bit_7: bool,
    /// The quick stop is that of the input.
    emergency: bool,
}

#[derive(Clone, Copy, Debug)]
struct Surroundings {
    controlword: u16,
    operational: bool,
    emergency: bool,
    quick_stop_option: i16,
}

impl Model {
    fn tick(&mut self, now: Surroundings) {
        let rises = now.controlword & 0x80 != 0 && !self.bit_7;
        self.bit_7 = now.controlword & 0x80 != 0;
        self.courtesy &= !now.emergency;
        let commanded = expected(self.state, now.controlword);
        let before = self.state;
        self.state = match self.state {
            NotReadyToSwitchOn => SwitchOnDisabled,
            OperationEnabled | QuickStopActive if !now.operational => FaultReactionActive,
            FaultReactionActive => Fault,
            Fault if rises && now.operational => SwitchOnDisabled,
            Fault => Fault,
            _ if !now.operational => SwitchOnDisabled,
            QuickStopActive if commanded == SwitchOnDisabled => SwitchOnDisabled,
            QuickStopActive if now.quick_stop_option < 5 || self.emergency || now.emergency => SwitchOnDisabled,
            QuickStopActive if fits("01111", now.controlword) => OperationEnabled,
            QuickStopActive => QuickStopActive,
            OperationEnabled if now.emergency => QuickStopActive,
            _ if now.emergency => SwitchOnDisabled,
            SwitchOnDisabled if self.courtesy && fits("01111", now.controlword) => ReadyToSwitchOn,
            _ => commanded,
        };
        // Outside of OP the controlword is not looked at.
        let stopped_ready = now.operational && matches!(before, ReadyToSwitchOn | SwitchedOn) && fits("0x01x", now.controlword);
        self.courtesy &= !matches!(self.state, QuickStopActive | FaultReactionActive) && !stopped_ready;
        if before == OperationEnabled {
            self.emergency = now.emergency;
        }
    }
}

fn surroundings() -> impl Strategy<Value = Surroundings> {
    let word = prop_oneof![
        6 => prop::sample::select(vec![0x06, 0x07, 0x0F, 0x0F, 0x1F, 0x10F, 0x02, 0x00, 0x80, 0x8F]),
        1 => any::<u16>(),
    ];
    (
        word,
        prop::bool::weighted(0.95),
        prop::bool::weighted(0.05),
        prop::sample::select(vec![0i16, 1, 2, 5, 6]),
    )
        .prop_map(|(controlword, operational, emergency, quick_stop_option)| Surroundings {
            controlword,
            operational,
            emergency,
            quick_stop_option,
        })
}

proptest! {
    #[test]
    fn any_sequence_of_controlwords_network_losses_and_emergency_stops_goes_as_the_standard_says(
        mode in prop::sample::select(vec![0i8, 1, 3, 6, 8]),
        sequence in prop::collection::vec(surroundings(), 1..200),
    ) {
        let mut rig = drive_in_mode(NotReadyToSwitchOn, mode);
        rig.objects.input_1_function = 5;
        let mut model = Model { state: NotReadyToSwitchOn, courtesy: true, bit_7: false, emergency: false };
        for now in sequence {
            rig.objects.quick_stop_option = now.quick_stop_option;
            rig.inputs = now.emergency.into();
            rig.drive.set_network(now.operational);
            // A start of homing would move: bit 4 is kept for other tests.
            let now = Surroundings { controlword: now.controlword & !0x10, ..now };
            rig.command(now.controlword);
            model.tick(now);
            prop_assert_eq!(rig.state(), model.state, "{:?} {:?}", now, model);
            prop_assert_eq!(decoded(rig.objects.statusword), model.state);
            prop_assert_eq!(rig.is_powered() && !matches!(model.state, OperationEnabled | QuickStopActive | FaultReactionActive), false);
        }
    }
}
