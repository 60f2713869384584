//! The power state machine (CiA 402; manual 2.3.2, 2.3.3).

use drive::PowerState::{
    self, Fault, FaultReactionActive, NotReadyToSwitchOn, OperationEnabled, QuickStopActive, ReadyToSwitchOn, SwitchOnDisabled, SwitchedOn,
};

use super::{Verdict, View, must};

/// Ticks without current after power-on until the offsets of the current sensors are known: a mean of 40, which may have begun before them.
const OFFSETS: u32 = 80;

/// The transitions of the standard; that into Fault Reaction Active leads from everywhere but Fault.
const TRANSITIONS: [(PowerState, PowerState); 15] = [
    (NotReadyToSwitchOn, SwitchOnDisabled),
    (SwitchOnDisabled, ReadyToSwitchOn),
    (ReadyToSwitchOn, SwitchedOn),
    (ReadyToSwitchOn, SwitchOnDisabled),
    (SwitchedOn, OperationEnabled),
    (SwitchedOn, ReadyToSwitchOn),
    (SwitchedOn, SwitchOnDisabled),
    (OperationEnabled, SwitchedOn),
    (OperationEnabled, ReadyToSwitchOn),
    (OperationEnabled, SwitchOnDisabled),
    (OperationEnabled, QuickStopActive),
    (QuickStopActive, SwitchOnDisabled),
    (QuickStopActive, OperationEnabled),
    (FaultReactionActive, Fault),
    (Fault, SwitchOnDisabled),
];

/// What the master has to ask for before the motor is driven.
#[derive(Clone, Debug, Default)]
pub struct Power {
    /// Whether there was a fault, a quick stop or an emergency stop since power-on, after which an enable command alone does not enable.
    stopped: bool,
    /// Whether the power stage was on since power-on.
    driven: bool,
    /// Ticks without current in the windings.
    calm: u32,
    /// Whether the power stage was off in Operation Enabled, because of a fault that the drive has just met.
    gave_up: bool,
}

impl Power {
    /// Looks at a tick.
    ///
    /// # Errors
    /// What does not hold.
    pub fn tick(&mut self, view: &View) -> Verdict {
        let (before, after) = (view.before, view.state);
        let controlword = view.objects.controlword;
        if before != after {
            let known = TRANSITIONS.contains(&(before, after)) || after == FaultReactionActive && before != Fault;
            must(known, || format!("transition from {} to {}", before.name(), after.name()))?;
            self.check_enabling(before, after, controlword)?;
        }
        self.stopped |= matches!(after, FaultReactionActive | QuickStopActive) || view.signals.emergency_stop;

        let is_ready = matches!(after, ReadyToSwitchOn | SwitchedOn | OperationEnabled);
        must(view.operational || !is_ready && after != QuickStopActive, || {
            format!("{} outside of OP", after.name())
        })?;
        must(!view.signals.emergency_stop || !is_ready, || {
            format!("{} with an emergency stop", after.name())
        })?;
        let may_drive = matches!(after, OperationEnabled | QuickStopActive | FaultReactionActive) && !view.signals.offline;
        must(may_drive || !view.is_powered(), || format!("power stage on in {}", after.name()))?;
        self.driven |= view.is_powered();
        self.calm = if view.plant().motor().currents == [0.0; 2] {
            self.calm + 1
        } else {
            0
        };
        let knows_offsets = self.driven || self.calm > OFFSETS;
        let gives_up = after == OperationEnabled && !view.signals.offline && knows_offsets && !view.is_powered();
        must(!(gives_up && self.gave_up), || "power stage off in Operation Enabled".into())?;
        self.gave_up = gives_up;
        Ok(())
    }

    fn check_enabling(&self, before: PowerState, after: PowerState, controlword: u16) -> Verdict {
        let shutdown = controlword & 0x87 == 0x06;
        let enable = controlword & 0x8F == 0x0F;
        let asked_for = match (before, after) {
            (SwitchOnDisabled, ReadyToSwitchOn) => shutdown || enable && !self.stopped,
            (_, OperationEnabled) => enable,
            (ReadyToSwitchOn, SwitchedOn) => controlword & 0x87 == 0x07,
            _ => true,
        };
        must(asked_for, || format!("{} by controlword {controlword:04X}", after.name()))
    }
}
