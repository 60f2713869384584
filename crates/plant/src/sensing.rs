//! What the drive's analogue-to-digital converter makes of currents and voltage.

use board::{Milliamps, Millivolts};

use crate::angle::nearest;

/// Half the steps of a converter of 12 bits, which small motor controllers have.
const HALF_RANGE: f64 = 2048.0;

/// The converter's ranges and its noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensing {
    /// Current in ampere at the end of the range, either way; beyond it the converter shows the end.
    pub current_range: f64,
    /// Voltage at the end of the range in V.
    pub voltage_range: f64,
    /// Standard deviation of the noise on the currents, in steps of the converter. The same seed gives the same noise.
    pub noise: f64,
    /// Seed of the noise.
    pub seed: u64,
}

impl Default for Sensing {
    /// 12.8 A: a little above twice the greatest current that can be set (0x2000), so that currents after a loss of synchronism and an over-current
    /// at 12 A can be told apart from the end of the range; a step is 6.25 mA. 81.92 V, above what trips over-voltage (manual 1.6) and below what
    /// transistors for a 50 V supply take; a step is 20 mV. No noise.
    fn default() -> Self {
        Self {
            current_range: 12.8,
            voltage_range: 81.92,
            noise: 0.0,
            seed: 1,
        }
    }
}

/// A converter at work.
#[derive(Clone, Debug)]
pub(crate) struct Converter {
    sensing: Sensing,
    steps_per_ampere: f64,
    milliamps_per_step: f64,
    steps_per_volt: f64,
    millivolts_per_step: f64,
    random: u64,
}

impl Converter {
    pub(crate) fn new(sensing: Sensing) -> Self {
        Self {
            sensing,
            steps_per_ampere: HALF_RANGE / sensing.current_range,
            milliamps_per_step: sensing.current_range * (1000.0 / HALF_RANGE),
            steps_per_volt: 2.0 * HALF_RANGE / sensing.voltage_range,
            millivolts_per_step: sensing.voltage_range * (500.0 / HALF_RANGE),
            random: sensing.seed,
        }
    }

    pub(crate) fn current(&mut self, ampere: f64) -> Milliamps {
        let noise = if self.sensing.noise > 0.0 {
            self.sensing.noise * self.normal()
        } else {
            0.0
        };
        let steps = nearest((ampere * self.steps_per_ampere + noise).clamp(-HALF_RANGE, HALF_RANGE - 1.0));
        Milliamps(nearest(f64::from(steps) * self.milliamps_per_step))
    }

    pub(crate) fn voltage(&self, volt: f64) -> Millivolts {
        let steps = nearest((volt * self.steps_per_volt).clamp(0.0, 2.0 * HALF_RANGE - 1.0));
        Millivolts(nearest(f64::from(steps) * self.millivolts_per_step))
    }

    /// The sum of twelve even distributions, near enough to a normal one.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.even()).sum::<f64>() - 6.0
    }

    /// Evenly from 0 to 1, by Steele, Lea and Flood's SplitMix.
    fn even(&mut self) -> f64 {
        self.random = self.random.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.random;
        bits = (bits ^ bits >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ bits >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((bits ^ bits >> 31) >> 11) as f64 / (1_u64 << 53) as f64
    }
}
