//! The search for the three values: a ring of phases, then steps that get smaller.

use std::collections::BTreeMap;

use super::experiment::{Conditions, Laboratory};
use super::{Progress, Ripple, Values};
use crate::parallel;

/// Phases that are tried first.
const RING: u16 = 16;
/// A whole turn of the phases, and half of it.
const TURN: i32 = 1024;
const HALF_TURN: i32 = TURN / 2;
/// Amplitudes in per mille that the search begins with, whatever the motor.
const AMPLITUDES: (f64, f64) = (8.0, 300.0);
/// Phase steps in a radian.
const PHASE_STEPS: f64 = TURN as f64 / std::f64::consts::TAU;

/// All that has been tried at a speed and a load.
pub(super) struct Search<'a> {
    laboratory: &'a Laboratory,
    conditions: Conditions,
    progress: &'a (dyn Fn(Progress) + Sync),
    tried: BTreeMap<Values, Ripple>,
    /// Experiments that may still be made.
    left: usize,
}

impl<'a> Search<'a> {
    pub(super) fn new(laboratory: &'a Laboratory, conditions: Conditions, limit: usize, progress: &'a (dyn Fn(Progress) + Sync)) -> Self {
        Self {
            laboratory,
            conditions,
            progress,
            tried: BTreeMap::new(),
            left: limit,
        }
    }

    /// Number of experiments so far.
    pub(super) fn experiments(&self) -> usize {
        self.tried.len()
    }

    /// The best values, beginning with an expected amplitude in per mille.
    ///
    /// A harmonic with phases half a turn apart acts against the detent torque; their common phase and the amplitude are what matters most.
    /// The difference of the phases follows, which acts against what the windings have not in common. A step of the phases is as long as
    /// one of the amplitude, so that the steps are alike in all directions.
    pub(super) fn best(&mut self, expected_amplitude: f64) -> (Values, Ripple) {
        let amplitude = expected_amplitude.clamp(AMPLITUDES.0, AMPLITUDES.1).round() as i32;
        let ring: Vec<Values> = (0..RING)
            .map(|place| i32::from(place) * (TURN / i32::from(RING)))
            .map(|phase| values(amplitude, phase + HALF_TURN, phase))
            .collect();
        self.try_all(&ring);
        let mut step = amplitude / 2;
        while step > 0 && self.left > 0 {
            let (centre, before) = self.leader();
            self.try_all(&around(centre, step));
            let (leader, after) = self.leader();
            if after < before {
                // The same way once more, as far again.
                self.try_all(&[beyond(centre, leader)]);
            } else {
                step /= 2;
            }
        }
        self.leader()
    }

    /// The best so far; of equals the first in order.
    fn leader(&self) -> (Values, Ripple) {
        let nothing = (Values::NONE, Ripple::OUT_OF_STEP);
        self.tried
            .iter()
            .map(|(values, ripple)| (*values, *ripple))
            .fold(nothing, |best, next| if next.1 < best.1 { next } else { best })
    }

    fn try_all(&mut self, candidates: &[Values]) {
        let mut new: Vec<Values> = candidates
            .iter()
            .copied()
            .filter(|values| !self.tried.contains_key(values))
            .collect();
        new.sort_unstable();
        new.dedup();
        new.truncate(self.left);
        self.left -= new.len();
        let found = parallel::map(&new, |values| {
            let ripple = self.laboratory.ripple(self.conditions, *values);
            (self.progress)(Progress::Values);
            ripple
        });
        self.tried.extend(new.into_iter().zip(found));
        (self.progress)(Progress::Best(self.leader().1));
    }
}

/// Neighbours in all directions, at a distance in per mille of the current.
fn around(centre: Values, step: i32) -> Vec<Values> {
    let [amplitude, a, b] = [centre.amplitude, centre.phase_a, centre.phase_b].map(i32::from);
    let turn = ((f64::from(step) / f64::from(amplitude.max(1)) * PHASE_STEPS).round() as i32).clamp(1, TURN / 8);
    let mut neighbours = vec![
        values(amplitude - step, a, b),
        values(amplitude + step, a, b),
        values(amplitude, a - turn, b - turn),
        values(amplitude, a + turn, b + turn),
        values(amplitude, a - turn, b + turn),
        values(amplitude, a + turn, b - turn),
    ];
    if step == 1 {
        neighbours.extend([(-turn, 0), (turn, 0), (0, -turn), (0, turn)].map(|(of_a, of_b)| values(amplitude, a + of_a, b + of_b)));
    }
    neighbours
}

/// As far beyond `to` as it is from `from`.
fn beyond(from: Values, to: Values) -> Values {
    let twice = |from: u16, to: u16| 2 * i32::from(to) - i32::from(from);
    values(
        twice(from.amplitude, to.amplitude),
        twice(from.phase_a, to.phase_a),
        twice(from.phase_b, to.phase_b),
    )
}

/// Values in the objects' ranges: phases go round.
fn values(amplitude: i32, phase_a: i32, phase_b: i32) -> Values {
    Values {
        amplitude: amplitude.clamp(0, 1000) as u16,
        phase_a: phase_a.rem_euclid(TURN) as u16,
        phase_b: phase_b.rem_euclid(TURN) as u16,
    }
}
