//! What the current sensors read without a current, measured whenever the power stage is off.

use board::Milliamps;

/// Ticks after the power stage went off in which currents die away: 5 ms.
const DECAY: u32 = 100;
/// Ticks of a mean: 2 ms.
const MEAN: i32 = 40;
/// Samples within a mean that differ by more than this, in mA, are no offset: somebody turns the shaft so fast that the diodes conduct.
const CALM: i32 = 200;
/// An offset beyond this, in mA, is a broken sensor or amplifier: 5 % of a range of 12.8 A.
const MOST: i32 = 640;

/// Offsets of the two current sensors.
#[derive(Clone, Debug, Default)]
pub struct AutoZero {
    /// Ticks still to pass until currents have died away.
    decay: u32,
    count: i32,
    sums: [i32; 2],
    least: [i32; 2],
    most: [i32; 2],
    offsets: [i32; 2],
    known: bool,
}

impl AutoZero {
    /// A tick with the power stage on.
    pub fn on(&mut self) {
        (self.decay, self.count) = (DECAY, 0);
    }

    /// A tick with the power stage off throughout, and what the sensors read at its end.
    pub fn off(&mut self, currents: [Milliamps; 2]) {
        if self.decay > 0 {
            self.decay -= 1;
            return;
        }
        if self.count == 0 {
            (self.sums, self.least, self.most) = ([0; 2], [i32::MAX; 2], [i32::MIN; 2]);
        }
        self.count += 1;
        for (phase, current) in currents.into_iter().enumerate() {
            let current = current.0.clamp(-super::MOST_MEASURED, super::MOST_MEASURED);
            self.sums[phase] += current;
            self.least[phase] = self.least[phase].min(current);
            self.most[phase] = self.most[phase].max(current);
        }
        if self.count == MEAN {
            self.count = 0;
            if (0..2).all(|phase| self.most[phase] - self.least[phase] < CALM) {
                self.offsets = self.sums.map(|sum| sum / MEAN);
                self.known = true;
            }
        }
    }

    /// Whether the offsets have been measured.
    pub const fn is_known(&self) -> bool {
        self.known
    }

    /// The sensor whose offset is too large to be one: 0 or 1.
    pub fn broken(&self) -> Option<usize> {
        self.offsets.iter().position(|offset| offset.abs() > MOST)
    }

    /// The currents without the offsets.
    pub fn corrected(&self, currents: [Milliamps; 2]) -> [Milliamps; 2] {
        core::array::from_fn(|phase| Milliamps(currents[phase].0.saturating_sub(self.offsets[phase])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_steady_reading_is_an_offset_after_2_ms_and_only_with_the_power_stage_off_for_5_ms() {
        let mut zero = AutoZero::default();
        for tick in 0..40 {
            assert!(!zero.is_known(), "{tick}");
            zero.off([Milliamps(120), Milliamps(-80 + tick)]);
        }
        assert!(zero.is_known());
        assert_eq!(zero.corrected([Milliamps(1_120), Milliamps(0)]), [Milliamps(1_000), Milliamps(60)]);
        zero.on();
        for _ in 0..100 {
            zero.off([Milliamps(5_000); 2]);
        }
        for _ in 0..40 {
            zero.off([Milliamps(0); 2]);
        }
        assert_eq!(zero.corrected([Milliamps(7); 2]), [Milliamps(7); 2]);
    }

    #[test]
    fn a_current_that_swings_is_none_and_a_large_steady_one_is_a_broken_sensor() {
        let mut zero = AutoZero::default();
        for tick in 0..400 {
            zero.off([Milliamps(0), Milliamps(700 + tick % 40 * 6)]);
        }
        assert_eq!((zero.is_known(), zero.broken()), (false, None));
        for _ in 0..40 {
            zero.off([Milliamps(640), Milliamps(641)]);
        }
        assert_eq!((zero.is_known(), zero.broken()), (true, Some(1)));
    }
}
