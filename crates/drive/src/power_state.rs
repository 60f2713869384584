//! The power state machine of CiA 402 as a total pure function.

use crate::controlword::Command;

/// The states of the power state machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PowerState {
    /// Starting up.
    #[default]
    NotReadyToSwitchOn,
    /// Ready for commands, power off.
    SwitchOnDisabled,
    /// Power may be switched on.
    ReadyToSwitchOn,
    /// Power is on, the motor is not driven.
    SwitchedOn,
    /// The motor is driven and follows the mode.
    OperationEnabled,
    /// The motor stops, or was stopped, by a quick stop.
    QuickStopActive,
    /// The motor stops because of a fault.
    FaultReactionActive,
    /// A fault waits to be reset; power off.
    Fault,
}

/// What happens to the power state machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The start-up is over.
    Initialised,
    /// The controlword commands; also what stands in for a command: leaving OP disables voltage, the emergency stop input stops quickly.
    Command(Command),
    /// An enable command is seen in Switch On Disabled for the first time since power-up, and may walk up from there.
    PowerUpEnable,
    /// The quick stop is over and its option code does not hold its state.
    QuickStopCompleted,
    /// An enable command is seen in Quick Stop Active, whose option code allows to go on.
    Resume,
    /// A fault has been detected.
    FaultDetected,
    /// The fault reaction is over.
    FaultReactionCompleted,
    /// A fault reset is commanded and no cause of a fault is left.
    FaultReset,
}

impl PowerState {
    /// All states.
    pub const ALL: [Self; 8] = [
        Self::NotReadyToSwitchOn,
        Self::SwitchOnDisabled,
        Self::ReadyToSwitchOn,
        Self::SwitchedOn,
        Self::OperationEnabled,
        Self::QuickStopActive,
        Self::FaultReactionActive,
        Self::Fault,
    ];

    /// The state after `event`; the numbers are those of the transitions in CiA 402.
    pub const fn after(self, event: Event) -> Self {
        use Command::{DisableVoltage, EnableOperation, QuickStop, Shutdown, SwitchOn};
        match (self, event) {
            // 1
            (Self::NotReadyToSwitchOn, Event::Initialised) => Self::SwitchOnDisabled,
            // 2
            (Self::SwitchOnDisabled, Event::Command(Shutdown) | Event::PowerUpEnable) => Self::ReadyToSwitchOn,
            // 3; an enable command walks through Switched On
            (Self::ReadyToSwitchOn, Event::Command(SwitchOn | EnableOperation)) => Self::SwitchedOn,
            // 4
            (Self::SwitchedOn, Event::Command(EnableOperation)) => Self::OperationEnabled,
            // 5
            (Self::OperationEnabled, Event::Command(SwitchOn)) => Self::SwitchedOn,
            // 6, 8
            (Self::SwitchedOn | Self::OperationEnabled, Event::Command(Shutdown)) => Self::ReadyToSwitchOn,
            // 7, 10
            (Self::ReadyToSwitchOn | Self::SwitchedOn, Event::Command(DisableVoltage | QuickStop)) => Self::SwitchOnDisabled,
            // 9, 12
            (Self::OperationEnabled | Self::QuickStopActive, Event::Command(DisableVoltage)) => Self::SwitchOnDisabled,
            // 11
            (Self::OperationEnabled, Event::Command(QuickStop)) => Self::QuickStopActive,
            // 12
            (Self::QuickStopActive, Event::QuickStopCompleted) => Self::SwitchOnDisabled,
            // 13; of several faults the first one counts
            (Self::Fault, Event::FaultDetected) => Self::Fault,
            (_, Event::FaultDetected) => Self::FaultReactionActive,
            // 14
            (Self::FaultReactionActive, Event::FaultReactionCompleted) => Self::Fault,
            // 15
            (Self::Fault, Event::FaultReset) => Self::SwitchOnDisabled,
            // 16
            (Self::QuickStopActive, Event::Resume) => Self::OperationEnabled,
            _ => self,
        }
    }

    /// Whether the master has enabled the motor and leaving OP is therefore a fault.
    pub const fn is_enabled(self) -> bool {
        matches!(self, Self::OperationEnabled | Self::QuickStopActive)
    }

    /// Whether there is a fault.
    pub const fn is_faulty(self) -> bool {
        matches!(self, Self::FaultReactionActive | Self::Fault)
    }

    /// The state's bits in the statusword: bits 0 to 3, 5 and 6.
    ///
    /// Bit 5, quick stop, is low active; it is set from Ready To Switch On to Operation Enabled.
    pub const fn statusword_bits(self) -> u16 {
        match self {
            Self::NotReadyToSwitchOn => 0x00,
            Self::SwitchOnDisabled => 0x40,
            Self::ReadyToSwitchOn => 0x21,
            Self::SwitchedOn => 0x23,
            Self::OperationEnabled => 0x27,
            Self::QuickStopActive => 0x07,
            Self::FaultReactionActive => 0x0F,
            Self::Fault => 0x08,
        }
    }

    /// The state in words, as the standard names it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::NotReadyToSwitchOn => "Not Ready To Switch On",
            Self::SwitchOnDisabled => "Switch On Disabled",
            Self::ReadyToSwitchOn => "Ready To Switch On",
            Self::SwitchedOn => "Switched On",
            Self::OperationEnabled => "Operation Enabled",
            Self::QuickStopActive => "Quick Stop Active",
            Self::FaultReactionActive => "Fault Reaction Active",
            Self::Fault => "Fault",
        }
    }
}
