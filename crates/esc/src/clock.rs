//! The local clock of the distributed clocks, and the control loop that makes it follow the reference clock (ESC data sheet,
//! section I, 9).
//!
//! The clock is a line: a value at an instant, and a rate. Each system time that a frame brings bends the line: a share of the measured
//! difference is worked off by a slew of bounded rate, so that time never jumps or runs backwards, and a smaller share corrects the rate
//! itself, so that a constant drift vanishes. Jitter of the frames shifts both clocks' readings alike and cancels.

use wire::Nanos;

/// Binary places of clock values and rates.
const PLACES: u32 = 48;
/// Share of a difference that one update works off: 1/16.
const SLEW_SHIFT: u32 = 4;
/// Most that one update works off, so that one nonsensical time (SOEM broadcasts 0) hardly matters.
const MAX_SLEW_NS: i128 = 50_000;
/// Greatest difference that corrects the rate, for the same reason.
const MAX_INTEGRATED_NS: i64 = 10_000;
/// The rate's correction is stable with filter depths (0x0935) in this range.
const RATE_SHIFTS: core::ops::RangeInclusive<u8> = 8..=15;
/// Longest time between two updates that still says something about the rate.
const MAX_UPDATE_INTERVAL_NS: u64 = 1_000_000_000;

/// The control loop's settings, from registers 0x0930, 0x0934 and 0x0935.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LoopSettings {
    /// Speed counter start: the clock's rate is never changed by more than one part in this many.
    pub(crate) speed_start: u16,
    /// Depth of the difference's mean value.
    pub(crate) filter_depth: u8,
    /// Depth of the rate's correction.
    pub(crate) speed_depth: u8,
}

impl LoopSettings {
    /// Greatest change of rate.
    fn max_rate(self) -> i64 {
        (1 << PLACES) / i64::from(self.speed_start.max(0x80))
    }
}

/// The local clock.
#[derive(Clone, Debug)]
pub(crate) struct Clock {
    epoch: Nanos,
    value: i128,
    drift: i64,
    correction: i64,
    slew: i128,
    slew_rate: i64,
    updated: Option<Nanos>,
    mean: Option<i64>,
}

impl Clock {
    /// A clock that shows `offset` ns at time 0 and runs `ppb` parts per billion too fast.
    pub(crate) fn new(offset: u64, ppb: i32) -> Self {
        Self {
            epoch: Nanos(0),
            value: i128::from(offset) << PLACES,
            drift: ((i128::from(ppb) << PLACES) / 1_000_000_000) as i64,
            correction: 0,
            slew: 0,
            slew_rate: 0,
            updated: None,
            mean: None,
        }
    }

    /// What the clock shows at `at`, in ns; wraps.
    pub(crate) fn local(&self, at: Nanos) -> u64 {
        (self.value_at(at) >> PLACES) as u64
    }

    fn value_at(&self, at: Nanos) -> i128 {
        let elapsed = self.elapsed(at);
        self.value + elapsed * i128::from((1 << PLACES) + self.drift + self.correction) + self.slewed(elapsed)
    }

    fn elapsed(&self, at: Nanos) -> i128 {
        i128::from(at.0) - i128::from(self.epoch.0)
    }

    /// How much of the slew is worked off.
    fn slewed(&self, elapsed: i128) -> i128 {
        let possible = elapsed.max(0) * i128::from(self.slew_rate);
        self.slew.clamp(-possible, possible)
    }

    fn rebase(&mut self, at: Nanos) {
        let value = self.value_at(at);
        self.slew -= self.slewed(self.elapsed(at));
        self.value = value;
        self.epoch = at;
    }

    /// Takes over that the clock was `difference` ns ahead at `at`.
    pub(crate) fn follow(&mut self, at: Nanos, difference: i32, settings: LoopSettings) {
        self.rebase(at);
        let difference = i64::from(difference);
        self.mean = Some(match self.mean {
            // Eight binary places, lest the mean stop short of small differences.
            Some(mean) => mean + (((difference << 8) - mean) >> settings.filter_depth.min(15)),
            None => difference << 8,
        });
        let caught_up = self.slew == 0;
        let interval = self.updated.map_or(0, |updated| at.since(updated));
        if caught_up && (1..=MAX_UPDATE_INTERVAL_NS).contains(&interval) {
            // 10 000 ns with 48 binary places are just within an i64, as is an interval of up to a second.
            let share = (difference.clamp(-MAX_INTEGRATED_NS, MAX_INTEGRATED_NS) << PLACES) / interval as i64;
            let shift = settings.speed_depth.clamp(*RATE_SHIFTS.start(), *RATE_SHIFTS.end());
            let limit = settings.max_rate();
            self.correction = (self.correction - (share >> shift)).clamp(-limit, limit);
        }
        let limit = MAX_SLEW_NS << PLACES;
        self.slew = -(i128::from(difference) << (PLACES - SLEW_SHIFT)).clamp(-limit, limit);
        self.slew_rate = settings.max_rate();
        self.updated = Some(at);
    }

    /// Forgets what the control loop has learnt; the clock goes on from where it is.
    pub(crate) fn reset_loop(&mut self, at: Nanos) {
        self.rebase(at);
        self.correction = 0;
        self.slew = 0;
        self.updated = None;
        self.mean = None;
    }

    /// System time difference (0x092C): magnitude, and bit 31 when the local clock is behind.
    pub(crate) fn difference(&self) -> u32 {
        let mean = self.mean.unwrap_or(0);
        let magnitude = (mean.unsigned_abs() >> 8).min(0x7FFF_FFFF) as u32;
        if mean < 0 && magnitude != 0 {
            magnitude | 1 << 31
        } else {
            magnitude
        }
    }

    /// Speed counter difference (0x0932): the rate's correction, on a scale where the greatest is the speed counter start.
    pub(crate) fn speed_difference(&self, settings: LoopSettings) -> i16 {
        let start = i128::from(settings.speed_start.max(0x80));
        ((i128::from(self.correction) * start * start) >> PLACES).clamp(i128::from(i16::MIN), i128::from(i16::MAX)) as i16
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: LoopSettings = LoopSettings {
        speed_start: 0x1000,
        filter_depth: 4,
        speed_depth: 12,
    };

    /// Follows a perfect clock for `updates` every `interval` ns; the differences of the last quarter, at most.
    fn settle(clock: &mut Clock, lead: i64, interval: u64, updates: u64) -> i64 {
        let mut worst = 0;
        for update in 1..=updates {
            let at = Nanos(update * interval);
            let difference = clock.local(at).wrapping_sub(at.0) as i64 - lead;
            if update > updates * 3 / 4 {
                worst = worst.max(difference.abs());
            }
            clock.follow(at, difference as i32, SETTINGS);
        }
        worst
    }

    #[test]
    fn drift_is_compensated_at_every_usual_cycle_time() {
        for (interval, updates) in [
            (10_000, 200_000),
            (125_000, 40_000),
            (1_000_000, 8_000),
            (4_000_000, 6_000),
            (20_000_000, 6_000),
        ] {
            for ppb in [100_000, -100_000, 20_000, -1, 0] {
                let mut clock = Clock::new(0, ppb);
                let worst = settle(&mut clock, 0, interval, updates);
                assert!(worst <= 2, "{ppb} ppb, {interval} ns: {worst} ns");
                assert!(clock.difference() & 0x7FFF_FFFF <= 2);
            }
        }
    }

    #[test]
    fn an_initial_difference_is_worked_off() {
        let mut clock = Clock::new(300_000, 30_000);
        assert!(settle(&mut clock, 0, 1_000_000, 8_000) <= 2);
    }

    #[test]
    fn time_never_runs_backwards_nor_jumps() {
        let mut clock = Clock::new(1_000_000_000, 100_000);
        let mut before = clock.local(Nanos(0));
        let mut difference = 1_i32;
        for step in 1..20_000u64 {
            let at = Nanos(step * 1_000);
            let now = clock.local(at);
            assert!((999..=1_001).contains(&(now - before)), "{}", now - before);
            before = now;
            difference = difference.wrapping_mul(1_103_515_245).wrapping_add(12_345);
            if step % 7 == 0 {
                clock.follow(at, difference, SETTINGS);
            }
        }
    }

    #[test]
    fn one_nonsensical_time_moves_the_clock_by_less_than_fifty_microseconds() {
        let mut clock = Clock::new(0, 0);
        clock.follow(Nanos(1_000), i32::MIN, SETTINGS);
        let moved = clock.local(Nanos(10_000_001_000)) - 10_000_001_000;
        assert_eq!(moved, 50_000);
    }

    #[test]
    fn difference_is_sign_and_magnitude() {
        let mut clock = Clock::new(0, 0);
        clock.follow(Nanos(1), -5, SETTINGS);
        assert_eq!(clock.difference(), 0x8000_0005);
        clock.reset_loop(Nanos(2));
        assert_eq!(clock.difference(), 0);
        clock.follow(Nanos(3), 5, SETTINGS);
        assert_eq!(clock.difference(), 5);
        clock.reset_loop(Nanos(4));
        clock.follow(Nanos(5), i32::MIN, SETTINGS);
        assert_eq!(clock.difference(), 0xFFFF_FFFF);
    }

    #[test]
    fn the_clock_answers_for_times_before_its_last_update_and_wraps() {
        let mut clock = Clock::new(u64::MAX - 10, 0);
        assert_eq!(clock.local(Nanos(11)), 0);
        clock.follow(Nanos(1_000), 40, SETTINGS);
        assert_eq!(clock.local(Nanos(100)), 89);
        assert_eq!(
            Clock::new(0, i32::MAX).local(Nanos(u64::MAX)),
            Clock::new(0, i32::MAX).local(Nanos(u64::MAX))
        );
    }
}
