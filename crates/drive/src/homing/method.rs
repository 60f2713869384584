//! The homing methods of 0x6098 as tables.
//!
//! A method is told by three sequences of legs, of which the signal at the start and the limit switches met choose one. A leg runs at one
//! of the two homing speeds in one direction until an edge of the method's signal is seen; at the last leg's edge the axis is at home.
//!
//! 0x204C chooses between two variants (manual 2.4.6.1, 2.4.6.2). In variant 0 a leg that is repeated is fast, and one that may be the last
//! is slow. In variant 1 the switch is looked for fast, and everything next to it is done slowly; that variant is reconstructed, for the
//! manual's diagrams of it are not legible.

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
    /// The change of the method's signal that ends the leg.
    pub(super) edge: Edge,
    /// Whether the axis comes to rest behind the edge. If not, the next leg goes on in the same direction at its own speed.
    pub(super) rests: bool,
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

impl Method {
    /// The method `method` (0x6098) in the variant `variant` (0x204C), or `None` if the drive does not have it.
    pub fn lookup(method: i8, variant: u8) -> Option<&'static Self> {
        let own = match variant {
            0 => VARIANT_0,
            1 => VARIANT_1,
            _ => return None,
        };
        let mut methods = BOTH_VARIANTS.iter().chain(own);
        methods.find(|(number, _)| *number == method).map(|(_, method)| method)
    }
}

/// To the left edge of the home switch, from within.
#[rustfmt::skip]
const LEFT_EDGE_OUTWARD: Method = Method {
    signal: Some(Signal::Home),
    outside: &[fast(Positive, Rising), slow(Negative, Falling)],
    inside:  &[slow(Negative, Falling)],
    turned:  &[slow(Negative, Falling)],
};

/// To the left edge, from outside.
#[rustfmt::skip]
const LEFT_EDGE_INWARD: Method = Method {
    signal: Some(Signal::Home),
    outside: &[slow(Positive, Rising)],
    inside:  &[fast(Negative, Falling), slow(Positive, Rising)],
    turned:  &[fast(Negative, Falling), slow(Positive, Rising)],
};

/// To the right edge, from within.
#[rustfmt::skip]
const RIGHT_EDGE_OUTWARD: Method = Method {
    signal: Some(Signal::Home),
    outside: &[fast(Negative, Rising), slow(Positive, Falling)],
    inside:  &[slow(Positive, Falling)],
    turned:  &[slow(Positive, Falling)],
};

/// To the right edge, from outside.
#[rustfmt::skip]
const RIGHT_EDGE_INWARD: Method = Method {
    signal: Some(Signal::Home),
    outside: &[slow(Negative, Rising)],
    inside:  &[fast(Positive, Falling), slow(Negative, Rising)],
    turned:  &[fast(Positive, Falling), slow(Negative, Rising)],
};

/// The methods that are the same in both variants.
#[rustfmt::skip]
static BOTH_VARIANTS: &[(i8, Method)] = &[
    (19, LEFT_EDGE_OUTWARD),
    (20, LEFT_EDGE_INWARD),
    (21, RIGHT_EDGE_OUTWARD),
    (22, RIGHT_EDGE_INWARD),
    (35, Method { signal: None, outside: &[], inside: &[], turned: &[] }),
];

/// The other methods in variant 0. 17 and 18 stop at the limit at whatever speed they came. 23, 24, 27 and 28 differ from 19 to 22 only
/// in that the manual draws their turn at the limit.
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
    (23, LEFT_EDGE_OUTWARD),
    (24, LEFT_EDGE_INWARD),
    (25, Method {
        signal: Some(Signal::Home),
        outside: &[fast(Positive, Falling), slow(Negative, Rising)],
        inside:  &[fast(Positive, Falling), slow(Negative, Rising)],
        turned:  &[slow(Negative, Rising)],
    }),
    (26, Method {
        signal: Some(Signal::Home),
        outside: &[slow(Positive, Falling)],
        inside:  &[slow(Positive, Falling)],
        turned:  &[fast(Negative, Rising), slow(Positive, Falling)],
    }),
    (27, RIGHT_EDGE_OUTWARD),
    (28, RIGHT_EDGE_INWARD),
    (29, Method {
        signal: Some(Signal::Home),
        outside: &[fast(Negative, Falling), slow(Positive, Rising)],
        inside:  &[fast(Negative, Falling), slow(Positive, Rising)],
        turned:  &[slow(Positive, Rising)],
    }),
    (30, Method {
        signal: Some(Signal::Home),
        outside: &[slow(Negative, Falling)],
        inside:  &[slow(Negative, Falling)],
        turned:  &[fast(Positive, Rising), slow(Negative, Falling)],
    }),
];

/// The other methods in variant 1, reconstructed.
#[rustfmt::skip]
static VARIANT_1: &[(i8, Method)] = &[
    (17, Method {
        signal: Some(Signal::NegativeLimit),
        outside: &[fast(Negative, Rising), slow(Positive, Falling)],
        inside:  &[slow(Positive, Falling)],
        turned:  &[],
    }),
    (18, Method {
        signal: Some(Signal::PositiveLimit),
        outside: &[fast(Positive, Rising), slow(Negative, Falling)],
        inside:  &[slow(Negative, Falling)],
        turned:  &[],
    }),
    (23, Method {
        signal: Some(Signal::Home),
        outside: &[fast(Positive, Rising), slow(Negative, Falling)],
        inside:  &[slow(Negative, Falling)],
        turned:  &[fast(Negative, Rising).passing(), slow(Negative, Falling)],
    }),
    (24, Method {
        signal: Some(Signal::Home),
        outside: &[fast(Positive, Rising), slow(Negative, Falling), slow(Positive, Rising)],
        inside:  &[slow(Negative, Falling), slow(Positive, Rising)],
        turned:  &[fast(Negative, Rising).passing(), slow(Negative, Falling), slow(Positive, Rising)],
    }),
    (25, Method {
        signal: Some(Signal::Home),
        outside: &[fast(Positive, Rising).passing(), slow(Positive, Falling), slow(Negative, Rising)],
        inside:  &[slow(Positive, Falling), slow(Negative, Rising)],
        turned:  &[fast(Negative, Rising), slow(Positive, Falling), slow(Negative, Rising)],
    }),
    (26, Method {
        signal: Some(Signal::Home),
        outside: &[fast(Positive, Rising).passing(), slow(Positive, Falling)],
        inside:  &[slow(Positive, Falling)],
        turned:  &[fast(Negative, Rising), slow(Positive, Falling)],
    }),
    (27, Method {
        signal: Some(Signal::Home),
        outside: &[fast(Negative, Rising), slow(Positive, Falling)],
        inside:  &[slow(Positive, Falling)],
        turned:  &[fast(Positive, Rising).passing(), slow(Positive, Falling)],
    }),
    (28, Method {
        signal: Some(Signal::Home),
        outside: &[fast(Negative, Rising), slow(Positive, Falling), slow(Negative, Rising)],
        inside:  &[slow(Positive, Falling), slow(Negative, Rising)],
        turned:  &[fast(Positive, Rising).passing(), slow(Positive, Falling), slow(Negative, Rising)],
    }),
    (29, Method {
        signal: Some(Signal::Home),
        outside: &[fast(Negative, Rising).passing(), slow(Negative, Falling), slow(Positive, Rising)],
        inside:  &[slow(Negative, Falling), slow(Positive, Rising)],
        turned:  &[fast(Positive, Rising), slow(Negative, Falling), slow(Positive, Rising)],
    }),
    (30, Method {
        signal: Some(Signal::Home),
        outside: &[fast(Negative, Rising).passing(), slow(Negative, Falling)],
        inside:  &[slow(Negative, Falling)],
        turned:  &[fast(Positive, Rising), slow(Negative, Falling)],
    }),
];

const fn fast(direction: Direction, edge: Edge) -> Leg {
    leg(Pace::Fast, direction, edge)
}

const fn slow(direction: Direction, edge: Edge) -> Leg {
    leg(Pace::Slow, direction, edge)
}

const fn leg(pace: Pace, direction: Direction, edge: Edge) -> Leg {
    Leg {
        pace,
        direction,
        edge,
        rests: true,
    }
}

impl Leg {
    /// The same leg, without a rest behind its edge.
    const fn passing(mut self) -> Self {
        self.rests = false;
        self
    }
}
