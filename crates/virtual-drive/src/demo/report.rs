//! The figures of a demonstration.

use std::fmt;

use super::samples::{Phase, Sample, Samples};
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
    /// Largest lag of the shaft behind the field while it moved after homing, in electrical degrees: at 90 the motor gives all its torque.
    pub field_lag: f64,
    /// Smallest torque reserve while it moved after homing, from 0 to 1.
    pub torque_reserve: f64,
    /// Lowest and highest voltage at the power stage in V, and the greatest current out of the supply in A.
    pub bus: (f64, f64, f64),
    /// Greatest current of a winding in A.
    pub phase_current: f64,
    /// Electrical periods lost from the end of homing to the end.
    pub lost_periods: i64,
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
        let following = |sample: &Sample| sample.target.map_or(0, |target| (target - sample.commanded).abs());
        Self {
            home: (last(Phase::Homing).map_or(0, |sample| sample.commanded), samples.home),
            move_end: last(Phase::ProfilePosition).map_or(0, |sample| sample.commanded),
            shaft_lag: moving().map(|sample| lag(sample).abs()).fold(0.0, f64::max),
            field_lag: moving().map(|sample| sample.motor.lag.abs() * 360.0).fold(0.0, f64::max),
            torque_reserve: moving().filter_map(|sample| sample.motor.torque_reserve).fold(1.0, f64::min),
            bus: bus(samples),
            phase_current: samples
                .cycles
                .iter()
                .flat_map(|sample| sample.motor.currents)
                .fold(0.0, |most, current| f64::max(most, current.abs())),
            lost_periods: lost(samples.cycles.last()) - lost(samples.of(Phase::Homing).last()),
            shaft_error: last(Phase::Disabling).as_ref().map_or(0.0, lag),
            following_error: samples.of(Phase::CyclicPosition).map(following).max().unwrap_or(0),
            cycles: samples.cycles.len(),
            lateness: lateness(samples),
        }
    }
}

impl Report {
    /// What the shaft's place at the end says: a stepper loses whole electrical periods.
    fn lost_steps(&self) -> String {
        match self.lost_periods {
            0 => format!("no step lost ({:.2} pulses off at the end)", self.shaft_error.abs()),
            lost => format!(
                "{} electrical periods lost after homing ({:.1} pulses off at the end)",
                lost.abs(),
                self.shaft_error
            ),
        }
    }
}

/// Electrical periods lost from power-on to a sample.
fn lost(sample: Option<&Sample>) -> i64 {
    sample.map_or(0, |sample| sample.motor.lost_periods)
}

/// Lowest and highest voltage at the power stage, and the greatest current out of the supply.
fn bus(samples: &Samples) -> (f64, f64, f64) {
    samples.cycles.iter().fold((f64::MAX, 0.0, 0.0), |(low, high, current), sample| {
        let motor = &sample.motor;
        (
            low.min(motor.bus_voltage),
            high.max(motor.bus_voltage),
            current.max(motor.supply_current),
        )
    })
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
            "  motor shaft       at most {:.1} pulses behind the drive's command; {}",
            self.shaft_lag,
            self.lost_steps()
        )?;
        writeln!(
            f,
            "  torque            at least {:.0} % of the pull-out torque in reserve; at most {:.0} electrical degrees behind the field",
            self.torque_reserve * 100.0,
            self.field_lag
        )?;
        let (low, high, current) = self.bus;
        writeln!(
            f,
            "  power stage       {low:.1} to {high:.1} V, at most {current:.2} A out of the supply and {:.2} A in a winding",
            self.phase_current
        )?;
        write!(
            f,
            "  cycle time        {CYCLE:?}, {} cycles, begun late by {median:.0} us (median), {p99:.0} us (99 %), {largest:.0} us (largest)",
            self.cycles
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::demo::session::PULSES_PER_TURN;
    use crate::motor_view::MotorView;
    use plant::Turns;
    use wire::Nanos;

    /// A motor whose shaft is at a place in pulses, a tenth of an electrical period behind.
    fn motor(shaft: f64, lost_periods: i64, torque_reserve: f64) -> MotorView {
        MotorView {
            shaft: Turns(shaft / PULSES_PER_TURN),
            lag: -0.1,
            lost_periods,
            torque: 0.5,
            torque_reserve: Some(torque_reserve),
            currents: [1.0, 2.0],
            bus_voltage: 36.0,
            supply_current: 0.5,
        }
    }

    /// A demonstration of a few cycles at whose end the shaft is `lost` pulses away from where the drive believes it to be.
    fn report(lost: f64) -> Report {
        let lost_periods = (lost / 200.0) as i64;
        let sample = |phase, commanded, shaft| Sample {
            time: Nanos(1000),
            due: Nanos(0),
            phase,
            target: Some(commanded + 7),
            commanded,
            motor: motor(
                shaft,
                // Three periods were lost before homing.
                3 + if phase == Phase::Homing { 0 } else { lost_periods },
                if phase == Phase::CyclicPosition { 0.4 } else { 0.6 },
            ),
        };
        let cycles = vec![
            sample(Phase::Homing, -29, 9_971.0),
            sample(Phase::ProfilePosition, 30_000, 39_995.5),
            sample(Phase::CyclicPosition, 29_000, 39_000.0),
            sample(Phase::Disabling, 30_000, 40_000.0 + lost),
        ];
        Report::of(&Samples { cycles, home: 10_000.0 })
    }

    #[test]
    fn figures_are_those_of_the_samples() {
        let report = report(0.0);
        assert_eq!((report.home, report.move_end, report.following_error), ((-29, 10_000.0), 30_000, 7));
        assert!((report.shaft_lag - 4.5).abs() < 1e-6 && report.shaft_error.abs() < 1e-6);
        assert!((report.field_lag - 36.0).abs() < 1e-9);
        assert_eq!((report.bus, report.phase_current), ((36.0, 36.0, 0.5), 2.0));
        assert_eq!((report.torque_reserve, report.lost_periods, report.cycles), (0.4, 0, 4));
        assert_eq!(report.lateness, (1.0, 1.0, 1.0));
    }

    #[test]
    fn lost_steps_are_told() {
        assert!(report(0.4).to_string().contains("no step lost (0.40 pulses off at the end)"));
        assert!(
            report(-400.0)
                .to_string()
                .contains("2 electrical periods lost after homing (-400.0 pulses off at the end)")
        );
    }
}
