//! The trapezoid generator: one tick of motion towards what is commanded.

use super::braking::{stoppable, stopping_distance};
use super::quantity::{Acceleration, Position, Ramp, SUB_PULSES_PER_PULSE, Speed};

/// Below this speed a stop does not creep on to the next pulse at the speed it has, but at up to this one.
///
/// It bounds the time the last pulse takes to 10 ms (more only if the deceleration itself needs more).
const CREEP: Speed = Speed::from_pulses_per_second(100);

/// What to do in a tick. It may differ from that of the tick before in every respect; the speed never jumps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Move to a target and stand exactly on it. A target behind, or too near to stop at, is reached after turning round.
    MoveTo {
        /// Where to stand. Outside the 32-bit range it is still travelled to directly.
        target: Position,
        /// The speed not to exceed, of which the sign is ignored. 0 stands still.
        speed: Speed,
        /// The acceleration and deceleration.
        ramp: Ramp,
        /// The target after this one, if it is to be run on to without a stop.
        onward: Option<Onward>,
    },
    /// Reach a velocity and keep it; a reversal decelerates to zero and accelerates from there. Zero is a [`Command::Stop`].
    ///
    /// The position wraps at the ends of the 32-bit range.
    RunAt {
        /// The velocity.
        velocity: Speed,
        /// The acceleration and deceleration.
        ramp: Ramp,
    },
    /// Stand on the first whole pulse at which the deceleration allows it, then stay.
    ///
    /// The speed does not rise, except from less than 100 pulses/s to at most that for the rest of a pulse. The position wraps at the ends
    /// of the 32-bit range.
    Stop {
        /// The deceleration not to exceed.
        deceleration: Acceleration,
    },
}

/// The set-point after the one being moved to, known in advance ("change on set-point", controlword bit 9; manual 2.4.2).
///
/// If it lies further in the same direction, the first one is passed without slowing down more than the second one demands. Otherwise
/// the first one is stopped at. Either way, the tick that reports [`Progress::Reached`] is the last with this command: the next one moves to
/// the second target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Onward {
    /// Where to go after the first target.
    pub target: Position,
    /// The deceleration with which that motion will end.
    pub deceleration: Acceleration,
}

/// Whether the command of a tick has been fulfilled at its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// Not yet.
    Underway,
    /// `MoveTo`: stands on the target or, if there is an onward target, has reached or passed it. `RunAt`: has the velocity. `Stop`: stands.
    Reached,
}

/// The commanded motion: where it is and how fast.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Generator {
    position: Position,
    velocity: Speed,
}

impl Generator {
    /// A motion that is at `position` and travels `velocity` a tick, such as one taken over from another mode.
    pub const fn at(position: Position, velocity: Speed) -> Self {
        Self { position, velocity }
    }

    /// The commanded position at the end of the last tick.
    pub const fn position(&self) -> Position {
        self.position
    }

    /// The commanded velocity: what the last tick travelled.
    ///
    /// What needs the shaft's true motion, like the electrical angle, adds these up; the position itself jumps where it wraps or is set.
    pub const fn velocity(&self) -> Speed {
        self.velocity
    }

    /// Whether nothing moves and the position is that of a whole pulse.
    pub const fn is_standing(&self) -> bool {
        self.velocity.sub_pulses_per_tick() == 0 && self.position.is_whole_pulse()
    }

    /// Gives the present position another name, as homing does. The motion is not affected.
    pub const fn set_position(&mut self, position: Position) {
        self.position = position;
    }

    /// Moves on by one tick. Inlined, it needs not put together the command only to take it apart.
    #[inline(always)]
    pub fn step(&mut self, command: &Command) -> Progress {
        match *command {
            Command::MoveTo {
                target,
                speed,
                ramp,
                onward,
            } => self.step_to(target, speed, ramp, onward),
            Command::RunAt { velocity, ramp } if velocity == Speed::ZERO => self.step_to_stop(ramp.deceleration),
            Command::RunAt { velocity, ramp } => self.step_at(velocity, ramp),
            Command::Stop { deceleration } => self.step_to_stop(deceleration),
        }
    }

    fn step_to(&mut self, target: Position, speed: Speed, ramp: Ramp, onward: Option<Onward>) -> Progress {
        let start = self.position;
        let heading = self.heading_to(target);
        // Past the first target only the second one counts; from the first target on, both lie in whatever direction the second does.
        let onward = onward.filter(|onward| heading == 0 || (onward.target.cmp(&target) as i64) == heading);
        let (end, brake) = match onward {
            Some(onward) => (onward.target, ramp.deceleration.min(onward.deceleration)),
            None => (target, ramp.deceleration),
        };
        let limits = Limits {
            top: speed.sub_pulses_per_tick().abs(),
            ramp,
            brake,
        };
        let heading = self.heading_to(end);
        let remaining = end.sub_pulses().abs_diff(start.sub_pulses());
        self.travel(heading, limits, remaining);
        let passed = self.heading_to(target) * heading <= 0;
        if passed && onward.is_some() || self.position == target && self.velocity == Speed::ZERO {
            Progress::Reached
        } else {
            Progress::Underway
        }
    }

    /// The direction of `target` from here: 1, -1, or 0 on the spot.
    fn heading_to(&self, target: Position) -> i64 {
        target.cmp(&self.position) as i64
    }

    fn step_at(&mut self, velocity: Speed, ramp: Ramp) -> Progress {
        let heading = velocity.sub_pulses_per_tick().signum();
        let limits = Limits {
            top: velocity.sub_pulses_per_tick().abs(),
            ramp,
            brake: ramp.deceleration,
        };
        let along = self.velocity.sub_pulses_per_tick() * heading;
        self.advance(heading * limits.after_tick(along));
        self.position = self.position.wrapped();
        if self.velocity == velocity {
            Progress::Reached
        } else {
            Progress::Underway
        }
    }

    fn step_to_stop(&mut self, deceleration: Acceleration) -> Progress {
        self.position = self.position.wrapped();
        let past_pulse = self.position.sub_pulses().rem_euclid(SUB_PULSES_PER_PULSE);
        if self.velocity == Speed::ZERO && past_pulse == 0 {
            return Progress::Reached;
        }
        let speed = self.velocity.sub_pulses_per_tick().unsigned_abs();
        let ramp = Ramp {
            acceleration: deceleration,
            deceleration,
        };
        let limits = Limits {
            top: (speed as i64).max(CREEP.sub_pulses_per_tick()),
            ramp,
            brake: deceleration,
        };
        // At rest between two pulses the nearer one is the place to stand.
        let heading = match self.velocity.sub_pulses_per_tick().signum() {
            0 if past_pulse > SUB_PULSES_PER_PULSE / 2 => 1,
            0 => -1,
            moving => moving,
        };
        match stopping_distance(speed, deceleration.per_tick() as u64) {
            Some(distance) => {
                let stop_at = past_pulse * heading + distance as i64;
                let to_pulse = (-stop_at).rem_euclid(SUB_PULSES_PER_PULSE) as u64;
                self.travel(heading, limits, distance + to_pulse);
            }
            // So far from standing still, the pulse to stand on is not due to be chosen yet.
            None => self.advance(heading * (speed as i64 - deceleration.per_tick())),
        }
        self.position = self.position.wrapped();
        if self.is_standing() {
            Progress::Reached
        } else {
            Progress::Underway
        }
    }

    /// One tick towards a point `remaining` sub-pulses away in direction `heading`.
    #[inline(always)]
    fn travel(&mut self, heading: i64, limits: Limits, remaining: u64) {
        let velocity = self.velocity.sub_pulses_per_tick();
        // On the point itself, any motion leads away from it: it is treated as an approach with nothing remaining.
        let heading = if heading == 0 { velocity.signum() } else { heading };
        self.advance(heading * limits.approach(velocity * heading, remaining));
    }

    fn advance(&mut self, sub_pulses: i64) {
        self.velocity = Speed::from_sub_pulses_per_tick(sub_pulses);
        self.position = self.position.after_tick(self.velocity);
    }
}

/// What bounds the motion, in magnitudes along the direction of travel.
#[derive(Clone, Copy)]
struct Limits {
    /// The speed not to exceed, in sub-pulses a tick.
    top: i64,
    /// The changes of speed not to exceed.
    ramp: Ramp,
    /// The deceleration by which the end must be reachable, at most that of the ramp.
    brake: Acceleration,
}

impl Limits {
    /// The speed in the next tick if no end is in sight. `along` is the speed now, negative if it leads the wrong way.
    fn after_tick(self, along: i64) -> i64 {
        if along < 0 {
            return (along + self.ramp.deceleration.per_tick()).min(0);
        }
        (along + self.ramp.acceleration.per_tick()).min(self.top.max(self.slowest(along)))
    }

    /// The speed in the next tick if the motion is to end after `remaining` sub-pulses.
    fn approach(self, along: i64, remaining: u64) -> i64 {
        let wanted = self.after_tick(along);
        if wanted <= 0 {
            return wanted;
        }
        let allowed = stoppable(wanted as u64, remaining, self.brake.per_tick() as u64) as i64;
        // Too fast for the end: it is overrun as little as the ramp allows.
        allowed.max(self.slowest(along))
    }

    /// The least speed to which one tick can brake.
    fn slowest(self, along: i64) -> i64 {
        (along - self.ramp.deceleration.per_tick()).max(0)
    }
}
