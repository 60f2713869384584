//! The homing methods of 0x6098 as tables.
//!
//! A method is told by three sequences of legs, of which the signal at the start and the limit switches met choose one. A leg runs at one
//! of the two homing speeds in one direction until an edge of the method's signal is seen; at the last leg's edge the axis is at home.

use Direction::{Negative, Positive};
use Edge::{Falling, Rising};

/// A homing method: which switch it looks for, and how.
#[derive(Debug, PartialEq, Eq)]
pub struct Method {
    /// The signal whose edges the legs await; `None` for a method that does not move.
    pub(super) signal: Option<Signal>,
    /// The legs when the signal is off at the start.
    pub(super) outside: &'static [Leg],
    /// The legs when the signal is on at the start.
    pub(super) inside: &'static [Leg],
    /// The legs after the first one of `outside` met a limit switch, so that the axis was on the wrong side. None: it may not.
    pub(super) turned: &'static [Leg],
}

/// A signal that homing looks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Signal {
    /// The limit switch at the negative end of travel.
    NegativeLimit,
    /// The limit switch at the positive end of travel.
    PositiveLimit,
    /// The home switch.
    Home,
}

/// Motion in one direction until an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Leg {
    pub(super) pace: Pace,
    pub(super) direction: Direction,
    pub(super) edge: Edge,
    pub(super) stop: Stop,
}

/// Which of the two homing speeds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pace {
    /// 0x6099:01.
    Fast,
    /// 0x6099:02.
    Slow,
}

/// The direction of travel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Direction {
    Negative,
    Positive,
}

/// A change of the method's signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Edge {
    /// From off to on.
    Rising,
    /// From on to off.
    Falling,
}

/// How a leg ends after its edge. The methods of variant 0 all end their legs alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stop {
    /// With 0x6085, the deceleration at limit, home and other sensors (manual 2.3.13).
    Quick,
}

impl Method {
    /// The method `method` (0x6098) in the variant `variant` (0x204C), or `None` if the drive does not have it.
    pub fn lookup(method: i8, variant: u8) -> Option<&'static Self> {
        let methods = match variant {
            0 => VARIANT_0,
            _ => return None,
        };
        methods.iter().find(|(number, _)| *number == method).map(|(_, method)| method)
    }
}

/// The methods of variant 0. In the manual's diagrams a leg that may have to be repeated is fast, the one to the deciding edge slow;
/// only 17 and 18 stop at the limit at whatever speed they came.
#[rustfmt::skip]
static VARIANT_0: &[(i8, Method)] = &[
    (17, Method {
        signal: Some(Signal::NegativeLimit),
        outside: &[fast(Negative, Rising)],
        inside:  &[slow(Positive, Falling)],
        turned:  &[],
    }),
    (18, Method {
        signal: Some(Signal::PositiveLimit),
        outside: &[fast(Positive, Rising)],
        inside:  &[slow(Negative, Falling)],
        turned:  &[],
    }),
    (19, Method {
        signal: Some(Signal::Home),
        outside: &[fast(Positive, Rising), slow(Negative, Falling)],
        inside:  &[slow(Negative, Falling)],
        turned:  &[slow(Negative, Falling)],
    }),
    (20, Method {
        signal: Some(Signal::Home),
        outside: &[slow(Positive, Rising)],
        inside:  &[fast(Negative, Falling), slow(Positive, Rising)],
        turned:  &[fast(Negative, Falling), slow(Positive, Rising)],
    }),
    (21, Method {
        signal: Some(Signal::Home),
        outside: &[fast(Negative, Rising), slow(Positive, Falling)],
        inside:  &[slow(Positive, Falling)],
        turned:  &[slow(Positive, Falling)],
    }),
    (35, Method { signal: None, outside: &[], inside: &[], turned: &[] }),
];

const fn fast(direction: Direction, edge: Edge) -> Leg {
    Leg {
        pace: Pace::Fast,
        direction,
        edge,
        stop: Stop::Quick,
    }
}

const fn slow(direction: Direction, edge: Edge) -> Leg {
    Leg {
        pace: Pace::Slow,
        direction,
        edge,
        stop: Stop::Quick,
    }
}
