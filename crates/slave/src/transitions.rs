//! The checked steps of each change of state (ETG.1000.6, local management services).

use wire::al::{AlControl, AlState, AlStatus, AlStatusCode};
use wire::indicator::Pattern;
use wire::register;
use wire::{AlEvents, EscAccess, Nanos};

use crate::application::Application;
use crate::esm::{self, Decision};
use crate::event_log::Event;
use crate::indicators::{Origin, Patterns};
use crate::mailbox::REQUEST_EVENT;
use crate::pdo::Direction;
use crate::stack::Slave;
use crate::sync_managers::{self, INPUTS, OUTPUTS, SyncManager};
use crate::synchronization::{Mode, SyncUnit};

/// Why a transition did not happen: the state the device is in then, and the AL status code.
type Refusal = (AlState, AlStatusCode);

impl Slave {
    /// Answers what the master wrote to AL control.
    pub(crate) fn al_control(&mut self, esc: &mut impl EscAccess, application: &mut impl Application, now: Nanos) {
        let control = AlControl(esc.read_u16(register::AL_CONTROL));
        let decision = esm::decide(self.status, control);
        if decision == Decision::Ignore {
            return;
        }
        self.identifies = control.requests_identification();
        if self.status.error {
            self.acknowledge(esc);
        }
        // A request for OP while it is pending goes on waiting; any other takes its place.
        let pending = self.pending_op.take();
        let outcome = match decision {
            Decision::Ignore | Decision::Stay => Ok(self.status.state),
            Decision::Refuse(code) => Err((self.status.state, code)),
            Decision::Change(AlState::Op) => self.request_op(esc, pending.unwrap_or(now)),
            Decision::Change(target) => self.change(esc, application, target, now).map(|()| target),
        };
        let origin = Origin::Request(control.state_code());
        match outcome {
            Ok(state) => self.set_status(esc, state, AlStatusCode::None, origin),
            Err((state, code)) if state < self.status.state => self.give_up(esc, state, code, origin),
            Err((state, code)) => self.set_status(esc, state, code, origin),
        }
    }

    /// The pending error is acknowledged: the master may send outputs again.
    fn acknowledge(&mut self, esc: &mut impl EscAccess) {
        if self.status.state >= AlState::SafeOp {
            self.process.reactivate(esc);
        }
        (self.area.outputs.error, self.area.inputs.error) = (false, false);
    }

    /// Runs the steps to INIT, PREOP or SAFEOP.
    fn change(&mut self, esc: &mut impl EscAccess, application: &mut impl Application, target: AlState, now: Nanos) -> Result<(), Refusal> {
        if self.status.state >= AlState::SafeOp && target < AlState::SafeOp {
            self.process.stop(esc);
        }
        match (self.status.state, target) {
            (AlState::Init, AlState::PreOp) => self.start_mailbox(esc),
            (AlState::PreOp, AlState::SafeOp) => self.start_process_data(esc, application, now),
            (_, AlState::Init) => {
                self.stop_mailbox();
                Ok(())
            }
            // SAFEOP from OP: outputs just stop counting.
            _ => Ok(()),
        }
    }

    /// INIT to PREOP.
    fn start_mailbox(&mut self, esc: &mut impl EscAccess) -> Result<(), Refusal> {
        let all = sync_managers::read(esc);
        sync_managers::check_mailboxes(&all, &self.configuration.mailbox).map_err(|code| (AlState::Init, code))?;
        self.mailbox.start(esc, &all);
        self.reset_servers();
        // A choice of synchronisation holds for the master that made it, not for the next one.
        (self.area.outputs.chosen, self.area.inputs.chosen) = (false, false);
        Ok(())
    }

    /// To INIT.
    pub(crate) fn stop_mailbox(&mut self) {
        self.mailbox.stop();
        self.reset_servers();
    }

    /// Ends all transfers: mailbox communication starts anew, or stops.
    pub(crate) fn reset_servers(&mut self) {
        self.servers.reset();
        self.files.reset();
    }

    /// PREOP to SAFEOP.
    fn start_process_data(&mut self, esc: &mut impl EscAccess, application: &mut impl Application, now: Nanos) -> Result<(), Refusal> {
        let refuse = |code| (AlState::PreOp, code);
        let entries = application.entries();
        let image = |direction, code| self.area.pdo.image(direction, entries).ok_or(refuse(code));
        let inputs = image(Direction::Tx, AlStatusCode::InvalidInputMapping)?;
        let outputs = image(Direction::Rx, AlStatusCode::InvalidOutputMapping)?;

        let all = sync_managers::read(esc);
        sync_managers::check_mailboxes(&all, &self.configuration.mailbox).map_err(|code| (AlState::Init, code))?;
        sync_managers::check_process_data(&all, outputs.size(), inputs.size(), &self.configuration.process_window).map_err(refuse)?;
        self.choose_mode(esc, &all).map_err(refuse)?;
        check_watchdog(esc, &all).map_err(refuse)?;

        self.process.reactivate(esc);
        self.process.start(esc, outputs, inputs, &all);
        (self.last_sync0, self.inputs_due) = (None, None);
        esc.read_u8(register::DC_SYNC0_STATUS);
        self.meter = Default::default();
        // Masters read the inputs right after they see SAFEOP.
        self.publish(esc, application, now);
        Ok(())
    }

    /// SAFEOP to OP begins; it ends when outputs, and SYNC0, have come.
    fn request_op(&mut self, esc: &mut impl EscAccess, since: Nanos) -> Result<AlState, Refusal> {
        let all = sync_managers::read(esc);
        self.check_unchanged(&all)?;
        // Some masters set the SYNC unit up in SAFEOP.
        self.choose_mode(esc, &all).map_err(|code| (AlState::SafeOp, code))?;
        self.pending_op = Some(since);
        Ok(AlState::SafeOp)
    }

    /// Chooses what the process data follow.
    fn choose_mode(&mut self, esc: &mut impl EscAccess, all: &[SyncManager; 4]) -> Result<(), AlStatusCode> {
        let unit = SyncUnit::read(esc);
        let mode = unit.choose(&mut self.area.outputs, &mut self.area.inputs, self.configuration.minimum_cycle_ns)?;
        let one_buffer = |index: usize| all[index].is_enabled() && all[index].has_one_buffer();
        if mode == Mode::FreeRun && (one_buffer(OUTPUTS) || one_buffer(INPUTS)) {
            return Err(AlStatusCode::FreeRunNeedsThreeBuffers);
        }
        self.mode = mode;
        Ok(())
    }

    /// Checks the sync managers against those the present state was reached with.
    ///
    /// # Errors
    /// INIT for the mailboxes, PREOP for the process data.
    pub(crate) fn check_unchanged(&mut self, all: &[SyncManager; 4]) -> Result<(), Refusal> {
        sync_managers::check_mailboxes(all, &self.configuration.mailbox).map_err(|code| (AlState::Init, code))?;
        if self.status.state < AlState::SafeOp {
            return Ok(());
        }
        let refuse = |code| (AlState::PreOp, code);
        let (outputs, inputs) = self.process.sizes();
        sync_managers::check_process_data(all, outputs, inputs, &self.configuration.process_window).map_err(refuse)?;
        match self.process.was_moved(all) {
            (_, true) => Err(refuse(AlStatusCode::InvalidInputConfiguration)),
            (true, _) => Err(refuse(AlStatusCode::InvalidOutputConfiguration)),
            (false, false) => Ok(()),
        }
    }

    /// Shows a state and a code to the master: the code first, for masters read both at once. Without an error, the code's place is that of
    /// the device's identification while the master asks for it.
    pub(crate) fn set_status(&mut self, esc: &mut impl EscAccess, state: AlState, code: AlStatusCode, origin: Origin) {
        let error = code != AlStatusCode::None;
        let identified = self.identifies && !error;
        if error {
            self.area.log.add(event(self.status.state, state, code, origin));
        }
        self.status = AlStatus { state, error, identified };
        self.code = code;
        self.interest = interest(state);
        let shown = if identified {
            esc.read_u16(register::STATION_ALIAS)
        } else {
            code.code()
        };
        self.patterns = Patterns::new(state, code, origin);
        esc.write(register::RUN_LED, &[self.patterns.run, self.patterns.err].map(Pattern::to_override));
        esc.write_u16(register::AL_STATUS_CODE, shown);
        esc.write_u16(register::AL_STATUS, self.status.bits());
    }
}

/// What the log is told of an error.
const fn event(from: AlState, to: AlState, code: AlStatusCode, origin: Origin) -> Event {
    match origin {
        Origin::Request(requested) => Event::Refused {
            requested,
            state: to,
            code,
        },
        Origin::Device => Event::Left { from, to, code },
    }
}

/// A sync manager that triggers the watchdog needs one that runs.
fn check_watchdog(esc: &mut impl EscAccess, all: &[SyncManager; 4]) -> Result<(), AlStatusCode> {
    let outputs = &all[OUTPUTS];
    if outputs.is_enabled() && outputs.triggers_watchdog() && esc.read_u16(register::PROCESS_WATCHDOG_TIME) == 0 {
        return Err(AlStatusCode::InvalidWatchdogConfiguration);
    }
    Ok(())
}

/// The events that matter in a state.
const fn interest(state: AlState) -> u32 {
    let always = AlEvents::AL_CONTROL | AlEvents::SM_ACTIVATION;
    let process_data = AlEvents::SYNC0 | AlEvents::SYNC1 | AlEvents::sync_manager(OUTPUTS) | AlEvents::sync_manager(INPUTS) | REQUEST_EVENT;
    match state {
        AlState::Init | AlState::Boot => always,
        AlState::PreOp => always | REQUEST_EVENT,
        AlState::SafeOp => always | process_data,
        AlState::Op => always | process_data | AlEvents::PROCESS_WATCHDOG,
    }
}
