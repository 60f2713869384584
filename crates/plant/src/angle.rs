//! Sine and cosine, the same bits on every machine.

/// A square root of a half, and with it the eighth of a period up to which the series are taken.
const EIGHTH: f64 = core::f64::consts::FRAC_PI_4;

/// Sine and cosine of an angle in periods, to 1e-13.
///
/// The angle has to be within 2^51 periods, far beyond what an axis can travel.
pub(crate) fn sin_cos(periods: f64) -> (f64, f64) {
    let eighths = periods * 8.0;
    // Nearest even eighth: what is left is within a quarter turn's half.
    let quarter = nearest(eighths / 2.0);
    let x = (eighths - quarter as f64 * 2.0) * EIGHTH;
    let (sine, cosine) = (sine(x), cosine(x));
    match quarter.rem_euclid(4) {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

/// The nearest whole number.
pub(crate) fn nearest(x: f64) -> i64 {
    (x + if x < 0.0 { -0.5 } else { 0.5 }) as i64
}

/// Taylor's series up to the thirteenth power: at most 2e-14 off within an eighth of a period.
fn sine(x: f64) -> f64 {
    let s = x * x;
    x * (1.0 - s / 6.0 * (1.0 - s / 20.0 * (1.0 - s / 42.0 * (1.0 - s / 72.0 * (1.0 - s / 110.0 * (1.0 - s / 156.0))))))
}

/// Taylor's series up to the fourteenth power.
fn cosine(x: f64) -> f64 {
    let s = x * x;
    1.0 - s / 2.0 * (1.0 - s / 12.0 * (1.0 - s / 30.0 * (1.0 - s / 56.0 * (1.0 - s / 90.0 * (1.0 - s / 132.0 * (1.0 - s / 182.0))))))
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
