//! What moves the power state machine: controlword, option codes, network, inputs and faults, one transition a tick.

use crate::controlword::{Command, Controlword};
use crate::objects::DriveObjects;
use crate::power_state::{Event, PowerState};

/// How an option code lets the motor stop (0x605A, 0x605B, 0x605C, 0x605E).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// Power off at once.
    Coast,
    /// With the mode's deceleration: 0x6084, in homing 0x609A.
    SlowDown,
    /// With 0x6085.
    Quick,
}

/// What the motor is to do in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activity {
    /// Nothing: the power stage is off.
    Off,
    /// What the mode says.
    Operate,
    /// Come to a standstill and hold.
    Stop(Stop),
}

/// What [`PowerControl::tick`] looks at.
#[derive(Clone, Copy, Debug)]
pub struct Situation {
    /// The controlword.
    pub controlword: Controlword,
    /// Whether the AL state is OP.
    pub operational: bool,
    /// Whether a fault has been detected that was not there before.
    pub fault_detected: bool,
    /// Whether the cause of the fault that was detected last is still there.
    pub fault_persists: bool,
    /// Whether the fault leaves no time for a stop.
    pub fault_forbids_stop: bool,
    /// Rising edge of an input that clears faults.
    pub fault_clear: bool,
    /// An emergency stop input is valid.
    pub emergency_stop: bool,
    /// The motor stands, and if there is a brake, it holds the shaft.
    pub standing: bool,
}

/// The power state machine together with what it has to remember.
#[derive(Clone, Debug)]
pub struct PowerControl {
    state: PowerState,
    /// Whether an enable command may walk up from Switch On Disabled without a Shutdown before: until the first fault, quick stop
    /// or emergency stop, so that the drive never enables by itself.
    courtesy: bool,
    /// Whether the emergency stop input has been seen in the quick stop or fault reaction under way, whose ramp no option code weakens then.
    emergency: bool,
    /// Whether the motor has been driven without a break since Operation Enabled.
    driven: bool,
    reset_bit: bool,
}

impl PowerControl {
    /// The state at power-up.
    pub const fn new() -> Self {
        Self {
            state: PowerState::NotReadyToSwitchOn,
            courtesy: true,
            emergency: false,
            driven: false,
            reset_bit: false,
        }
    }

    /// The state after the last tick.
    pub const fn state(&self) -> PowerState {
        self.state
    }

    /// Makes at most one transition and tells what the motor is to do then.
    pub fn tick(&mut self, situation: &Situation, objects: &DriveObjects) -> Activity {
        let command = situation.controlword.command();
        let reset_bit = situation.controlword.fault_reset();
        let reset = situation.fault_clear || reset_bit && !self.reset_bit;
        self.reset_bit = reset_bit;
        self.courtesy &= !situation.emergency_stop;
        if let Some(event) = self.event(command, situation, objects, reset) {
            self.enter(self.state.after(event), event);
        }
        let stopping = matches!(self.state, PowerState::QuickStopActive | PowerState::FaultReactionActive);
        self.emergency = stopping && (self.emergency || situation.emergency_stop);
        self.activity(command, situation, objects)
    }

    /// What happens in this tick.
    fn event(&self, command: Option<Command>, situation: &Situation, objects: &DriveObjects, reset: bool) -> Option<Event> {
        if situation.fault_detected {
            return Some(Event::FaultDetected);
        }
        match self.state {
            PowerState::NotReadyToSwitchOn => Some(Event::Initialised),
            PowerState::FaultReactionActive => self
                .stop_is_over(self.fault_stop(situation, objects), situation)
                .then_some(Event::FaultReactionCompleted),
            PowerState::Fault => (reset && !situation.fault_persists).then_some(Event::FaultReset),
            _ if !situation.operational => Some(Event::Command(Command::DisableVoltage)),
            PowerState::QuickStopActive => self.event_in_quick_stop(command, situation, objects),
            _ if situation.emergency_stop => Some(Event::Command(Command::QuickStop)),
            state => match (state, command?) {
                (PowerState::SwitchOnDisabled, Command::EnableOperation) => self.courtesy.then_some(Event::PowerUpEnable),
                (PowerState::OperationEnabled, command) => {
                    let over = disable_stop(command, objects).is_none_or(|stop| self.stop_is_over(stop, situation));
                    over.then_some(Event::Command(command))
                }
                (_, command) => Some(Event::Command(command)),
            },
        }
    }

    /// Whether a stop in the present state ends with the motor switched off, as all do but quick stops of options 5 and 6.
    pub const fn stop_switches_off(&self, objects: &DriveObjects) -> bool {
        !matches!(self.state, PowerState::QuickStopActive) || self.emergency || objects.quick_stop_option < 5
    }

    fn event_in_quick_stop(&self, command: Option<Command>, situation: &Situation, objects: &DriveObjects) -> Option<Event> {
        let stays = objects.quick_stop_option >= 5 && !self.emergency && !situation.emergency_stop;
        if command == Some(Command::DisableVoltage) {
            Some(Event::Command(Command::DisableVoltage))
        } else if stays {
            (command == Some(Command::EnableOperation)).then_some(Event::Resume)
        } else {
            self.stop_is_over(self.quick_stop(objects), situation)
                .then_some(Event::QuickStopCompleted)
        }
    }

    fn enter(&mut self, next: PowerState, event: Event) {
        if next == self.state {
            return;
        }
        if matches!(event, Event::FaultDetected | Event::Command(Command::QuickStop)) {
            self.courtesy = false;
        }
        self.driven = match next {
            PowerState::OperationEnabled => true,
            PowerState::QuickStopActive | PowerState::FaultReactionActive => self.driven,
            _ => false,
        };
        self.state = next;
    }

    fn activity(&mut self, command: Option<Command>, situation: &Situation, objects: &DriveObjects) -> Activity {
        let stop = match self.state {
            PowerState::OperationEnabled => match command.and_then(|command| disable_stop(command, objects)) {
                Some(stop) => stop,
                None => return Activity::Operate,
            },
            PowerState::QuickStopActive => self.quick_stop(objects),
            PowerState::FaultReactionActive => self.fault_stop(situation, objects),
            _ => Stop::Coast,
        };
        self.driven &= stop != Stop::Coast;
        if self.driven { Activity::Stop(stop) } else { Activity::Off }
    }

    /// The quick stop under way.
    fn quick_stop(&self, objects: &DriveObjects) -> Stop {
        match objects.quick_stop_option {
            _ if self.emergency => Stop::Quick,
            0 => Stop::Coast,
            1 | 5 => Stop::SlowDown,
            _ => Stop::Quick,
        }
    }

    /// The fault reaction under way.
    fn fault_stop(&self, situation: &Situation, objects: &DriveObjects) -> Stop {
        match objects.fault_reaction_option {
            _ if situation.fault_forbids_stop => Stop::Coast,
            0 => Stop::Coast,
            1 if !self.emergency => Stop::SlowDown,
            _ => Stop::Quick,
        }
    }

    fn stop_is_over(&self, stop: Stop, situation: &Situation) -> bool {
        stop == Stop::Coast || situation.standing || !self.driven
    }
}

/// How `command` stops the motor before it takes it out of Operation Enabled; `None` if it does not, or by a state of its own.
fn disable_stop(command: Command, objects: &DriveObjects) -> Option<Stop> {
    let option = match command {
        Command::Shutdown => objects.shutdown_option,
        Command::SwitchOn => objects.disable_operation_option,
        _ => return None,
    };
    Some(if option == 0 { Stop::Coast } else { Stop::SlowDown })
}
