//! Why there is nothing to be written.

use std::fmt;

use super::experiment::Conditions;
use super::{Comparison, LONGEST, Ripple};
use crate::test_bench::NotEnabled;

/// Why there is nothing to be written.
#[derive(Clone, Debug, PartialEq)]
pub enum NotTuned {
    /// The motor has three phases.
    ThreePhases,
    /// The drive does not get enabled.
    NotEnabled(NotEnabled),
    /// The resonance is so slow that no experiment ends.
    TooSlow {
        /// Where it is to be expected, in turns a second.
        speed: f64,
        /// Inertia of motor and load, by that of the motor.
        inertia: f64,
    },
    /// The motor does not keep up with the drive under this load, whatever the speed.
    Overloaded,
    /// There is none between these speeds in turns a second.
    NoResonance(f64, f64),
    /// The motor turns evenly as it is.
    Smooth(Conditions, Ripple),
    /// The harmonic does not help.
    TooLittle(Comparison),
}

impl fmt::Display for NotTuned {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ThreePhases => write!(
                f,
                "0x2060 to 0x2062 act on motors of two phases only, for the manual has a phase for winding A and one for B; this motor has three"
            ),
            Self::NotEnabled(reason) => write!(f, "{reason}"),
            Self::TooSlow { speed, inertia } => write!(
                f,
                "motor and load have {inertia:.0} times the motor's inertia, which puts the first resonance at {speed:.3} turns/s, where every \
                 experiment would take more than {LONGEST} simulated seconds; an axis this inert needs a gear or a larger motor"
            ),
            Self::Overloaded => write!(
                f,
                "the motor falls out of step at every speed about the resonance; lessen the load torque or raise the current"
            ),
            Self::NoResonance(slowest, fastest) => write!(
                f,
                "the ripple has no maximum between {slowest:.3} and {fastest:.3} turns/s, where the first resonance is to be expected"
            ),
            Self::Smooth(Conditions { speed, .. }, ripple) => write!(
                f,
                "the motor turns evenly: about its first resonance, its speed deviates by {ripple} at the most, at {speed:.3} turns/s; there is \
                 nothing to be reduced"
            ),
            Self::TooLittle(Comparison { conditions, before, after }) => write!(
                f,
                "no values reduce the ripple at the first resonance, {:.3} turns/s, to half: the best of them from {before} to {after}. What \
                 makes the motor swing there is not of the kind that this harmonic cancels",
                conditions.speed
            ),
        }
    }
}

impl std::error::Error for NotTuned {}
