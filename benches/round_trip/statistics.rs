//! Median, percentile and ratios.

use std::fmt;
use std::time::Duration;

use crate::master::Times;
use crate::responder::Kind;

/// What one responder's turn came to.
#[derive(Clone, Copy, Debug, Default)]
pub struct Turn {
    /// Median round trip in us.
    pub median: f64,
    /// 99th percentile of the round trip in us.
    pub p99: f64,
    /// Part of a core that the responder took.
    pub cpu_share: f64,
    /// Frames that did not come back as they must.
    pub failed: usize,
}

impl Turn {
    /// From what the master measured.
    pub fn new(times: Times, cpu_share: f64) -> Self {
        let mut sorted = times.round_trips;
        sorted.sort_unstable();
        Self {
            median: percentile(&sorted, 50),
            p99: percentile(&sorted, 99),
            cpu_share,
            failed: times.failed,
        }
    }
}

fn percentile(sorted: &[Duration], percent: usize) -> f64 {
    let at = (sorted.len() * percent / 100).min(sorted.len().saturating_sub(1));
    sorted.get(at).map_or(f64::NAN, |time| time.as_secs_f64() * 1e6)
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}

/// One turn of each responder, right after each other.
#[derive(Clone, Copy, Debug, Default)]
pub struct Round([Turn; Kind::ALL.len()]);

impl Round {
    /// Keeps a turn.
    pub fn set(&mut self, kind: Kind, turn: Turn) {
        self.0[kind as usize] = turn;
    }

    fn of(&self, kind: Kind) -> &Turn {
        &self.0[kind as usize]
    }

    /// Median round trip of the drive by that of an echo.
    fn ratio(&self, echo: Kind) -> f64 {
        self.of(Kind::Drive).median / self.of(echo).median
    }
}

impl fmt::Display for Round {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for kind in Kind::ALL {
            let turn = self.of(kind);
            let share = 100.0 * turn.cpu_share;
            write!(f, "{}: {:6.1} p99 {:7.1} {share:4.1} %   ", kind.name(), turn.median, turn.p99)?;
            if turn.failed != 0 {
                write!(f, "({} FAILED)   ", turn.failed)?;
            }
        }
        write!(f, "drive/echo {:.2}", self.ratio(Kind::LinkEcho))
    }
}

/// Prints the rounds together: of each responder its quietest turn, and the ratio of each round's turns. Rounds in which frames failed, as when
/// the machine stood still for longer than the drive's watchdog allows, do not count.
pub fn summarize(name: &str, rounds: &[Round]) {
    let whole: Vec<&Round> = rounds.iter().filter(|round| round.0.iter().all(|turn| turn.failed == 0)).collect();
    println!("{name}, quietest turn of each in {} of {} rounds:", whole.len(), rounds.len());
    for kind in Kind::ALL {
        let turns = whole.iter().map(|round| round.of(kind));
        if let Some(turn) = turns.min_by(|a, b| a.median.total_cmp(&b.median)) {
            println!(
                "  {:16} median {:6.1} us, p99 {:7.1} us, {:4.1} % of a core",
                kind.name(),
                turn.median,
                turn.p99,
                100.0 * turn.cpu_share
            );
        }
    }
    for (echo, goal) in [(Kind::LinkEcho, ", goal at most 1.3"), (Kind::BlockingEcho, "")] {
        let quietest = |kind| whole.iter().map(|round| round.of(kind).median).fold(f64::INFINITY, f64::min);
        let of_quietest = quietest(Kind::Drive) / quietest(echo);
        let in_rounds = median(whole.iter().map(|round| round.ratio(echo)));
        println!(
            "  virtual drive / {}: {of_quietest:.2} of the quietest, {in_rounds:.2} median of the rounds{goal}",
            echo.name()
        );
    }
}
