//! The figures of a demonstration.

use std::fmt;

use super::samples::{Phase, Samples};
use super::session::{CYCLE, MOVE_TARGET};

/// The figures of a demonstration, positions in pulses, times in microseconds.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// 0x6064 at the end of homing, and where the shaft was from power-on.
    pub home: (i32, f64),
    /// 0x6064 at the end of the profile position move.
    pub move_end: i32,
    /// Largest distance of the shaft from the drive's commanded position while it moved after homing.
    pub shaft_lag: f64,
    /// The same at the end, at rest.
    pub shaft_error: f64,
    /// Largest difference of 0x607A and 0x6064 on the sine.
    pub following_error: i32,
    /// Number of cycles.
    pub cycles: usize,
    /// How late cycles began: median, 99th percentile, largest.
    pub lateness: (f64, f64, f64),
}

impl Report {
    /// The figures of these samples.
    pub fn of(samples: &Samples) -> Self {
        let last = |phase| samples.of(phase).last().copied();
        let moving = || samples.of(Phase::ProfilePosition).chain(samples.of(Phase::CyclicPosition));
        let lag = |sample| samples.shaft_from_home(sample) - f64::from(sample.commanded);
        let following = |sample: &super::samples::Sample| sample.target.map_or(0, |target| (target - sample.commanded).abs());
        Self {
            home: (last(Phase::Homing).map_or(0, |sample| sample.commanded), samples.home),
            move_end: last(Phase::ProfilePosition).map_or(0, |sample| sample.commanded),
            shaft_lag: moving().map(|sample| lag(sample).abs()).fold(0.0, f64::max),
            shaft_error: last(Phase::Disabling).as_ref().map_or(0.0, lag),
            following_error: samples.of(Phase::CyclicPosition).map(following).max().unwrap_or(0),
            cycles: samples.cycles.len(),
            lateness: lateness(samples),
        }
    }
}

/// How late cycles began, in microseconds: median, 99th percentile, largest.
fn lateness(samples: &Samples) -> (f64, f64, f64) {
    let mut late: Vec<u64> = samples.cycles.iter().map(|sample| sample.time.since(sample.due)).collect();
    late.sort_unstable();
    let at = |part: f64| {
        late.get(((late.len().saturating_sub(1)) as f64 * part) as usize)
            .map_or(0.0, |ns| *ns as f64 / 1000.0)
    };
    (at(0.5), at(0.99), at(1.0))
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (median, p99, largest) = self.lateness;
        writeln!(
            f,
            "  homing            ended at {} pulses; home is {:.0} pulses from where the axis stood at power-on",
            self.home.0, self.home.1
        )?;
        writeln!(f, "  profile position  ended at {} pulses (target {MOVE_TARGET})", self.move_end)?;
        writeln!(
            f,
            "  cyclic position   following error at most {} pulses (0x607A - 0x6064, motion filter and interpolation)",
            self.following_error
        )?;
        writeln!(
            f,
            "  motor shaft       at most {:.1} pulses behind the drive's command, {:.2} pulses at the end: no step lost",
            self.shaft_lag, self.shaft_error
        )?;
        write!(
            f,
            "  cycle time        {CYCLE:?}, {} cycles, begun late by {median:.0} us (median), {p99:.0} us (99 %), {largest:.0} us (largest)",
            self.cycles
        )
    }
}
