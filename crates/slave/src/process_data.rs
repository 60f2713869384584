//! Sync manager 2 to objects, objects to sync manager 3.

use dictionary::AbortCode;
use wire::register::sync_manager;
use wire::{EscAccess, Nanos};

use crate::application::Application;
use crate::communication_area::CommunicationArea;
use crate::configuration::MAX_PROCESS_DATA;
use crate::pdo::{Image, Target};
use crate::sync_managers::{self, INPUTS, OUTPUTS, SyncManager};

/// The process data of both directions while they are exchanged.
#[derive(Clone, Debug)]
pub(crate) struct ProcessData {
    outputs: Image,
    inputs: Image,
    output_sm: SyncManager,
    input_sm: SyncManager,
    /// The outputs that came last.
    latched: [u8; MAX_PROCESS_DATA],
    /// Whether outputs came since they were last applied.
    pub(crate) fresh: bool,
    /// Whether outputs came at all since SAFEOP began or an error was acknowledged.
    pub(crate) seen: bool,
    /// Whether the stack has switched a sync manager off because it gave up a state.
    deactivated: bool,
}

impl ProcessData {
    /// No process data.
    pub(crate) fn new() -> Self {
        Self {
            outputs: Image::default(),
            inputs: Image::default(),
            output_sm: SyncManager::default(),
            input_sm: SyncManager::default(),
            latched: [0; MAX_PROCESS_DATA],
            fresh: false,
            seen: false,
            deactivated: false,
        }
    }

    /// Starts with these images in these sync managers; what the master wrote before does not count.
    pub(crate) fn start(&mut self, esc: &mut impl EscAccess, outputs: Image, inputs: Image, all: &[SyncManager; 4]) {
        (self.outputs, self.inputs) = (outputs, inputs);
        (self.output_sm, self.input_sm) = (all[OUTPUTS], all[INPUTS]);
        self.latch(esc);
        self.forget();
    }

    /// Whether outputs are mapped.
    pub(crate) const fn has_outputs(&self) -> bool {
        self.outputs.size() != 0
    }

    /// Whether inputs are mapped.
    pub(crate) const fn has_inputs(&self) -> bool {
        self.inputs.size() != 0
    }

    /// Bytes of the outputs and of the inputs.
    pub(crate) const fn sizes(&self) -> (usize, usize) {
        (self.outputs.size(), self.inputs.size())
    }

    /// Whether the master's writes trigger the watchdog.
    pub(crate) const fn triggers_watchdog(&self) -> bool {
        self.has_outputs() && self.output_sm.triggers_watchdog()
    }

    /// Whether the master has moved the outputs, or the inputs, since [`Self::start`].
    pub(crate) fn was_moved(&self, all: &[SyncManager; 4]) -> (bool, bool) {
        (!self.output_sm.same_area(&all[OUTPUTS]), !self.input_sm.same_area(&all[INPUTS]))
    }

    /// Outputs that came so far do not count any more.
    pub(crate) fn forget(&mut self) {
        (self.fresh, self.seen) = (false, false);
    }

    /// Takes the outputs from the chip, which acknowledges their event.
    pub(crate) fn latch(&mut self, esc: &mut impl EscAccess) {
        if self.has_outputs() {
            esc.read(self.output_sm.start, &mut self.latched[..self.outputs.size()]);
            (self.fresh, self.seen) = (true, true);
        }
    }

    /// Writes the outputs latched last to the objects; an object that refuses its value keeps the old one.
    pub(crate) fn apply(&mut self, application: &mut impl Application) {
        self.fresh = false;
        self.outputs.scatter(&self.latched, |target, data| {
            if let Target::Application(slot) = target {
                let slot = usize::from(slot);
                // A PDO has no way to answer an abort code; the master sees the refusal in the objects.
                let _refused: Result<(), AbortCode> = application.may_write(slot).and_then(|()| application.store(slot, data));
            }
        });
    }

    /// Writes the mapped inputs to the chip.
    pub(crate) fn publish(&self, esc: &mut impl EscAccess, area: &CommunicationArea, application: &impl Application, now: Nanos) {
        let size = self.inputs.size();
        if size == 0 {
            return;
        }
        let mut bytes = [0; MAX_PROCESS_DATA];
        self.inputs.gather(&mut bytes, |target, out| match target {
            Target::Application(slot) => _ = application.load(slot.into(), out),
            Target::Fixed(slot) => _ = area.load_fixed(slot.into(), application.error_register(), now, out),
            Target::Gap => {}
        });
        esc.write(self.input_sm.start, &bytes[..size]);
    }

    /// Switches the outputs off in the chip, so that the master's working counter drops; without outputs, the inputs.
    pub(crate) fn deactivate(&mut self, esc: &mut impl EscAccess) {
        let index = if self.has_outputs() || !self.has_inputs() {
            OUTPUTS
        } else {
            INPUTS
        };
        sync_managers::write_pdi_control(esc, index, sync_manager::PDI_DEACTIVATE);
        self.deactivated = true;
    }

    /// Switches both directions off in the chip: below SAFEOP nobody serves them, and no working counter may say so.
    pub(crate) fn stop(&mut self, esc: &mut impl EscAccess) {
        for index in [OUTPUTS, INPUTS] {
            sync_managers::write_pdi_control(esc, index, sync_manager::PDI_DEACTIVATE);
        }
        self.deactivated = true;
    }

    /// Takes back [`Self::deactivate`] and [`Self::stop`]; new outputs must come then.
    pub(crate) fn reactivate(&mut self, esc: &mut impl EscAccess) {
        if self.deactivated {
            for index in [OUTPUTS, INPUTS] {
                sync_managers::write_pdi_control(esc, index, 0);
            }
            self.deactivated = false;
            self.forget();
        }
    }
}
