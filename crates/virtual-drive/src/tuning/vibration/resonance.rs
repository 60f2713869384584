//! The search for the speed of the first resonance: around the expected one, in the whole range first and then between neighbours.

use super::experiment::{Conditions, Laboratory};
use super::{NotTuned, Progress, Ripple, SMOOTH, Values};
use crate::parallel;

/// Speeds of the first look, in parts of the expected one: from, step, and number.
const COARSE: (f64, f64, u32) = (0.6, 0.05, 15);
/// Halvings of the step about the greatest ripple.
const REFINEMENTS: u32 = 3;
/// The ripple has to be greater than at the ends of the range by this factor.
const PROMINENCE: f64 = 1.1;

/// The conditions of the greatest ripple, the ripple, and the number of experiments made.
pub(super) fn find(
    laboratory: &Laboratory,
    load_torque: f64,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<(Conditions, Ripple, usize), NotTuned> {
    let expected = laboratory.expected_resonance();
    let (first, mut step, count) = COARSE;
    let parts: Vec<f64> = (0..count).map(|place| first + step * f64::from(place)).collect();
    let at = |part: f64| Conditions {
        speed: part * expected,
        load_torque,
    };
    let measure = |parts: &[f64]| {
        parallel::map(parts, |part| {
            let ripple = laboratory.ripple(at(*part), Values::NONE);
            progress(Progress::Resonance);
            ripple
        })
    };

    let ripples = measure(&parts);
    if ripples.iter().all(|ripple| *ripple == Ripple::OUT_OF_STEP) {
        return Err(NotTuned::Overloaded);
    }
    let (mut best, mut greatest) = greatest(parts.iter().copied().zip(ripples.iter().copied()));
    if greatest < SMOOTH {
        return Err(NotTuned::Smooth(at(best), greatest));
    }
    let ends = [ripples[0], ripples[ripples.len() - 1]];
    if ends.iter().any(|end| greatest.0 < PROMINENCE * end.0) {
        let fastest = parts[parts.len() - 1];
        return Err(NotTuned::NoResonance(first * expected, fastest * expected));
    }
    for _ in 0..REFINEMENTS {
        step /= 2.0;
        let neighbours = [best - step, best + step];
        let ripples = measure(&neighbours);
        let candidates = neighbours.into_iter().zip(ripples).chain([(best, greatest)]);
        (best, greatest) = self::greatest(candidates);
    }
    Ok((at(best), greatest, parts.len() + 2 * REFINEMENTS as usize))
}

/// The part of the greatest ripple, and the ripple; of equals the first.
fn greatest(candidates: impl IntoIterator<Item = (f64, Ripple)>) -> (f64, Ripple) {
    candidates.into_iter().fold(
        (1.0, Ripple(f64::NEG_INFINITY)),
        |best, next| if next.1 > best.1 { next } else { best },
    )
}
