//! Homing mode: starts, halts and reports the homing sequences (manual 2.4.6).

use board::{Nanos, TICK};

use super::Context;
use crate::homing::{Homing, Outcome, Parameters};
use crate::motion::Motion;
use crate::profile::{Acceleration, Command};
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
    /// Ticks for which the axis has stood.
    rest_ticks: u16,
    homed: bool,
}

impl HomingMode {
    /// Not homed.
    pub const fn new() -> Self {
        Self {
            run: None,
            report: Report::Idle,
            shown_ticks: 0,
            rest_ticks: 0,
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
        let at_rest = self.is_at_rest(context, motion);
        let command = match &mut self.run {
            Some(run) if context.locked => {
                let signals = context.signals.switches;
                let action = run.step(signals, motion.position(), at_rest, &parameters(context));
                self.note(action.outcome, context, motion);
                action.command
            }
            _ => Command::Stop {
                deceleration: Acceleration::new(context.objects.homing_acceleration),
            },
        };
        motion.run(&before_limit(command, context, motion));
        self.bits(motion.is_standing())
    }

    /// Whether the axis has stood until the input filter (0x204B) has passed all that it met. Else an edge behind which the axis has come
    /// to rest would be taken for one of the next leg, which leads the other way.
    fn is_at_rest(&mut self, context: &Context, motion: &Motion) -> bool {
        if !motion.is_standing() {
            self.rest_ticks = 0;
            return false;
        }
        let at_rest = self.rest_ticks >= context.objects.input_filter;
        self.rest_ticks = self.rest_ticks.saturating_add(1);
        at_rest
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

/// What becomes of a command: an axis that brakes into a limit switch does so with 0x6085, whatever it brakes for.
fn before_limit(command: Command, context: &Context, motion: &Motion) -> Command {
    let in_the_way = context.signals.block(motion.demand_velocity().sub_pulses_per_tick());
    match command {
        Command::Stop { .. } if in_the_way => Command::Stop {
            deceleration: Acceleration::new(context.objects.quick_stop_deceleration.unsigned_abs()),
        },
        command => command,
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
