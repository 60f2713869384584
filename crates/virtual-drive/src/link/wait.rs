//! When to sleep, when to spin and when to block while waiting for a master's next frame.
//!
//! Waking up for a frame costs some 20 us more than finding it while looking for it. Looking all the time takes a whole core. A cyclic master
//! makes a third way possible: sleep until shortly before its next frame, look until shortly after, then block. At 1 kHz that takes a tenth of a
//! core while the master runs, and nothing at all while it does not.
//!
//! Traffic without a rhythm, or with a cycle too short for a sleep to fit in, is awaited by blocking. A master that sends its next frame
//! as soon as the last came back is such traffic; spinning for it would take a core for as long as it goes on.
use std::time::{Duration, Instant};

/// The longest time before an expected frame at which the wait for it begins.
pub const GUARD: Duration = Duration::from_micros(100);

/// Cycles outside of this range are not predicted. Below it, waking up takes a good part of the cycle; above it, nobody counts microseconds.
const PERIODS: std::ops::RangeInclusive<i64> = 400_000..=100_000_000;

/// A master may send up to this many frames per cycle and be recognised; one of them is predicted.
const MOST_FRAMES_PER_CYCLE: usize = 4;

/// So many cycles of the same length make a rhythm.
const CYCLES_TO_LOCK: usize = 4;

/// Arrivals remembered while looking for a rhythm.
const HISTORY: usize = MOST_FRAMES_PER_CYCLE + CYCLES_TO_LOCK;

/// So many frames off the expected times, with none on time between them, end a rhythm.
const MOST_STRAYS: u32 = 16;

/// What to do until the next frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plan {
    /// No frame is expected before this time, but one may come: sleep so that it wakes.
    SleepUntil(Instant),
    /// A frame is due within the guard time: a last chance to do something else. Given once per cycle.
    Announce,
    /// Look for the frame without sleeping until this time.
    SpinUntil(Instant),
    /// Nothing is known about the next frame.
    Block,
}

/// Learns the rhythm of arrivals and predicts the next one. Pure: all times come in as arguments.
#[derive(Clone, Debug)]
pub struct Predictor {
    /// Times are nanoseconds since this one, so that they can be averaged.
    origin: Instant,
    may_spin: bool,
    /// The latest arrivals, oldest first.
    history: Vec<i64>,
    rhythm: Option<Rhythm>,
}

/// A cycle length and where in it the frame comes, tracked by a second-order filter. All in nanoseconds.
#[derive(Clone, Copy, Debug)]
struct Rhythm {
    period: i64,
    expected: i64,
    /// Mean distance between expected and actual arrival.
    jitter: i64,
    strays: u32,
    announced: bool,
}

impl Predictor {
    /// A predictor that knows nothing yet. `may_spin` is false where looking would keep the frame from coming: on a single core.
    pub fn new(origin: Instant, may_spin: bool) -> Self {
        Predictor {
            origin,
            may_spin,
            history: Vec::with_capacity(HISTORY),
            rhythm: None,
        }
    }

    /// The cycle time of the arriving frames, if they have one.
    pub fn period(&self) -> Option<Duration> {
        self.rhythm.map(|rhythm| Duration::from_nanos(rhythm.period.unsigned_abs()))
    }

    /// A frame arrived.
    pub fn arrived(&mut self, now: Instant) {
        let now = self.nanoseconds(now);
        if self.history.len() == HISTORY {
            self.history.remove(0);
        }
        self.history.push(now);
        let history = &self.history;
        self.rhythm = self
            .rhythm
            .take()
            .and_then(|mut rhythm| (rhythm.arrived(now) && !rhythm.is_outdated(history)).then_some(rhythm));
        self.rhythm = self.rhythm.or_else(|| Rhythm::find(history));
    }

    /// What to do about the next frame.
    pub fn plan(&mut self, now: Instant) -> Plan {
        let origin = self.origin;
        let time = self.nanoseconds(now);
        let Some(rhythm) = &mut self.rhythm else { return Plan::Block };
        let instant = |nanoseconds: i64| origin + Duration::from_nanos(nanoseconds.unsigned_abs());
        let guard = rhythm.guard();
        let (begin, end) = (rhythm.expected - guard, rhythm.expected + 2 * guard);
        if time < begin {
            Plan::SleepUntil(instant(begin))
        } else if time >= end {
            Plan::Block
        } else if !rhythm.announced {
            rhythm.announced = true;
            Plan::Announce
        } else if self.may_spin && rhythm.jitter <= guard / 2 {
            Plan::SpinUntil(instant(end))
        } else {
            Plan::Block
        }
    }

    fn nanoseconds(&self, time: Instant) -> i64 {
        i64::try_from(time.saturating_duration_since(self.origin).as_nanos())
            .unwrap_or(i64::MAX / 4)
            .min(i64::MAX / 4)
    }
}

impl Rhythm {
    /// The rhythm in which every `n`th of these arrivals comes, for the smallest `n` that has one. None if that is too fast or too slow: its
    /// multiples are rhythms as well, but say nothing about the frames between.
    fn find(arrivals: &[i64]) -> Option<Self> {
        let (_, single) = cycles(1, arrivals)?;
        let rhythm = (1..=MOST_FRAMES_PER_CYCLE).find_map(|frames| {
            let (period, spread) = cycles(frames, arrivals)?;
            let steady = spread <= (2 * nanoseconds(GUARD)).min(period / 4);
            // Two unsteady cycles are no cycle with two frames: there, the times between frames differ a lot, and the cycles hardly.
            let distinct = frames == 1 || (single >= period / 4 && spread <= single / 4);
            let expected = arrivals[arrivals.len() - 1] + period;
            (steady && distinct).then_some(Rhythm {
                period,
                expected,
                jitter: spread / 2,
                strays: 0,
                announced: false,
            })
        });
        rhythm.filter(|rhythm| PERIODS.contains(&rhythm.period))
    }

    /// Whether the latest arrivals have a cycle of another length. Some of them may still come at expected times: every fourth of those every
    /// 1000 us fits into cycles of 1333 us. Faster ones than can be predicted are frames between the cyclic ones.
    fn is_outdated(&self, arrivals: &[i64]) -> bool {
        cycles(1, arrivals).is_some_and(|(period, spread)| {
            let steady = spread <= (2 * nanoseconds(GUARD)).min(period / 4);
            steady && PERIODS.contains(&period) && (period - self.period).abs() > self.period / 10
        })
    }

    /// At most a tenth of the cycle, so that spinning takes no more than that of a core.
    fn guard(&self) -> i64 {
        nanoseconds(GUARD).min(self.period / 10)
    }

    /// Takes an arrival in; false if the rhythm is over.
    fn arrived(&mut self, now: i64) -> bool {
        let tolerance = self.period / 4;
        let missed = (now - self.expected + tolerance).div_euclid(self.period).max(0);
        if missed > i64::from(MOST_STRAYS) {
            return false;
        }
        self.expected += missed * self.period;
        let error = now - self.expected;
        if error.abs() > tolerance || missed > 0 {
            self.strays += 1;
        } else {
            self.strays = 0;
        }
        if (-tolerance..=tolerance).contains(&error) {
            self.track(error);
        } else if error > 0 {
            self.next_cycle();
        }
        self.strays < MOST_STRAYS && PERIODS.contains(&self.period)
    }

    /// Follows the master's clock with gains that average over some ten cycles, so that one late frame does not move the next window.
    fn track(&mut self, error: i64) {
        self.expected += error / 4;
        self.period += error / 32;
        self.jitter += (error.abs() - self.jitter) / 8;
        self.next_cycle();
    }

    fn next_cycle(&mut self) {
        self.expected += self.period;
        self.announced = false;
    }
}

/// Mean length of the latest cycles, and by how much they differ, if there are this many frames in each.
fn cycles(frames: usize, arrivals: &[i64]) -> Option<(i64, i64)> {
    let first = arrivals.len().checked_sub(frames + CYCLES_TO_LOCK)?;
    let cycles = (first..first + CYCLES_TO_LOCK).map(|i| arrivals[i + frames] - arrivals[i]);
    let (shortest, longest) = cycles
        .clone()
        .fold((i64::MAX, 0), |(least, most), cycle| (least.min(cycle), most.max(cycle)));
    Some((cycles.sum::<i64>() / CYCLES_TO_LOCK as i64, longest - shortest))
}

fn nanoseconds(duration: Duration) -> i64 {
    i64::try_from(duration.as_nanos()).unwrap_or(i64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A predictor and the times it is told, in microseconds since the start.
    struct Bench {
        start: Instant,
        predictor: Predictor,
    }

    impl Bench {
        fn new() -> Self {
            let start = Instant::now();
            Bench {
                start,
                predictor: Predictor::new(start, true),
            }
        }

        fn at(&self, microseconds: u64) -> Instant {
            self.start + Duration::from_micros(microseconds)
        }

        fn arrive(&mut self, times: impl IntoIterator<Item = u64>) {
            for time in times {
                self.predictor.arrived(self.at(time));
            }
        }

        fn plan(&mut self, microseconds: u64) -> Plan {
            self.predictor.plan(self.at(microseconds))
        }

        fn cycle(&self) -> Option<u128> {
            self.predictor.period().map(|period| period.as_micros())
        }

        /// How long the wait from `from` on would look for a frame that never comes, in microseconds.
        fn spins(&mut self, from: u64, until: u64) -> u64 {
            (from..until).filter(|&time| matches!(self.plan(time), Plan::SpinUntil(_))).count() as u64
        }
    }

    fn every(period: u64, cycles: u64) -> impl Iterator<Item = u64> {
        (1..=cycles).map(move |cycle| cycle * period)
    }

    #[test]
    fn a_cyclic_frame_is_slept_for_announced_and_looked_for_until_300_us_have_passed() {
        let mut bench = Bench::new();
        bench.arrive(every(1000, 20));
        assert_eq!(bench.cycle(), Some(1000));
        assert_eq!(bench.plan(20_050), Plan::SleepUntil(bench.at(20_900)));
        assert_eq!(bench.plan(20_900), Plan::Announce);
        assert_eq!(bench.plan(20_901), Plan::SpinUntil(bench.at(21_200)));
        assert_eq!(bench.plan(21_200), Plan::Block);
    }

    #[test]
    fn nothing_is_looked_for_without_a_rhythm() {
        let mut bench = Bench::new();
        assert_eq!(bench.plan(0), Plan::Block);
        bench.arrive([100, 900, 5_000, 5_300, 9_000, 9_050, 20_000, 21_000, 40_000]);
        assert_eq!(bench.plan(41_000), Plan::Block);
    }

    #[test]
    fn a_master_that_fell_silent_is_looked_for_once() {
        let mut bench = Bench::new();
        bench.arrive(every(1000, 20));
        assert!(bench.spins(20_001, 1_000_000) <= 300);
    }

    #[test]
    fn flat_out_traffic_blocks() {
        let mut bench = Bench::new();
        bench.arrive(every(40, 1000));
        assert_eq!(bench.plan(40_001), Plan::Block);
    }

    #[test]
    fn cycles_below_400_us_block() {
        for period in [90, 150, 250, 399] {
            let mut bench = Bench::new();
            bench.arrive(every(period, 1000));
            assert_eq!(bench.plan(period * 1000 + 1), Plan::Block, "period {period}");
        }
    }

    #[test]
    fn an_unsteady_fast_cycle_is_not_taken_for_two_frames_of_a_slower_one() {
        let mut bench = Bench::new();
        let times: Vec<u64> = (1..500).map(|cycle| cycle * 250 + cycle * 7919 % 71).collect();
        for time in times {
            bench.arrive([time]);
            assert_eq!(bench.cycle(), None);
        }
    }

    #[test]
    fn looking_takes_at_most_a_tenth_of_the_cycle_when_frames_come_on_time() {
        for period in [400, 500, 1000, 4000, 100_000] {
            let mut bench = Bench::new();
            bench.arrive(every(period, 20));
            assert!(bench.spins(20 * period, 21 * period) > 0, "period {period}");
            let on_time = (20 * period..21 * period)
                .filter(|&time| matches!(bench.plan(time), Plan::SpinUntil(_)))
                .count() as u64;
            assert!(on_time <= period / 10, "period {period}: {on_time}");
        }
    }

    #[test]
    fn acyclic_frames_between_do_not_move_the_prediction() {
        let mut bench = Bench::new();
        bench.arrive(every(1000, 10));
        for cycle in 11..100 {
            bench.arrive([cycle * 1000, cycle * 1000 + 30, cycle * 1000 + 300 + cycle % 400]);
        }
        assert_eq!(bench.plan(99_899), Plan::SleepUntil(bench.at(99_900)));
    }

    #[test]
    fn several_frames_per_cycle_are_one_rhythm() {
        let mut bench = Bench::new();
        bench.arrive((1..20).flat_map(|cycle| [cycle * 1000, cycle * 1000 + 20, cycle * 1000 + 600]));
        assert_eq!(bench.cycle(), Some(1000));
    }

    #[test]
    fn a_new_cycle_time_is_learnt() {
        let mut bench = Bench::new();
        bench.arrive(every(1000, 50));
        bench.arrive((1..60).map(|cycle| 50_000 + cycle * 2000));
        assert_eq!(bench.cycle(), Some(2000));
    }

    #[test]
    fn a_new_cycle_time_is_learnt_though_some_frames_fit_the_old_one() {
        for old in (1010..3990).step_by(10) {
            let mut bench = Bench::new();
            bench.arrive(every(old, 50));
            bench.arrive((1..60).map(|cycle| 50 * old + cycle * 1000));
            let new = bench.cycle().unwrap();
            assert!((990..=1010).contains(&new), "{new} after {old}");
        }
    }

    #[test]
    fn a_single_lost_frame_does_not_end_the_rhythm() {
        let mut bench = Bench::new();
        bench.arrive(every(1000, 20));
        bench.arrive([22_000]);
        assert_eq!(bench.plan(22_001), Plan::SleepUntil(bench.at(22_900)));
    }

    #[test]
    fn a_jittery_master_is_announced_but_not_looked_for() {
        let mut bench = Bench::new();
        bench.arrive((1..100).map(|cycle| cycle * 1000 + if cycle < 12 { 0 } else { (cycle * 7919) % 400 }));
        assert_eq!(bench.cycle().map(|cycle| (900..1100).contains(&cycle)), Some(true));
        let plans: Vec<Plan> = (99_401..101_000).map(|time| bench.plan(time)).collect();
        assert!(plans.contains(&Plan::Announce));
        assert!(!plans.iter().any(|plan| matches!(plan, Plan::SpinUntil(_))));
    }

    #[test]
    fn a_single_core_never_spins() {
        let start = Instant::now();
        let mut predictor = Predictor::new(start, false);
        for time in every(1000, 20) {
            predictor.arrived(start + Duration::from_micros(time));
        }
        assert_eq!(predictor.plan(start + Duration::from_micros(20_950)), Plan::Announce);
        assert_eq!(predictor.plan(start + Duration::from_micros(20_951)), Plan::Block);
    }

    proptest! {
        #[test]
        fn small_jitter_keeps_the_frame_inside_of_the_window(
            period in 500_u64..10_000,
            jitter in proptest::collection::vec(0_u64..40, 100),
        ) {
            let mut bench = Bench::new();
            for (cycle, late) in jitter.iter().enumerate() {
                let due = (cycle as u64 + 1) * period + late;
                if cycle > 20 {
                    let plan = bench.plan(due);
                    let announced = plan == Plan::Announce;
                    prop_assert!(announced || matches!(plan, Plan::SpinUntil(_)), "cycle {cycle}: {plan:?}");
                }
                bench.arrive([due]);
            }
        }

        #[test]
        fn any_arrivals_are_survived_and_never_looked_for_longer_than_300_us(
            gaps in proptest::collection::vec(prop_oneof![0_u64..300, 900_u64..1100, 0_u64..10_000_000], 0..200),
        ) {
            let mut bench = Bench::new();
            let mut time = 0;
            for gap in gaps {
                time += gap;
                bench.arrive([time]);
                if let Plan::SpinUntil(end) = bench.plan(time + gap) {
                    prop_assert!(end <= bench.at(time + gap + 300));
                }
            }
        }
    }
}
