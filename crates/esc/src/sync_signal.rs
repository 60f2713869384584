//! SYNC0 and SYNC1, the signals of the cyclic unit (ESC data sheet, section I, 9.2.3).
//!
//! All instants are the chip's copy of the system time, 64 bits wide and compared with respect to its wrap. However many pulses are due,
//! the work is the same.

/// What the registers say about the signals.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cycles {
    /// SYNC0 cycle time in ns; 0 for a single pulse.
    pub(crate) sync0: u32,
    /// SYNC1 cycle time in ns: the delay from the SYNC0 pulse that SYNC1 follows.
    pub(crate) sync1: u32,
}

impl Cycles {
    /// Time between two SYNC1 pulses: a SYNC0 pulse before the delay is over starts no other.
    fn sync1_period(self) -> u64 {
        u64::from(self.sync0) * u64::from(self.sync1).div_ceil(u64::from(self.sync0.max(1))).max(1)
    }
}

/// Which signals had a pulse, or are high.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Pulses {
    pub(crate) sync0: bool,
    pub(crate) sync1: bool,
}

/// One signal: its next pulse, and whether there was one.
#[derive(Clone, Copy, Debug, Default)]
struct Signal {
    next: u64,
    fired: bool,
    /// Not acknowledged by the slave since the last pulse.
    pending: bool,
}

/// Unit of the pulse length, in ns.
const PULSE_LENGTH_UNIT: u64 = 10;

impl Signal {
    fn run(&mut self, now: u64, period: u64) -> bool {
        if period == 0 && self.fired {
            return false;
        }
        let late = now.wrapping_sub(self.next);
        if late > i64::MAX as u64 {
            return false;
        }
        (self.fired, self.pending) = (true, true);
        if let Some(cycles) = late.checked_div(period) {
            self.next = self.next.wrapping_add((cycles + 1).wrapping_mul(period));
        }
        true
    }

    /// Whether the signal is high at `now`, up to which it has [run](Self::run): for the length of its pulse, or, in acknowledge mode
    /// (length 0), until the slave has read its status.
    fn is_high(&self, now: u64, period: u64, length: u16) -> bool {
        let last = self.next.wrapping_sub(period);
        match length {
            0 => self.pending,
            length => self.fired && now.wrapping_sub(last) < u64::from(length) * PULSE_LENGTH_UNIT,
        }
    }

    const fn first(at: u64) -> Self {
        Self {
            next: at,
            fired: false,
            pending: false,
        }
    }
}

/// The cyclic unit.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SyncSignals {
    active: bool,
    unreachable: bool,
    implausible: bool,
    sync0: Signal,
    sync1: Signal,
}

/// How a start time is judged.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StartRules {
    /// Only the lower 32 bits of the start time were given.
    pub(crate) short: bool,
    /// Start at once when the start time is not in the near future.
    pub(crate) plausibility: bool,
    /// The near future is 2^31 ns instead of 2^63 ns.
    pub(crate) near: bool,
}

impl SyncSignals {
    /// Starts cyclic operation at `start`, as asked at `now`.
    ///
    /// A start time in the past is never reached: the real chip waits for its clock to wrap, which takes 584 years.
    pub(crate) fn start(&mut self, start: u64, now: u64, rules: StartRules, cycles: Cycles) {
        let start = if rules.short {
            now.wrapping_add(u64::from((start as u32).wrapping_sub(now as u32)))
        } else {
            start
        };
        let ahead = start.wrapping_sub(now);
        let horizon = if rules.near { 1 << 31 } else { 1 << 63 };
        let implausible = ahead >= horizon;
        let first = if implausible && rules.plausibility { now } else { start };
        *self = Self {
            active: true,
            unreachable: first.wrapping_sub(now) > i64::MAX as u64,
            implausible,
            sync0: Signal::first(first),
            sync1: Signal::first(first.wrapping_add(u64::from(cycles.sync1))),
        };
    }

    /// Stops cyclic operation at once.
    pub(crate) fn stop(&mut self) {
        *self = Self::default();
    }

    /// Whether cyclic operation is on.
    pub(crate) const fn is_active(&self) -> bool {
        self.active
    }

    /// Lets time pass until `now`; which signals had one pulse or more.
    pub(crate) fn run(&mut self, now: u64, cycles: Cycles) -> Pulses {
        if !self.active || self.unreachable {
            return Pulses::default();
        }
        Pulses {
            sync0: self.sync0.run(now, u64::from(cycles.sync0)),
            sync1: self.sync1.run(now, cycles.sync1_period()),
        }
    }

    /// Which signals are high at `now`, up to which they have [run](Self::run), with pulses of `length` units.
    pub(crate) fn high(&self, now: u64, cycles: Cycles, length: u16) -> Pulses {
        Pulses {
            sync0: self.sync0.is_high(now, u64::from(cycles.sync0), length),
            sync1: self.sync1.is_high(now, cycles.sync1_period(), length),
        }
    }

    /// The slave has read the status of SYNC0 (0) or SYNC1 (1).
    pub(crate) const fn acknowledge(&mut self, index: usize) {
        match index {
            0 => self.sync0.pending = false,
            _ => self.sync1.pending = false,
        }
    }

    /// Times of the next SYNC0 and SYNC1.
    pub(crate) const fn next(&self) -> (u64, u64) {
        (self.sync0.next, self.sync1.next)
    }

    /// Activation status (0x0984): first pulse of SYNC0 or SYNC1 pending, start time not in the near future.
    pub(crate) fn status(&self) -> u8 {
        let pending0 = self.active && !self.sync0.fired;
        let pending1 = self.active && !self.sync1.fired;
        u8::from(pending0) | u8::from(pending1) << 1 | u8::from(self.implausible) << 2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAIN: StartRules = StartRules {
        short: false,
        plausibility: false,
        near: false,
    };

    fn started(start: u64, now: u64, rules: StartRules, sync0: u32, sync1: u32) -> (SyncSignals, Cycles) {
        let cycles = Cycles { sync0, sync1 };
        let mut signals = SyncSignals::default();
        signals.start(start, now, rules, cycles);
        (signals, cycles)
    }

    /// The instants of SYNC0 and SYNC1 when time passes in steps of 1.
    fn pulses(mut signals: SyncSignals, cycles: Cycles, from: u64, count: u64) -> ([u64; 2], [u64; 2]) {
        let mut seen = ([0; 2], [0; 2]);
        let (mut n0, mut n1) = (0, 0);
        for now in from..from + count {
            let pulses = signals.run(now, cycles);
            if pulses.sync0 && n0 < 2 {
                seen.0[n0] = now;
                n0 += 1;
            }
            if pulses.sync1 && n1 < 2 {
                seen.1[n1] = now;
                n1 += 1;
            }
        }
        seen
    }

    #[test]
    fn sync1_follows_sync0_by_its_cycle_time() {
        for (sync1, expected) in [
            (0, [50, 150]),
            (30, [80, 180]),
            (100, [150, 250]),
            (150, [200, 400]),
            (200, [250, 450]),
            (250, [300, 600]),
        ] {
            let (signals, cycles) = started(50, 0, PLAIN, 100, sync1);
            assert_eq!(pulses(signals, cycles, 0, 700), ([50, 150], expected), "SYNC1 cycle {sync1}");
        }
    }

    #[test]
    fn many_pulses_due_at_once_are_one_and_the_rhythm_stays() {
        let (mut signals, cycles) = started(1_000, 0, PLAIN, 1_000, 0);
        assert_eq!(signals.status(), 3);
        assert!(signals.run(1_000_000_000_500, cycles).sync0);
        assert_eq!(signals.next().0, 1_000_000_001_000);
        assert!(!signals.run(1_000_000_000_999, cycles).sync0);
        assert_eq!(signals.status(), 0);
    }

    #[test]
    fn cycle_time_zero_is_a_single_shot() {
        let (signals, cycles) = started(50, 0, PLAIN, 0, 20);
        assert_eq!(pulses(signals, cycles, 0, 300), ([50, 0], [70, 0]));
    }

    #[test]
    fn a_start_time_in_the_past_is_never_reached() {
        let (signals, cycles) = started(99, 100, PLAIN, 10, 0);
        assert_eq!(pulses(signals, cycles, 100, 1_000), ([0, 0], [0, 0]));
        assert_eq!(signals.status(), 7);
    }

    #[test]
    fn a_start_time_in_the_past_starts_at_once_with_plausibility_check() {
        let rules = StartRules {
            plausibility: true,
            ..PLAIN
        };
        let (signals, cycles) = started(99, 100, rules, 10, 0);
        assert_eq!(pulses(signals, cycles, 100, 50).0, [100, 110]);
        let rules = StartRules { near: true, ..rules };
        let (signals, cycles) = started(100 + (1 << 31), 100, rules, 10, 0);
        assert_eq!(pulses(signals, cycles, 100, 50).0, [100, 110]);
    }

    #[test]
    fn a_short_start_time_is_the_next_instant_that_ends_so() {
        let rules = StartRules { short: true, ..PLAIN };
        let (signals, _) = started(50, 7 << 32 | 40, rules, 100, 0);
        assert_eq!(signals.next().0, 7 << 32 | 50);
        let (signals, _) = started(50, 7 << 32 | 60, rules, 100, 0);
        assert_eq!(signals.next().0, 8 << 32 | 50);
    }

    #[test]
    fn pulses_go_on_over_the_wrap_of_the_clock() {
        let (mut signals, cycles) = started(u64::MAX - 5, u64::MAX - 10, PLAIN, 10, 0);
        assert!(signals.run(u64::MAX - 5, cycles).sync0);
        assert_eq!(signals.next().0, 4);
        assert!(!signals.run(3, cycles).sync0);
        assert!(signals.run(4, cycles).sync0);
    }
}
