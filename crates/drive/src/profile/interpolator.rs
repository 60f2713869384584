//! Cyclic synchronous position: straight lines between the targets a master sends (manual 2.4.4).

use board::{Nanos, TICK};

use super::quantity::{Position, Speed};

/// Follows the targets of a master, each of which is reached exactly one cycle after it came.
///
/// A cycle need not be a whole number of ticks. The time by which each synchronisation precedes the tick that sees it is reckoned from
/// cycle to cycle, and a target is laid on the tick in which its successor is expected: a cycle of 125 us takes 3 and 2 ticks in turn. Early
/// or late synchronisation sets that reckoning anew. If no successor comes, the axis stands on the last target; nothing is extrapolated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interpolator {
    position: Position,
    velocity: Speed,
    target: Position,
    /// What each tick of this cycle travels but the last, which travels the rest.
    share: Speed,
    /// Ticks in which the target is still to be reached.
    ticks_left: u64,
    /// Time from the synchronisation to the tick in which it was expected, less than a tick.
    expected_age: Nanos,
}

impl Interpolator {
    /// An interpolator that stands at `position` until the first target comes: on entry into the mode, the actual position.
    pub const fn at(position: Position) -> Self {
        let position = position.wrapped();
        Self {
            position,
            velocity: Speed::ZERO,
            target: position,
            share: Speed::ZERO,
            ticks_left: 0,
            expected_age: Nanos(0),
        }
    }

    /// Takes the target of a new cycle, in the tick in which its synchronisation (SYNC0, or SM2) was seen and before that tick's step.
    ///
    /// `target` is the value of 0x607A; it is approached the shorter way round the 32-bit range, from wherever the axis is. `cycle` is the
    /// nominal time to the next synchronisation; one shorter than a tick is taken for a tick.
    pub fn synchronise(&mut self, target: i32, cycle: Nanos) {
        let age = if self.ticks_left == 0 { self.expected_age.0 } else { 0 };
        let time_left = cycle.0.saturating_sub(age);
        self.expected_age = Nanos((TICK.0 - time_left % TICK.0) % TICK.0);
        self.ticks_left = time_left.div_ceil(TICK.0).max(1);
        self.target = Position::from_pulses(target);
        let distance = self.target.sub_pulses_from(self.position);
        self.share = Speed::from_sub_pulses_per_tick(distance / self.ticks_left as i64);
    }

    /// Moves on by one tick.
    ///
    /// A distance that would take more than [`Speed::MAX`] is travelled at that speed, for as long as it takes.
    pub fn step(&mut self) {
        self.velocity = match self.ticks_left {
            0 | 1 => Speed::from_sub_pulses_per_tick(self.target.sub_pulses_from(self.position)),
            _ => self.share,
        };
        if self.ticks_left == 0 {
            // The successor is overdue: when it comes, it tells nothing about the tick in which the next one will.
            self.expected_age = Nanos(0);
        }
        self.ticks_left = self.ticks_left.saturating_sub(1);
        self.position = self.position.after_tick(self.velocity).wrapped();
    }

    /// The position at the end of the last tick, within the 32-bit range.
    pub const fn position(&self) -> Position {
        self.position
    }

    /// What the last tick travelled.
    pub const fn velocity(&self) -> Speed {
        self.velocity
    }
}
