//! Angles: sine and cosine, the same bits on every machine, and the difference of two angles.

use core::f64::consts::TAU;

use board::ElectricalAngle;

/// 3 times 2^51: added to a number within 2^50, it leaves a sum without fraction whose last bits are the number's.
const WHOLE: f64 = 6_755_399_441_055_744.0;

/// How far away in radians another angle is worth turning to: what the rotor turns in a tick at 16 turns a second.
const NEAR: f64 = 0.25;

/// Taylor's series of the sine, divided by its argument, and of the cosine: factors of the argument's even powers.
const TERMS: [[f64; 2]; 8] = [
    [1.0, 1.0],
    [-1.0 / 6.0, -1.0 / 2.0],
    [1.0 / 120.0, 1.0 / 24.0],
    [-1.0 / 5_040.0, -1.0 / 720.0],
    [1.0 / 362_880.0, 1.0 / 40_320.0],
    [-1.0 / 39_916_800.0, -1.0 / 3_628_800.0],
    [1.0 / 6_227_020_800.0, 1.0 / 479_001_600.0],
    [-1.0 / 1_307_674_368_000.0, -1.0 / 87_178_291_200.0],
];
/// Pairs of terms that an eighth of a period takes, for 1e-14.
const FOR_AN_EIGHTH: usize = 4;
/// Pairs of terms that [`NEAR`] takes, for 4e-10.
const FOR_NEAR: usize = 2;

/// An angle with its sine and cosine.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Angle {
    periods: f64,
    pub(crate) sine: f64,
    pub(crate) cosine: f64,
}

impl Angle {
    pub(crate) const ZERO: Self = Self {
        periods: 0.0,
        sine: 0.0,
        cosine: 1.0,
    };

    /// An angle in periods, its sine and cosine to 1e-13. It has to be within 2^48, far beyond what an axis can travel.
    pub(crate) fn new(periods: f64) -> Self {
        // Nearest quarter, by a number whose last bit is worth 1: what is left is within an eighth of a period.
        let shifted = periods * 4.0 + WHOLE;
        let quarter = shifted.to_bits();
        let [sine, cosine] = series::<FOR_AN_EIGHTH>((periods * 4.0 - (shifted - WHOLE)) * (TAU / 4.0));
        let (sine, cosine) = if quarter & 1 == 0 { (sine, cosine) } else { (cosine, -sine) };
        let (sine, cosine) = if quarter & 2 == 0 { (sine, cosine) } else { (-sine, -cosine) };
        Self { periods, sine, cosine }
    }

    /// Another angle, at half the cost if it is near this one, but only to 1e-9.
    #[inline]
    pub(crate) fn turned_to(&self, periods: f64) -> Self {
        let way = (periods - self.periods) * TAU;
        if way.abs() > NEAR {
            return Self::new(periods);
        }
        let [sine, cosine] = series::<FOR_NEAR>(way);
        Self {
            periods,
            sine: self.sine * cosine + self.cosine * sine,
            cosine: self.cosine * cosine - self.sine * sine,
        }
    }

    /// This angle if it is the one asked for.
    #[inline]
    pub(crate) fn at(&self, periods: f64) -> Self {
        if self.periods == periods { *self } else { Self::new(periods) }
    }
}

/// Sine and cosine of an angle in radians. In pairs of terms, on which a processor works at the same time, as it cannot in Horner's scheme, and each
/// function by itself, because compilers that put two numbers into one register lose more by that than they gain.
#[inline(always)]
fn series<const PAIRS: usize>(x: f64) -> [f64; 2] {
    let s = x * x;
    let square = s * s;
    let sum = |of: usize| {
        let pair = |number: usize| TERMS[2 * number][of] + TERMS[2 * number + 1][of] * s;
        (0..PAIRS - 1)
            .rev()
            .fold(pair(PAIRS - 1), |sum, number| sum * square + pair(number))
    };
    [x * sum(0), sum(1)]
}

/// The nearest whole number within 2^31; of two that are as near, the even one.
pub(crate) fn nearest(x: f64) -> i32 {
    (x + WHOLE).to_bits() as i32
}

/// How far a shaft at `periods` lags behind a field, in electrical periods from -0.5 to 0.5.
pub(crate) fn lag(field: ElectricalAngle, periods: f64) -> f64 {
    const PERIOD: f64 = (1_u64 << 32) as f64;
    // The cast to i64 rounds towards zero and the one to u32 keeps the place within the period, also of negative positions.
    let shaft = (periods * PERIOD) as i64 as u32;
    f64::from(field.0.wrapping_sub(shaft) as i32) / PERIOD
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_and_cosine_are_those_of_the_standard_library() {
        for step in -40_000..40_000 {
            let periods = f64::from(step) / 9_973.0;
            let radians = periods * TAU;
            let check = |angle: Angle, most: f64| {
                assert!((angle.sine - radians.sin()).abs() < most, "sine at {periods}");
                assert!((angle.cosine - radians.cos()).abs() < most, "cosine at {periods}");
            };
            check(Angle::new(periods), 1e-13);
            for off in [0.0, 0.001, 0.0397, -0.0397, 0.3, 7.0] {
                check(Angle::new(periods + off).turned_to(periods), 1e-9);
            }
        }
    }

    #[test]
    fn whole_numbers_are_the_nearest() {
        for (number, whole) in [
            (0.4, 0),
            (0.6, 1),
            (-0.4, 0),
            (-0.6, -1),
            (2_147_483_647.0, i32::MAX),
            (-2_147_483_648.0, i32::MIN),
        ] {
            assert_eq!(nearest(number), whole, "{number}");
        }
    }
}
