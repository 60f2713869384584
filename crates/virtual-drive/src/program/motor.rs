//! `motor`: motors and their torque.

use std::fs;
use std::io::{self, Write};

use anyhow::Context;
use drive::DriveObjects;
use indicatif::{ProgressBar, ProgressStyle};
use plant::motors::ALL;
use plant::{Envelope, MotorParameters, Phases};

use super::arguments::motor::{BenchOptions, MotorAction, MotorOptions, MotorPullOut, MotorShow};
use crate::motor::pull_out::{self, Point};
use crate::motor::{Motor, figures, number, picture, text};
use crate::test_bench::Setup;

/// Supplies for which derived values are shown, in V.
const SUPPLIES: [f64; 3] = [24.0, 36.0, 48.0];
/// Speeds at which the torque is shown, in turns a second.
const SPEEDS: [f64; 6] = [1.0, 2.0, 5.0, 10.0, 20.0, 40.0];

pub(super) fn motor(options: &MotorOptions) -> anyhow::Result<()> {
    match &options.action {
        MotorAction::List => list(),
        MotorAction::Show(options) => show(options),
        MotorAction::PullOut(options) => pull_out(options),
    }
}

fn list() -> anyhow::Result<()> {
    let mut out = io::stdout().lock();
    writeln!(
        out,
        "name            phases   torque  current       R       L  inertia  description"
    )?;
    for named in &ALL {
        let motor = &named.parameters;
        writeln!(
            out,
            "{:14} {:>7} {:>5.2} Nm {:>6.2} A {:>4.2} ohm {:>4.2} mH {:>4.0} gcm2  {}",
            named.name,
            phases(motor),
            motor.holding_torque(motor.rated_current),
            motor.rated_current,
            motor.resistance,
            motor.inductance * 1e3,
            motor.inertia * 1e7,
            named.description
        )?;
    }
    writeln!(
        out,
        "\nCurrents are peaks of the sinusoidal phase current, as object 0x2000 has them."
    )?;
    Ok(())
}

fn phases(motor: &MotorParameters) -> u8 {
    match motor.phases {
        Phases::Two => 2,
        Phases::Three => 3,
    }
}

fn show(options: &MotorShow) -> anyhow::Result<()> {
    let mut out = io::stdout().lock();
    if options.toml {
        write!(out, "{}", text::of(&options.motor))?;
        return Ok(());
    }
    values(&mut out, &options.motor)?;
    derived(&mut out, &options.motor)?;
    Ok(())
}

fn values(out: &mut impl Write, motor: &Motor) -> io::Result<()> {
    let values = &motor.parameters;
    writeln!(out, "{}", motor.name)?;
    if !motor.description.is_empty() {
        writeln!(out, "{}", motor.description)?;
    }
    writeln!(out, "\nValues")?;
    writeln!(out, "  {:26} {:>9}", "phases", phases(values))?;
    let rows = [
        ("resistance", values.resistance, "ohm"),
        ("inductance", values.inductance * 1e3, "mH"),
        ("rated current, peak", values.rated_current, "A"),
        ("back-EMF", values.back_emf, "V s/rad"),
        ("holding torque", values.holding_torque(values.rated_current), "Nm"),
        ("detent torque", values.detent_torque * 1e3, "mNm"),
        ("rotor inertia", values.inertia * 1e7, "g cm^2"),
        ("friction", values.friction * 1e3, "mNm"),
        ("drag", values.drag * 1e3, "mNm s/rad"),
    ];
    for (name, value, unit) in rows {
        let estimated = if motor.estimates.contains(&name) {
            "  (an estimate: not in the file)"
        } else {
            ""
        };
        writeln!(out, "  {name:26} {:>9} {unit}{estimated}", number(value))?;
    }
    if let Some(inertia) = motor.load_inertia {
        writeln!(out, "  {:26} {:>9} g cm^2", "load inertia", number(inertia * 1e7))?;
    }
    if let Some(volts) = motor.supply {
        writeln!(out, "  {:26} {:>9} V", "supply", number(volts))?;
    }
    Ok(())
}

fn derived(out: &mut impl Write, motor: &Motor) -> io::Result<()> {
    let values = &motor.parameters;
    let at_delivery = f64::from(DriveObjects::new().peak_current) / 1e3;
    writeln!(out, "\nWhat follows")?;
    writeln!(
        out,
        "  {:26} {:>9.4} ms",
        "electrical time constant",
        figures::electrical_time_constant(values) * 1e3
    )?;
    for current in [values.rated_current, at_delivery] {
        let frequency = figures::natural_frequency(values, current, motor.load_inertia.unwrap_or(0.0));
        writeln!(
            out,
            "  {:26} {frequency:>9.1} Hz; first resonance at {:.3} turns/s",
            format!("natural frequency, {current:.2} A"),
            figures::resonant_speed(frequency)
        )?;
    }
    for current in [values.rated_current, at_delivery] {
        torques(out, values, current)?;
    }
    Ok(())
}

/// Torque by supply and speed.
fn torques(out: &mut impl Write, motor: &MotorParameters, current: f64) -> io::Result<()> {
    writeln!(out, "\nPull-out torque at {current:.2} A peak (closed form), in Nm")?;
    write!(out, "  supply  corner  no load")?;
    for speed in SPEEDS {
        write!(out, "  {speed:>2.0} turns/s")?;
    }
    writeln!(out)?;
    for supply in SUPPLIES {
        let envelope = Envelope::new(motor, supply, current);
        write!(
            out,
            "  {supply:>4.0} V {:>7.1} {:>8.1}",
            envelope.corner_speed(),
            envelope.no_load_speed()
        )?;
        for speed in SPEEDS {
            match envelope.torque_at(speed) {
                torque if torque > 0.0 => write!(out, "  {torque:>10.3}")?,
                _ => write!(out, "  {:>10}", "-")?,
            }
        }
        writeln!(out)?;
    }
    Ok(())
}

/// Supply in V where neither the command line nor the motor's file tells one.
const USUAL_SUPPLY: f64 = 36.0;
/// The largest peak of the phase current that the drive can be set to, in A (0x2000).
const MOST_CURRENT: f64 = 6.0;

/// What is on a test bench.
pub(super) struct Bench {
    pub setup: Setup,
    /// Peak of the phase current in A.
    pub current: f64,
    /// All of it in words.
    pub title: String,
}

impl Bench {
    /// What is not given is what the motor's file tells, or what is usual.
    pub(super) fn of(motor: &Motor, options: &BenchOptions) -> Self {
        let supply = options.supply.or(motor.supply).unwrap_or(USUAL_SUPPLY);
        let current = options.current.unwrap_or(motor.parameters.rated_current.min(MOST_CURRENT));
        let load_inertia = options.load_inertia.or(motor.load_inertia).unwrap_or(0.0);
        Self {
            setup: Setup::of(&motor.parameters, supply, current).with_load_inertia(load_inertia),
            current,
            title: format!(
                "{}: {supply} V, {current:.2} A peak, load {} g cm^2",
                motor.name,
                number(load_inertia * 1e7)
            ),
        }
    }
}

fn pull_out(options: &MotorPullOut) -> anyhow::Result<()> {
    let Bench { setup, title, .. } = Bench::of(&options.motor, &options.bench);
    let unwritable = || {
        format!(
            "cannot write {}; choose another file with --output FILE.svg",
            options.output.display()
        )
    };
    // Before the work, not after it.
    fs::write(&options.output, "").with_context(unwritable)?;

    writeln!(io::stdout(), "{title}")?;
    let speeds = pull_out::speeds(&setup, options.points.into());
    let bar = ProgressBar::new(speeds.len() as u64);
    let style = ProgressStyle::with_template("  loading the motor at {len} speeds [{bar:30}] {pos} {elapsed}");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
    let points = pull_out::measure(&setup, &speeds, &|| bar.inc(1));
    bar.finish_and_clear();
    let points = points?;
    table(&mut io::stdout().lock(), &points)?;
    fs::write(&options.output, picture::draw(&title, &setup, &points)?).with_context(unwritable)?;
    writeln!(io::stdout(), "\nPicture: {}", options.output.display())?;
    Ok(())
}

fn table(out: &mut impl Write, points: &[Point]) -> io::Result<()> {
    writeln!(out, "\n  turns/s    rpm  closed form  simulated")?;
    for point in points {
        let rpm = point.speed * 60.0;
        write!(out, "  {:>7.2} {rpm:>6.0}", point.speed)?;
        match point.envelope {
            torque if torque > 0.0 => write!(out, "  {torque:>8.3} Nm")?,
            _ => write!(out, "  {:>11}", "-")?,
        }
        match point.simulated {
            Some(torque) => writeln!(out, "  {torque:>6.3} Nm")?,
            None => writeln!(out, "  not reached")?,
        }
    }
    Ok(())
}
