//! Finds the first resonance of a motor with its load, and the harmonic in the current that quiets it: objects 0x2060 to 0x2062.
//!
//! | module | holds |
//! |---|---|
//! | [`experiment`] | one experiment: a speed, a load, three values, and the ripple that comes of them |
//! | `resonance` | the search for the speed |
//! | `search` | the search for the values |
//! | `not_tuned` | why there are none |
//! | [`picture`] | the picture of before and after |
//! | [`parameters`] | the values as a file for the drive |
//!
//! The detent torque of a hybrid motor pulls the rotor four times in an electrical period. At a speed of a two-hundredth of the natural
//! frequency, in turns a second, it does so in time with the rotor's own swinging. A harmonic in the current that pulls the other way
//! cancels it. The manual names an amplitude and a phase for either winding, and not the harmonic; that it is the third is this project's
//! interpretation, so values found here are good for this project's drive and not known to be good for another.
//!
//! Every experiment runs the drive's own control law on the simulated motor, from rest. The same setup has the same result on every
//! machine.

pub mod experiment;
mod not_tuned;
pub mod parameters;
pub mod picture;
mod resonance;
mod search;
#[cfg(test)]
mod tests;

use std::fmt;

use drive::DriveObjects;
use plant::Phases;

use crate::parallel;
use crate::test_bench::Setup;
use experiment::{Conditions, Laboratory};
pub use not_tuned::NotTuned;
use search::Search;

/// Experiments until the values are known, those for the resonance among them.
pub const MOST_EXPERIMENTS: usize = 199;
/// The longest experiment that is begun, in simulated seconds.
const LONGEST: f64 = 60.0;
/// Less than this is not worth the work.
const SMOOTH: Ripple = Ripple(0.005);
/// The ripple has to fall to this part of itself at least.
const WORTH_WHILE: f64 = 0.5;
/// Speeds of the comparison, in parts of the resonance: from, step, and number.
const SPEEDS: (f64, f64, u32) = (0.5, 0.05, 21);
/// Loads of the comparison, in parts of the given one.
const LOADS: [f64; 3] = [0.0, 1.0, 3.0];
/// Experiments of the comparison: each of the conditions before and after.
pub const COMPARED: usize = 2 * (LOADS.len() + SPEEDS.2 as usize);

/// Values of the three objects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Values {
    /// 0x2060: the harmonic's amplitude in per mille of the current's.
    pub amplitude: u16,
    /// 0x2061: its phase in winding A, 1024 a turn.
    pub phase_a: u16,
    /// 0x2062: its phase in winding B.
    pub phase_b: u16,
}

impl Values {
    /// No harmonic, as at delivery.
    pub const NONE: Self = Self {
        amplitude: 0,
        phase_a: 0,
        phase_b: 0,
    };

    /// Index and value of each object.
    pub const fn objects(&self) -> [(u16, u16); 3] {
        [(0x2060, self.amplitude), (0x2061, self.phase_a), (0x2062, self.phase_b)]
    }

    fn set(self, objects: &mut DriveObjects) {
        (objects.harmonic_amplitude, objects.harmonic_phase_a, objects.harmonic_phase_b) = (self.amplitude, self.phase_a, self.phase_b);
    }
}

/// How unevenly a motor turns: its speed's deviation, root mean square, as a part of the speed.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Ripple(pub f64);

impl Ripple {
    /// The motor has lost an electrical period.
    pub const OUT_OF_STEP: Self = Self(f64::INFINITY);

    /// How many times another is as large.
    pub fn times_less_than(self, before: Self) -> f64 {
        before.0 / self.0
    }
}

impl fmt::Display for Ripple {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::OUT_OF_STEP => f.pad("out of step"),
            Self(part) => f.pad(&format!("{:.2} %", part * 100.0)),
        }
    }
}

/// The ripple under some conditions, without the harmonic and with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Speed and load.
    pub conditions: Conditions,
    /// Without.
    pub before: Ripple,
    /// With.
    pub after: Ripple,
}

impl Comparison {
    /// How many times less the ripple is with the harmonic.
    pub fn factor(&self) -> f64 {
        self.after.times_less_than(self.before)
    }
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Tuning {
    /// The values.
    pub values: Values,
    /// The ripple at the resonance with the given load.
    pub resonance: Comparison,
    /// Where the resonance was to be expected, in turns a second.
    pub expected_speed: f64,
    /// Experiments that it took to find the values.
    pub experiments: usize,
    /// At the resonance's speed without load, with the given load, and with three times as much.
    pub loads: Vec<Comparison>,
    /// At other speeds with the given load.
    pub speeds: Vec<Comparison>,
    /// The speed at the resonance, over four electrical periods: without the harmonic, and with it.
    pub courses: [experiment::Course; 2],
}

/// What has been done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress {
    /// An experiment that looks for the resonance.
    Resonance,
    /// An experiment with some values.
    Values,
    /// The least ripple so far.
    Best(Ripple),
    /// An experiment that compares before and after.
    Comparison,
}

/// Finds the values for a motor, its load and its supply, with a load torque in Nm; `progress` is told of every step.
///
/// # Errors
/// There are none that halve the ripple.
pub fn tune(setup: &Setup, load_torque: f64, progress: &(dyn Fn(Progress) + Sync)) -> Result<Tuning, NotTuned> {
    let motor = &setup.plant.motor;
    if motor.phases == Phases::Three {
        return Err(NotTuned::ThreePhases);
    }
    let laboratory = Laboratory::new(setup).map_err(NotTuned::NotEnabled)?;
    let expected_speed = laboratory.expected_resonance();
    if laboratory.duration() > LONGEST {
        return Err(NotTuned::TooSlow {
            speed: expected_speed,
            inertia: 1.0 + setup.plant.load.inertia / motor.inertia,
        });
    }
    let (conditions, before, spent) = resonance::find(&laboratory, load_torque, progress)?;
    let current = f64::from(setup.objects.peak_current) / 1e3;
    let expected_amplitude = motor.detent_torque / motor.holding_torque(current) * 1e3;
    let mut search = Search::new(&laboratory, conditions, MOST_EXPERIMENTS - spent, progress);
    let (values, after) = search.best(expected_amplitude);
    let resonance = worth_while(Comparison { conditions, before, after })?;
    let courses = parallel::map(&[Values::NONE, values], |values| laboratory.course(conditions, *values, 4));
    let compare = |conditions: Vec<Conditions>| {
        parallel::map(&conditions, |&conditions| {
            let [before, after] = [Values::NONE, values].map(|values| {
                progress(Progress::Comparison);
                laboratory.ripple(conditions, values)
            });
            Comparison { conditions, before, after }
        })
    };
    Ok(Tuning {
        values,
        resonance,
        expected_speed,
        experiments: spent + search.experiments(),
        loads: compare(loads(conditions, 0.1 * motor.holding_torque(current))),
        speeds: compare(speeds(conditions)),
        courses: courses.try_into().unwrap_or_default(),
    })
}

/// A result that halves the ripple at least.
fn worth_while(found: Comparison) -> Result<Comparison, NotTuned> {
    let is_worth_while = found.after.0.is_finite() && found.after.0 <= WORTH_WHILE * found.before.0;
    if is_worth_while {
        Ok(found)
    } else {
        Err(NotTuned::TooLittle(found))
    }
}

/// The comparison's loads; beside no load some of `usual`.
fn loads(conditions: Conditions, usual: f64) -> Vec<Conditions> {
    let given = if conditions.load_torque > 0.0 {
        conditions.load_torque
    } else {
        usual
    };
    let load = |part| Conditions {
        load_torque: part * given,
        ..conditions
    };
    LOADS.map(load).into()
}

/// The comparison's speeds.
fn speeds(conditions: Conditions) -> Vec<Conditions> {
    let (first, step, count) = SPEEDS;
    let speed = |place| conditions.speed * (first + step * f64::from(place));
    (0..count)
        .map(|place| Conditions {
            speed: speed(place),
            ..conditions
        })
        .collect()
}
