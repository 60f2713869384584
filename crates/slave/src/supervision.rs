//! What makes the stack leave a state by itself, and what it waits for (ETG.1020, synchronisation errors).

use wire::al::{AlState, AlStatusCode};
use wire::register;
use wire::{EscAccess, Nanos};

use crate::application::Application;
use crate::indicators::Origin;
use crate::stack::{Slave, Sync};
use crate::sync_managers;
use crate::synchronization::Mode;

/// How long before the master's time-out the stack gives up waiting for outputs, in ns.
const MARGIN: u64 = 50_000_000;
/// How long SYNC0 may be missing at least, in ns.
const SHORTEST_SYNC0_TIMEOUT: u64 = 1_000_000;

impl Slave {
    /// A sync manager's activate register was written.
    pub(crate) fn sync_managers_changed(&mut self, esc: &mut impl EscAccess) {
        let all = sync_managers::read(esc);
        if self.status.state == AlState::Init {
            return;
        }
        if let Err((state, code)) = self.check_unchanged(&all) {
            return self.give_up(esc, state, code, Origin::Device);
        }
        if self.mailbox.was_moved(&all) {
            self.mailbox.start(esc, &all);
            self.reset_servers();
        }
        self.mailbox.follow_repeat(esc, all[sync_managers::MAILBOX_IN].repeat_requested());
    }

    /// The process data watchdog expired in OP.
    pub(crate) fn watchdog_expired(&mut self, esc: &mut impl EscAccess) {
        esc.read_u16(register::PROCESS_WATCHDOG_STATUS);
        if self.process.triggers_watchdog() {
            self.give_up(esc, AlState::SafeOp, AlStatusCode::SyncManagerWatchdog, Origin::Device);
        }
    }

    /// A SYNC0 came in OP without outputs before it.
    pub(crate) fn output_missed(&mut self, esc: &mut impl EscAccess) {
        for parameters in self.area.sync_parameters() {
            parameters.missed = parameters.missed.saturating_add(1);
        }
        if self.sequence.is_broken(self.area.sync_error_limit()) {
            (self.area.outputs.error, self.area.inputs.error) = (true, true);
            self.give_up(esc, AlState::SafeOp, AlStatusCode::SynchronizationError, Origin::Device);
        }
    }

    /// Watches SYNC0 in OP, and ends the wait for OP.
    pub(crate) fn supervise(&mut self, esc: &mut impl EscAccess, application: &mut impl Application, now: Nanos) -> Option<Sync> {
        match (self.status.state, self.mode, self.pending_op) {
            (AlState::Op, Mode::Sync0 { cycle }, _) if !self.sync0_runs(cycle, now) => {
                self.give_up(esc, AlState::SafeOp, AlStatusCode::FatalSyncError, Origin::Device);
                None
            }
            (AlState::SafeOp, _, Some(since)) => self.wait_for_op(esc, application, since, now),
            _ => None,
        }
    }

    /// Enters OP as soon as outputs, and SYNC0 if the process data follow it, are there.
    fn wait_for_op(&mut self, esc: &mut impl EscAccess, application: &mut impl Application, since: Nanos, now: Nanos) -> Option<Sync> {
        let clock = if let Mode::Sync0 { cycle } = self.mode {
            self.sync0_runs(cycle, now)
        } else {
            true
        };
        let outputs = !self.process.has_outputs() || (self.process.seen && self.watchdog_runs(esc));
        if clock && outputs {
            return self.enter_op(esc, application, now);
        }
        let limit = (u64::from(self.configuration.op_timeout_ms) * 1_000_000).saturating_sub(MARGIN);
        if now.since(since) >= limit {
            self.pending_op = None;
            let code = if clock {
                AlStatusCode::SyncManagerWatchdog
            } else {
                AlStatusCode::NoSyncSignal
            };
            self.set_status(esc, AlState::SafeOp, code, Origin::Request(AlState::Op.code()));
        }
        None
    }

    /// The outputs that came in SAFEOP take effect with the state, so that none of an earlier session do.
    fn enter_op(&mut self, esc: &mut impl EscAccess, application: &mut impl Application, now: Nanos) -> Option<Sync> {
        self.pending_op = None;
        self.sequence.start(now);
        for parameters in self.area.sync_parameters() {
            parameters.start_counting();
        }
        self.set_status(esc, AlState::Op, AlStatusCode::None, Origin::Request(AlState::Op.code()));
        self.process.has_outputs().then(|| self.take_effect(application))
    }

    /// Leaves a state for a lower one: outputs are not taken any more until the master has acknowledged.
    pub(crate) fn give_up(&mut self, esc: &mut impl EscAccess, state: AlState, code: AlStatusCode, origin: Origin) {
        self.pending_op = None;
        if self.status.state >= AlState::SafeOp {
            if state >= AlState::SafeOp {
                self.process.deactivate(esc);
            } else {
                self.process.stop(esc);
            }
        }
        if state == AlState::Init {
            self.stop_mailbox();
        }
        self.set_status(esc, state, code, origin);
    }

    /// Whether SYNC0 came within two cycles.
    fn sync0_runs(&self, cycle: u32, now: Nanos) -> bool {
        let limit = SHORTEST_SYNC0_TIMEOUT.max(2 * u64::from(cycle));
        self.last_sync0.is_some_and(|last| now.since(last) <= limit)
    }

    /// Whether the outputs are recent, as far as the master lets the chip watch that.
    fn watchdog_runs(&self, esc: &mut impl EscAccess) -> bool {
        !self.process.triggers_watchdog() || esc.read_u16(register::PROCESS_WATCHDOG_STATUS) & 1 != 0
    }
}
