//! Homing mode: starts, halts and reports the homing sequences (manual 2.4.6).

use board::{Nanos, TICK};

use super::Context;
use crate::homing::{Homing, Outcome, Parameters};
use crate::motion::Motion;
use crate::profile::Acceleration;
use crate::statusword::{MODE_BIT_12, MODE_BIT_13, TARGET_REACHED, flag};

/// The least time for which a started homing shows itself as running, even if it is over sooner, as method 35 is: masters wait for bits
/// 10 and 12 to drop.
const SHORTEST_RUN: Nanos = Nanos(10_000_000);

/// What bits 13, 12 and 10 tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Report {
    /// Not started, or interrupted.
    Idle,
    Running,
    /// The deciding edge was seen; the motor may still brake.
    Attained,
    Failed,
}

/// The homing mode.
#[derive(Clone, Debug)]
pub struct HomingMode {
    run: Option<Homing>,
    report: Report,
    /// Ticks for which the run shows itself as running in any case.
    shown_ticks: u64,
    homed: bool,
}

impl HomingMode {
    /// Not homed.
    pub const fn new() -> Self {
        Self {
            run: None,
            report: Report::Idle,
            shown_ticks: 0,
            homed: false,
        }
    }

    /// Whether the last homing was completed.
    pub const fn is_homed(&self) -> bool {
        self.homed
    }

    /// Ends a run before it is over.
    pub const fn interrupt(&mut self) {
        if self.run.is_some() && matches!(self.report, Report::Running) {
            self.report = Report::Idle;
        }
        self.run = None;
    }

    /// The mode was left: what it reported before no longer counts.
    pub const fn forget(&mut self) {
        self.report = Report::Idle;
    }

    /// Moves on by a tick; `cycle` is the master's.
    pub fn tick(&mut self, context: &Context, motion: &mut Motion, cycle: Nanos) -> u16 {
        if context.controlword.halt() {
            self.interrupt();
        } else if context.start && self.report != Report::Running {
            self.start(context, cycle);
        }
        self.shown_ticks = self.shown_ticks.saturating_sub(1);
        match &mut self.run {
            Some(run) if context.locked => {
                let signals = context.signals.switches;
                let action = run.step(signals, motion.position(), motion.is_standing(), &parameters(context));
                self.note(action.outcome, context, motion);
                motion.run(&action.command);
            }
            _ => motion.stop(Acceleration::new(context.objects.homing_acceleration)),
        }
        self.bits(motion.is_standing())
    }

    fn start(&mut self, context: &Context, cycle: Nanos) {
        let objects = context.objects;
        let signals = context.signals;
        self.homed = false;
        self.shown_ticks = SHORTEST_RUN.0.max(cycle.0.saturating_mul(2)) / TICK.0;
        let started = Homing::start(
            objects.homing_method,
            objects.homing_variant as u8,
            signals.assigned,
            signals.switches,
        );
        self.report = if started.is_ok() { Report::Running } else { Report::Failed };
        self.run = started.ok();
    }

    fn note(&mut self, outcome: Outcome, context: &Context, motion: &mut Motion) {
        match outcome {
            Outcome::Attained { edge } => {
                motion.shift_counter(context.objects.home_offset.wrapping_sub(edge.pulses()));
                self.homed = true;
                self.report = Report::Attained;
            }
            Outcome::Failed(_) => self.report = Report::Failed,
            Outcome::Running | Outcome::Stopping | Outcome::Finished => {}
        }
    }

    /// Bits 13, 12 and 10: running, idle, attained and failed each tell by bit 10 whether the motor stands.
    fn bits(&self, standing: bool) -> u16 {
        let standing = flag(standing, TARGET_REACHED);
        match self.report {
            Report::Running => 0,
            Report::Attained if self.shown_ticks > 0 => 0,
            Report::Idle => standing,
            Report::Attained => MODE_BIT_12 | standing,
            Report::Failed => MODE_BIT_13 | standing,
        }
    }
}

fn parameters(context: &Context) -> Parameters {
    let objects = context.objects;
    Parameters {
        fast: objects.homing_speed_fast,
        slow: objects.homing_speed_slow,
        acceleration: objects.homing_acceleration,
        stop_deceleration: objects.quick_stop_deceleration.unsigned_abs(),
    }
}
