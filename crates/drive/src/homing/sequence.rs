//! The interpreter of the method tables: from switches and position to motion and outcome, tick by tick.

use super::method::{Direction, Edge, Leg, Method, Pace, Signal};
use crate::profile::{Acceleration, Command, Position, Ramp, Speed};

/// The signals homing looks at, after filter, polarity and function (0x204B, 0x2008, 0x2007): whether each is on, or whether an input has it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Signals {
    /// The limit switch at the negative end of travel.
    pub negative_limit: bool,
    /// The limit switch at the positive end of travel.
    pub positive_limit: bool,
    /// The home switch.
    pub home: bool,
}

impl Signals {
    fn get(self, signal: Signal) -> bool {
        match signal {
            Signal::NegativeLimit => self.negative_limit,
            Signal::PositiveLimit => self.positive_limit,
            Signal::Home => self.home,
        }
    }

    fn limit_towards(self, direction: Direction) -> bool {
        match direction {
            Direction::Negative => self.negative_limit,
            Direction::Positive => self.positive_limit,
        }
    }

    fn both_limits(self) -> bool {
        self.negative_limit && self.positive_limit
    }
}

/// The speeds and ramps of homing. They may change while it runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parameters {
    /// 0x6099:01, in pulses/s. At 0 the axis does not search but stands, until homing is stopped.
    pub fast: u32,
    /// 0x6099:02, in pulses/s. At 0 the axis does not search but stands, until homing is stopped.
    pub slow: u32,
    /// 0x609A, in pulses/s^2: all acceleration, and deceleration other than at a switch.
    pub acceleration: u32,
    /// 0x6085, in pulses/s^2: deceleration at a switch.
    pub stop_deceleration: u32,
}

/// Why homing failed. The statusword shows it in bit 13.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HomingError {
    /// The drive has no such method in this variant.
    UnsupportedMethod,
    /// No input has the function of the signal that the method looks for (0x2007).
    SignalNotAssigned,
    /// Both limit switches are on.
    BothLimitsActive,
    /// A limit switch is in the way and the method, or what is left of it, does not turn round there.
    LimitInTheWay,
}

/// How far homing has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Searching.
    Running,
    /// The deciding edge was seen in this tick; reported once.
    Attained {
        /// The position at which the edge was seen: the one to become 0x607C. Setting the counter by a whole number of pulses,
        /// `0x607C - edge.pulses()`, keeps the pulses' grid.
        edge: Position,
    },
    /// Home is attained; the axis still brakes.
    Stopping,
    /// Home is attained and the axis stands.
    Finished,
    /// Homing was given up; the axis brakes, then stands.
    Failed(HomingError),
}

/// What homing wants in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Action {
    /// The motion.
    pub command: Command,
    /// The state of the search after this tick's signals.
    pub outcome: Outcome,
}

/// A homing run. It is interrupted by dropping it.
#[derive(Clone, Debug)]
pub struct Homing {
    method: &'static Method,
    phase: Phase,
    /// The signals of the tick before, for the edges.
    before: Signals,
}

/// Where a run is; each phase holds what it needs.
#[derive(Clone, Copy, Debug)]
enum Phase {
    /// Braking from the motion that was under way when homing was started.
    Settling,
    /// On a leg.
    Searching {
        leg: &'static Leg,
        /// The legs after it; none if its edge is the deciding one.
        rest: &'static [Leg],
        /// The legs to go on with if a limit is met; none if that is an error.
        at_limit: &'static [Leg],
    },
    /// Braking before the next leg.
    Turning { next: &'static [Leg] },
    /// Braking after the deciding edge.
    Overrunning,
    /// Standing, at home.
    Finished,
    /// Given up.
    Failed(HomingError),
}

impl Homing {
    /// Starts the method `method` (0x6098) in variant `variant` (0x204C). An axis that moves is stopped first.
    ///
    /// `assigned` tells which signals an input has, `signals` which are on; one that is not assigned is not on.
    ///
    /// # Errors
    /// An unsupported method; a method whose signal is not assigned; both limits on, unless the method does not move.
    pub fn start(method: i8, variant: u8, assigned: Signals, signals: Signals) -> Result<Self, HomingError> {
        let method = Method::lookup(method, variant).ok_or(HomingError::UnsupportedMethod)?;
        if let Some(signal) = method.signal {
            if !assigned.get(signal) {
                return Err(HomingError::SignalNotAssigned);
            }
            if signals.both_limits() {
                return Err(HomingError::BothLimitsActive);
            }
        }
        Ok(Self {
            method,
            phase: Phase::Settling,
            before: signals,
        })
    }

    /// Decides one tick. `position` is the commanded position now and `standing` whether it rests.
    #[inline(always)]
    pub fn step(&mut self, signals: Signals, position: Position, standing: bool, parameters: &Parameters) -> Action {
        let outcome = self.decide(signals, position, standing);
        self.before = signals;
        Action {
            command: self.command(parameters),
            outcome,
        }
    }

    fn decide(&mut self, signals: Signals, position: Position, standing: bool) -> Outcome {
        match self.phase {
            Phase::Settling if standing => self.begin(signals, position),
            Phase::Turning { next } if standing => self.set_out(next, &[], signals, position),
            Phase::Settling | Phase::Turning { .. } => self.unless_both_limits(signals),
            Phase::Searching { leg, rest, at_limit } => self.search(leg, rest, at_limit, signals, position),
            Phase::Overrunning if standing => {
                self.phase = Phase::Finished;
                Outcome::Finished
            }
            Phase::Overrunning => Outcome::Stopping,
            Phase::Finished => Outcome::Finished,
            Phase::Failed(error) => Outcome::Failed(error),
        }
    }

    /// Chooses the legs by the method's signal, once the axis stands.
    fn begin(&mut self, signals: Signals, position: Position) -> Outcome {
        match self.method.signal {
            None => {
                self.phase = Phase::Overrunning;
                Outcome::Attained { edge: position }
            }
            Some(signal) if signals.get(signal) => self.set_out(self.method.inside, &[], signals, position),
            Some(_) => self.set_out(self.method.outside, self.method.turned, signals, position),
        }
    }

    /// Goes on with the first of `legs`.
    fn set_out(&mut self, legs: &'static [Leg], at_limit: &'static [Leg], signals: Signals, position: Position) -> Outcome {
        match legs.split_first() {
            Some((leg, rest)) => {
                self.phase = Phase::Searching { leg, rest, at_limit };
                self.search(leg, rest, at_limit, signals, position)
            }
            None => self.fail(HomingError::LimitInTheWay),
        }
    }

    fn search(&mut self, leg: &Leg, rest: &'static [Leg], at_limit: &'static [Leg], signals: Signals, position: Position) -> Outcome {
        if signals.both_limits() {
            return self.fail(HomingError::BothLimitsActive);
        }
        if self.sees(leg.edge, signals) {
            return self.pass(leg, rest, position);
        }
        if signals.limit_towards(leg.direction) {
            if at_limit.is_empty() {
                return self.fail(HomingError::LimitInTheWay);
            }
            self.phase = Phase::Turning { next: at_limit };
        }
        Outcome::Running
    }

    /// The edge of `leg` was seen.
    fn pass(&mut self, leg: &Leg, rest: &'static [Leg], position: Position) -> Outcome {
        let (phase, outcome) = match rest {
            [] => (Phase::Overrunning, Outcome::Attained { edge: position }),
            next if leg.rests => (Phase::Turning { next }, Outcome::Running),
            [leg, rest @ ..] => {
                let at_limit = &[];
                (Phase::Searching { leg, rest, at_limit }, Outcome::Running)
            }
        };
        self.phase = phase;
        outcome
    }

    fn sees(&self, edge: Edge, signals: Signals) -> bool {
        let Some(signal) = self.method.signal else { return false };
        match (self.before.get(signal), signals.get(signal)) {
            (false, true) => edge == Edge::Rising,
            (true, false) => edge == Edge::Falling,
            _ => false,
        }
    }

    fn unless_both_limits(&mut self, signals: Signals) -> Outcome {
        if self.method.signal.is_some() && signals.both_limits() {
            return self.fail(HomingError::BothLimitsActive);
        }
        Outcome::Running
    }

    fn fail(&mut self, error: HomingError) -> Outcome {
        self.phase = Phase::Failed(error);
        Outcome::Failed(error)
    }

    fn command(&self, parameters: &Parameters) -> Command {
        let ordinary = Acceleration::new(parameters.acceleration);
        let quick = Acceleration::new(parameters.stop_deceleration);
        match self.phase {
            Phase::Settling => Command::Stop { deceleration: ordinary },
            Phase::Searching { leg, .. } => Command::RunAt {
                velocity: leg_velocity(leg, parameters),
                ramp: Ramp {
                    acceleration: ordinary,
                    deceleration: ordinary,
                },
            },
            Phase::Turning { .. } | Phase::Overrunning | Phase::Finished | Phase::Failed(_) => Command::Stop { deceleration: quick },
        }
    }
}

fn leg_velocity(leg: &Leg, parameters: &Parameters) -> Speed {
    let speed = i64::from(match leg.pace {
        Pace::Fast => parameters.fast,
        Pace::Slow => parameters.slow,
    });
    Speed::from_pulses_per_second(match leg.direction {
        Direction::Negative => -speed,
        Direction::Positive => speed,
    })
}
