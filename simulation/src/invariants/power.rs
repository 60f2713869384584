//! The power state machine (CiA 402; manual 2.3.2, 2.3.3).

use drive::PowerState::{
    self, Fault, FaultReactionActive, NotReadyToSwitchOn, OperationEnabled, QuickStopActive, ReadyToSwitchOn, SwitchOnDisabled, SwitchedOn,
};

use super::{Verdict, View, must};

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
        let must_drive = after == OperationEnabled && !view.signals.offline;
        must(!must_drive || view.is_powered(), || "power stage off in Operation Enabled".into())
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
