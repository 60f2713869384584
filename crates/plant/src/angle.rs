//! Angles: sine and cosine, the same bits on every machine, and the difference of two angles.

use board::ElectricalAngle;

/// An eighth of a period in radians: as far as the series are taken.
const EIGHTH: f64 = core::f64::consts::FRAC_PI_4;

/// 3 times 2^51: added to a number within 2^50, it leaves a sum without fraction whose last bits are the number's.
const WHOLE: f64 = 6_755_399_441_055_744.0;

/// Sine and cosine of an angle in periods, to 1e-13.
///
/// The angle has to be within 2^48 periods, far beyond what an axis can travel.
pub(crate) fn sin_cos(periods: f64) -> (f64, f64) {
    // Nearest quarter, by a number whose last bit is worth 1: what is left is within an eighth of a period.
    let shifted = periods * 4.0 + WHOLE;
    let quarter = shifted.to_bits();
    let x = (periods * 4.0 - (shifted - WHOLE)) * (2.0 * EIGHTH);
    let (sine, cosine) = (sine(x), cosine(x));
    let (sine, cosine) = if quarter & 1 == 0 { (sine, cosine) } else { (cosine, -sine) };
    if quarter & 2 == 0 { (sine, cosine) } else { (-sine, -cosine) }
}

/// The nearest whole number.
pub(crate) fn nearest(x: f64) -> i64 {
    (x + 0.5_f64.copysign(x)) as i64
}

/// Taylor's series up to the thirteenth power: at most 2e-14 off within an eighth of a period.
fn sine(x: f64) -> f64 {
    let s = x * x;
    x + x
        * s
        * polynomial(
            s,
            [
                -1.0 / 6.0,
                1.0 / 120.0,
                -1.0 / 5_040.0,
                1.0 / 362_880.0,
                -1.0 / 39_916_800.0,
                1.0 / 6_227_020_800.0,
            ],
        )
}

/// Taylor's series up to the fourteenth power.
fn cosine(x: f64) -> f64 {
    let s = x * x;
    let rest = [
        1.0 / 24.0,
        -1.0 / 720.0,
        1.0 / 40_320.0,
        -1.0 / 3_628_800.0,
        1.0 / 479_001_600.0,
        -1.0 / 87_178_291_200.0,
    ];
    1.0 - 0.5 * s + s * s * polynomial(s, rest)
}

/// A polynomial of the fifth degree, in pairs: a processor works on them at the same time, which it cannot do in Horner's scheme.
fn polynomial(s: f64, [c0, c1, c2, c3, c4, c5]: [f64; 6]) -> f64 {
    let square = s * s;
    (c0 + c1 * s) + square * ((c2 + c3 * s) + square * (c4 + c5 * s))
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
            let (sine, cosine) = sin_cos(periods);
            let radians = periods * core::f64::consts::TAU;
            assert!((sine - radians.sin()).abs() < 1e-13, "sine at {periods}");
            assert!((cosine - radians.cos()).abs() < 1e-13, "cosine at {periods}");
        }
    }
}
