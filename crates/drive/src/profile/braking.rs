//! Braking in whole ticks: which speed can still be stopped within a distance, and which distance a stop takes.
//!
//! A stop from speed `v` with deceleration `d` runs `v - d`, `v - 2d`, ... for one tick each until nothing is left. Both questions are
//! sums of that series, and are answered exactly; all quantities are magnitudes in sub-pulses and ticks.

use crate::root::whole_root;

/// The longest distance reckoned with, more than the whole 32-bit range of pulses; beyond it, `8 t + 1` would not fit.
const FARTHEST: u64 = (u64::MAX - 1) / 8;

/// The largest speed not above `wanted` that may be run for the next tick and still be stopped within `remaining`.
///
/// That is the largest `v` with `v + (v - d) + (v - 2d) + ... <= remaining`.
pub(super) fn stoppable(wanted: u64, remaining: u64, deceleration: u64) -> u64 {
    if is_far(wanted, remaining, deceleration) {
        return wanted;
    }
    let remaining = remaining.min(FARTHEST);
    // The series has q + 1 terms, where q is the largest with d q (q + 1) / 2 <= remaining.
    let ratio = remaining / deceleration;
    let q = (u64::from(whole_root(8 * ratio + 1)) - 1) / 2;
    let fastest = (remaining + q * (q + 1) / 2 * deceleration) / (q + 1);
    fastest.min(wanted)
}

/// Whether `remaining` is so far above the stopping distance of `wanted`, v^2 / 2d, that the exact law cannot bind.
///
/// The factor covers the rounding of f32, and the addend more than what the series exceeds the integral by; so this decides only the
/// effort, never the result.
fn is_far(wanted: u64, remaining: u64, deceleration: u64) -> bool {
    // Speeds and decelerations are far below 2^63, and signed numbers become floats in one instruction.
    let (v, r, d) = (wanted as i64 as f32, remaining as f32, deceleration as i64 as f32);
    2.0 * d * r > 1.000_01 * v * v + 5.0 * v * d
}

/// The distance `(v - d) + (v - 2d) + ...` that a stop from `speed` takes, or `None` if it is longer than the whole range.
pub(super) fn stopping_distance(speed: u64, deceleration: u64) -> Option<u64> {
    let ticks = speed / deceleration;
    let at_full_speed = ticks.checked_mul(speed)?;
    // The sum lost is at most half of the product just found, hence it fits; one factor of two consecutive numbers is even.
    let (even, odd) = if ticks.is_multiple_of(2) {
        (ticks / 2, ticks + 1)
    } else {
        (ticks.div_ceil(2), ticks)
    };
    let distance = at_full_speed - even * odd * deceleration;
    (distance <= FARTHEST).then_some(distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The sum `v + (v - d) + (v - 2d) + ...`, term by term.
    fn series(speed: u64, deceleration: u64) -> u128 {
        let mut sum = 0;
        let mut term = speed;
        while term > 0 {
            sum += u128::from(term);
            term = term.saturating_sub(deceleration);
        }
        sum
    }

    proptest! {
        #[test]
        fn the_stoppable_speed_is_the_largest_whose_series_fits(remaining in 0u64..1 << 50, ticks in 1u64..2000) {
            let deceleration = (remaining / (ticks * ticks)).max(1).min(u64::from(u32::MAX));
            prop_assume!(remaining / deceleration < 1 << 22);
            let speed = stoppable(u64::MAX >> 8, remaining, deceleration);
            prop_assert!(series(speed, deceleration) <= u128::from(remaining));
            prop_assert!(series(speed + 1, deceleration) > u128::from(remaining));
        }

        #[test]
        fn the_short_cut_never_changes_the_result(speed in 1u64..1 << 46, deceleration in 1u64..1 << 32, scale in 0.9f64..1.1) {
            let stop = (speed as f64).powi(2) / (2.0 * deceleration as f64) * scale + 3.0 * speed as f64 * scale;
            prop_assume!(stop < FARTHEST as f64);
            let remaining = stop as u64;
            let exact = stoppable(u64::MAX >> 8, remaining, deceleration).min(speed);
            prop_assert_eq!(stoppable(speed, remaining, deceleration), exact);
        }

        #[test]
        fn the_stopping_distance_is_the_series_without_its_first_term(ticks in 0u64..3000, part in 0u64..1 << 32, deceleration in 1u64..1 << 32) {
            let speed = ticks * deceleration + part % deceleration;
            prop_assert_eq!(u128::from(stopping_distance(speed, deceleration).unwrap()), series(speed, deceleration) - u128::from(speed));
        }
    }

    #[test]
    fn a_stop_longer_than_the_range_has_no_distance() {
        assert_eq!(stopping_distance(u64::from(u32::MAX) * 20_000, 1), None);
        assert_eq!(stopping_distance(0, 1), Some(0));
    }

    #[test]
    fn the_whole_range_and_the_gentlest_ramp_do_not_overflow() {
        let speed = stoppable(u64::from(u32::MAX) * 20_000, u64::MAX, 1);
        assert!(stopping_distance(speed, 1).unwrap() + speed <= FARTHEST);
    }
}
