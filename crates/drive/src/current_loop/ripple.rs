//! A winding's answer to a square wave of 2.5 kHz: the voltage of the identification's second and fourth step, and what it does.

use board::TICK;

use super::vector::Vector;
use crate::root::square_root;

/// Ticks of a period of the square wave: 400 us.
pub const PERIOD: u32 = 8;
/// A tick in seconds.
pub const TICK_SECONDS: f32 = TICK.0 as f32 * 1e-9;
/// Half the square root of two.
const DIAGONAL: f32 = core::f32::consts::FRAC_1_SQRT_2;
/// Cosine at each tick of a period; the sine is two ticks behind it.
const COSINE: [f32; PERIOD as usize] = [1.0, DIAGONAL, 0.0, -DIAGONAL, -1.0, -DIAGONAL, 0.0, DIAGONAL];

/// The square wave of amplitude 1. It begins in the middle of its positive half, so that the current swings evenly about its mean from
/// the start.
pub const fn square(tick: u32) -> f32 {
    if (tick + PERIOD / 4) % PERIOD < PERIOD / 2 { 1.0 } else { -1.0 }
}

/// A complex number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Complex {
    re: f32,
    im: f32,
}

impl Complex {
    /// e^(j 2 pi / 8): the step of a tick.
    const TICK: Self = Self {
        re: DIAGONAL,
        im: DIAGONAL,
    };

    fn times(self, other: Self) -> Self {
        Self {
            re: self.re * other.re - self.im * other.im,
            im: self.re * other.im + self.im * other.re,
        }
    }

    fn over(self, other: Self) -> Self {
        let size = other.re * other.re + other.im * other.im;
        let conjugate = Self {
            re: other.re / size,
            im: -other.im / size,
        };
        self.times(conjugate)
    }

    fn minus(self, other: Self) -> Self {
        Self {
            re: self.re - other.re,
            im: self.im - other.im,
        }
    }

    fn size(self) -> f32 {
        square_root(self.re * self.re + self.im * self.im)
    }
}

/// Sums of a current and a voltage at the square wave's frequency: one bin of a discrete Fourier transform each.
#[derive(Clone, Copy, Debug, Default)]
pub struct Answer {
    current: [Complex; 2],
    voltage: [Complex; 2],
    ticks: u32,
}

impl Answer {
    /// Takes the current measured at the start of a tick, and the voltage commanded in it.
    pub fn add(&mut self, tick: u32, current: Vector, voltage: Vector) {
        let cosine = COSINE[(tick % PERIOD) as usize];
        let sine = COSINE[((tick + 3 * PERIOD / 4) % PERIOD) as usize];
        let sums = [(&mut self.current, current), (&mut self.voltage, voltage)];
        for (bins, sample) in sums {
            for (bin, value) in bins.iter_mut().zip([sample.a, sample.b]) {
                bin.re += value * cosine;
                bin.im -= value * sine;
            }
        }
        self.ticks += 1;
    }

    /// Amplitudes of the current's fundamental in ampere where two phases or three carry it.
    pub fn ripple(&self, three_phases: bool) -> [f32; 3] {
        let scale = 2.0 / self.ticks.max(1) as f32;
        let [a, b] = self.current;
        if !three_phases {
            return [a.size() * scale, b.size() * scale, f32::INFINITY];
        }
        let star = |sign: f32| Complex {
            re: -0.5 * a.re + sign * SIN_120 * b.re,
            im: -0.5 * a.im + sign * SIN_120 * b.im,
        };
        [a.size() * scale, star(1.0).size() * scale, star(-1.0).size() * scale]
    }

    /// The inductances in henry along both axes as they are if resistance does not count.
    pub fn inductances(&self) -> [f32; 2] {
        let step = Complex::TICK.minus(Complex { re: 1.0, im: 0.0 }).size();
        let along = |axis: usize| TICK_SECONDS * self.voltage[axis].size() / (step * self.current[axis].size()).max(LEAST);
        [along(0), along(1)]
    }

    /// The inductance in henry along the first axis, where the winding has this resistance in ohm.
    ///
    /// A tick's voltage moves the current by i' = a i + (1 - a) v / R with a = exp(-R Ts / L). In the bin z that is
    /// (1 - a) (1/R - H) = (z - 1) H for H = I / V, with z once more for each tick that the voltage takes to reach the winding; as many
    /// as make 1 - a real.
    pub fn inductance(&self, resistance: f32) -> Option<f32> {
        let mut answer = self.current[0].over(self.voltage[0]);
        let mut best: Option<Complex> = None;
        for _ in 0..=MOST_DELAY {
            let step = Complex::TICK.times(answer).minus(answer);
            let rest = Complex {
                re: 1.0 / resistance,
                im: 0.0,
            };
            let share = step.over(rest.minus(answer));
            if share.re > 0.0 && best.is_none_or(|best| (share.im / share.re).abs() < (best.im / best.re).abs()) {
                best = Some(share);
            }
            answer = Complex::TICK.times(answer);
        }
        let share = best?.re;
        let inductance = resistance * TICK_SECONDS / minus_log_of_rest(share);
        (share < 1.0 && inductance.is_finite()).then_some(inductance)
    }
}

/// Ticks that a voltage may take to reach the winding: none where it acts in the tick that commands it, one where the PWM takes it over
/// at the start of the next period.
const MOST_DELAY: u32 = 1;
/// Keeps divisions finite.
const LEAST: f32 = 1e-12;
/// Sine of 120 degrees.
const SIN_120: f32 = 0.866_025_4;

/// -ln(1 - x) for 0 <= x < 1, by the series of the inverse hyperbolic tangent of x / (2 - x).
fn minus_log_of_rest(x: f32) -> f32 {
    let t = x / (2.0 - x);
    let s = t * t;
    2.0 * t * (1.0 + s * (1.0 / 3.0 + s * (1.0 / 5.0 + s * (1.0 / 7.0 + s / 9.0))))
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::*;

    /// The answer of a winding in ohm and henry to the square wave, which reaches it so many ticks late.
    fn answer(resistance: f64, inductance: f64, late: usize) -> Answer {
        let decay = (-resistance * 50e-6 / inductance).exp();
        let (mut answer, mut current) = (Answer::default(), 0.0);
        let voltages: Vec<f64> = (0..2_000).map(|tick| f64::from(square(tick))).collect();
        for tick in 0..2_000 {
            let along = Vector { a: current as f32, b: 0.0 };
            if tick >= 1_600 {
                answer.add(
                    tick as u32,
                    along,
                    Vector {
                        a: voltages[tick] as f32,
                        b: 0.0,
                    },
                );
            }
            let acts = if tick < late { 0.0 } else { voltages[tick - late] };
            current = decay * current + (1.0 - decay) * acts / resistance;
        }
        answer
    }

    #[test]
    fn the_inductance_is_exact_whenever_the_voltage_acts() {
        for (resistance, inductance) in [(0.1, 0.5e-3), (1.0, 1e-3), (5.0, 1e-3), (4.0, 20e-3)] {
            for late in [0, 1] {
                let found = answer(resistance, inductance, late).inductance(resistance as f32).unwrap();
                let error = f64::from(found) / inductance - 1.0;
                assert!(error.abs() < 1e-3, "{resistance} ohm, {inductance} H, {late} ticks late: {error}");
            }
        }
    }

    #[test]
    fn the_logarithm_is_within_a_ten_thousandth() {
        for step in 1..60 {
            let x = step as f32 / 100.0;
            let truth = -(1.0 - f64::from(x)).ln();
            assert!((f64::from(minus_log_of_rest(x)) / truth - 1.0).abs() < 1e-4, "{x}");
        }
    }
}
