//! The commanded motion of the axis: profile, filter, position counter.

use crate::profile::{Acceleration, Command, Generator, Interpolator, Position, Progress, SlidingAverage, Speed};

/// Where the axis is commanded to be.
///
/// A generator makes the motion, the sliding average 0x2009 smooths it, and what comes out is the position of 0x6064 and of the field.
#[derive(Clone, Debug)]
pub struct Motion {
    generator: Generator,
    filter: SlidingAverage,
    position: Position,
    velocity: Speed,
    /// What the shaft has travelled in this tick.
    travel: i64,
    /// Whether generator and filter have come to rest: asked for more often than it changes.
    standing: bool,
}

impl Motion {
    /// An axis that stands at position zero.
    pub const fn new() -> Self {
        Self {
            generator: Generator::at(Position::from_pulses(0), Speed::ZERO),
            filter: SlidingAverage::new(),
            position: Position::from_pulses(0),
            velocity: Speed::ZERO,
            travel: 0,
            standing: true,
        }
    }

    /// The position that the field has, within the 32-bit range.
    pub const fn position(&self) -> Position {
        self.position
    }

    /// The speed at which the field turned in the last tick.
    pub const fn velocity(&self) -> Speed {
        self.velocity
    }

    /// Sub-pulses that the field has turned in the last tick. Setting the position does not count.
    pub const fn travel(&self) -> i64 {
        self.travel
    }

    /// The position before the filter, which is where a stop would lead on from. It may lie outside the 32-bit range.
    pub const fn demand_position(&self) -> Position {
        self.generator.position()
    }

    /// The speed before the filter.
    pub const fn demand_velocity(&self) -> Speed {
        self.generator.velocity()
    }

    /// Whether the axis stands on a whole pulse, and the filter too has come to rest.
    pub const fn is_standing(&self) -> bool {
        self.standing
    }

    /// Takes the value of 0x2009, in microseconds.
    pub fn set_filter_time(&mut self, microseconds: u16) {
        self.filter.set_time(microseconds);
    }

    /// Moves on by a tick of a profile.
    #[inline(always)]
    pub fn run(&mut self, command: &Command) -> Progress {
        let progress = self.generator.step(command);
        self.advance();
        progress
    }

    /// Moves on by a tick of a stop.
    pub fn stop(&mut self, deceleration: Acceleration) {
        self.run(&Command::Stop { deceleration });
    }

    /// Moves on by a tick of interpolation.
    pub fn follow(&mut self, interpolator: &mut Interpolator) {
        interpolator.step();
        self.generator = Generator::at(interpolator.position(), interpolator.velocity());
        self.advance();
    }

    /// Gives up all motion at once, as without current; the axis is taken to be on the nearest whole pulse.
    pub fn rest(&mut self) {
        let nearest = Position::from_pulses(self.position.pulses());
        self.filter.clear();
        self.travel = nearest.sub_pulses_from(self.position);
        self.position = nearest;
        self.velocity = Speed::ZERO;
        self.generator = Generator::at(nearest, Speed::ZERO);
        self.standing = true;
    }

    /// Moves the origin of the position counter, so that it reads `pulses` more. The motion is not affected.
    pub const fn shift_counter(&mut self, pulses: i32) {
        self.position = self.position.offset_by(pulses).wrapped();
        self.generator.set_position(self.generator.position().offset_by(pulses).wrapped());
    }

    /// Brings the demand position back into the 32-bit range and returns the sub-pulses it was moved by, whole turns of that range.
    pub const fn wrap_demand(&mut self) -> i64 {
        let position = self.generator.position();
        let wrapped = position.wrapped();
        self.generator.set_position(wrapped);
        wrapped.sub_pulses() - position.sub_pulses()
    }

    fn advance(&mut self) {
        self.velocity = self.filter.step(self.generator.velocity());
        self.travel = self.velocity.sub_pulses_per_tick();
        self.position = self.position.after_tick(self.velocity).wrapped();
        self.standing = self.generator.is_standing() && self.filter.is_settled();
    }
}
