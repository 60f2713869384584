//! The sliding average that smooths starts and stops (object 0x2009, manual 2.2.9).

use super::quantity::Speed;
use board::TICK;

/// The longest window: 25 600 us, the upper end of 0x2009.
const LONGEST: usize = 512;

/// A moving average over the travel of the last ticks.
///
/// What comes out in all is exactly what went in, the window's length later; a linear ramp becomes an S, with the jerk bounded by the
/// acceleration over the window's time.
#[derive(Clone, Debug)]
pub struct SlidingAverage {
    /// What went in, a ring of `length`; zero from there on.
    window: [i64; LONGEST],
    length: usize,
    /// The length to take at the next standstill.
    requested: usize,
    oldest: usize,
    sum: i64,
    /// What the divisions have left over so far, less than `length`.
    remainder: i64,
    /// Entries of the window that are not zero.
    moving: usize,
}

impl Default for SlidingAverage {
    fn default() -> Self {
        Self::new()
    }
}

impl SlidingAverage {
    /// A filter that lets everything through as it is.
    pub const fn new() -> Self {
        Self {
            window: [0; LONGEST],
            length: 1,
            requested: 1,
            oldest: 0,
            sum: 0,
            remainder: 0,
            moving: 0,
        }
    }

    /// Asks for a window of `microseconds`, the value of 0x2009, in whole ticks; less than two ticks do not filter, 25 600 us is the most.
    ///
    /// It takes effect when the window holds no motion: at once at standstill, else after the next one.
    pub fn set_time(&mut self, microseconds: u16) {
        let ticks = usize::from(microseconds) / (TICK.0 / 1000) as usize;
        self.requested = ticks.clamp(1, LONGEST);
    }

    /// Takes what a tick is to travel and gives what it travels after the filter.
    pub fn step(&mut self, travel: Speed) -> Speed {
        if self.is_settled() && self.length != self.requested {
            self.length = self.requested;
            self.oldest = 0;
        }
        let newest = travel.sub_pulses_per_tick();
        let oldest = core::mem::replace(&mut self.window[self.oldest], newest);
        self.oldest = if self.oldest + 1 == self.length { 0 } else { self.oldest + 1 };
        self.moving = self.moving + usize::from(newest != 0) - usize::from(oldest != 0);
        if self.length == 1 {
            return travel;
        }
        self.sum += newest - oldest;
        let length = self.length as i64;
        let total = self.remainder + self.sum;
        let quotient = total.div_euclid(length);
        self.remainder = total - quotient * length;
        Speed::from_sub_pulses_per_tick(quotient)
    }

    /// Whether everything that went in has come out.
    pub const fn is_settled(&self) -> bool {
        self.moving == 0
    }

    /// Forgets what has not come out yet: the axis stands where the filter's output left it.
    pub fn clear(&mut self) {
        if !self.is_settled() {
            self.window[..self.length].fill(0);
        }
        self.sum = 0;
        self.remainder = 0;
        self.moving = 0;
    }
}
