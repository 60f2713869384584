//! `tune`: values found by experiment on a virtual drive.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use anyhow::{Context, ensure};
use device::identity;
use ethercrab::SubDeviceRef;
use indicatif::{ProgressBar, ProgressStyle};
use plant::Phases;

use super::arguments::Bus;
use super::arguments::tune::{TuneAction, TuneOptions, TuneVibration};
use super::lead::{found, name, on_bus, position, refused, value_bytes};
use super::motor::Bench;
use crate::master::describe;
use crate::master::sdo::{self, Address};
use crate::motor::number;
use crate::tuning::vibration::{self, Comparison, MOST_EXPERIMENTS, NotTuned, Progress, Tuning, Values, parameters, picture};

/// Names of the files in the output folder.
const PICTURE_NAME: &str = "usr2556e-vibration.svg";
const PARAMETERS_NAME: &str = "usr2556e-vibration.txt";

/// Part of the holding torque that loads the motor if nothing else is said.
const USUAL_LOAD: f64 = 0.1;
/// Every how manieth speed of the comparison the table shows.
const SHOWN: usize = 2;

pub(super) fn tune(options: &TuneOptions) -> anyhow::Result<()> {
    match &options.action {
        TuneAction::Vibration(options) => vibration(options),
    }
}

fn vibration(options: &TuneVibration) -> anyhow::Result<()> {
    let bench = Bench::of(&options.motor, &options.bench);
    let holding_torque = options.motor.parameters.holding_torque(bench.current);
    let load_torque = options.load_torque.unwrap_or(USUAL_LOAD * holding_torque);
    // Everything that can fail does so before the long work.
    ensure!(options.motor.parameters.phases == Phases::Two, NotTuned::ThreePhases);
    ensure!(
        load_torque < holding_torque,
        "the motor holds {holding_torque:.3} Nm at {:.2} A, so that it cannot turn a load of {load_torque} Nm; lessen --load-torque",
        bench.current
    );
    let target = options.bus().map(|bus| Drive {
        bus,
        position: options.drive.unwrap_or(1),
    });
    writable(&options.output)?;
    if let Some(drive) = &target {
        drive.check(bench.setup.objects.peak_current)?;
    }

    let title = format!("{} and {} Nm", bench.title, number(load_torque));
    writeln!(io::stdout(), "{title}")?;
    let bar = Bar::new();
    let tuning = vibration::tune(&bench.setup, load_torque, &|progress| bar.show(progress));
    bar.0.finish_and_clear();
    let tuning = tuning?;

    report(&mut io::stdout().lock(), &tuning)?;
    leave(&options.output, &title, &tuning)?;
    if let Some(drive) = &target {
        drive.write(&tuning.values, options.save)?;
    }
    Ok(())
}

/// Makes sure that the files can be written, and leaves nothing behind.
fn writable(folder: &Path) -> anyhow::Result<()> {
    fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder {}; choose another one with --output DIR", folder.display()))?;
    tempfile::tempfile_in(folder).with_context(|| {
        format!(
            "cannot write into the folder {}; choose another one with --output DIR",
            folder.display()
        )
    })?;
    for file in [PICTURE_NAME, PARAMETERS_NAME].map(|name| folder.join(name)) {
        ensure!(
            !file.is_dir(),
            "{} is a folder; choose another place with --output DIR",
            file.display()
        );
    }
    Ok(())
}

/// Writes picture and parameter file.
fn leave(folder: &Path, title: &str, tuning: &Tuning) -> anyhow::Result<()> {
    let Tuning {
        resonance,
        experiments,
        values,
        ..
    } = tuning;
    let heading = format!(
        "{title}\nripple at the first resonance, {:.3} turns/s: {} before, {} after; {experiments} experiments on a virtual drive",
        resonance.conditions.speed, resonance.before, resonance.after
    );
    let files = [
        ("Picture", PICTURE_NAME, picture::draw(title, tuning)?),
        ("Values", PARAMETERS_NAME, parameters::file(&heading, values)),
    ];
    let mut out = io::stdout().lock();
    writeln!(out)?;
    for (what, name, contents) in files {
        let path = folder.join(name);
        fs::write(&path, contents).with_context(|| format!("cannot write {}", path.display()))?;
        writeln!(out, "{what}: {}", path.display())?;
    }
    Ok(())
}

fn report(out: &mut impl Write, tuning: &Tuning) -> io::Result<()> {
    let Tuning {
        resonance, expected_speed, ..
    } = tuning;
    let speed = resonance.conditions.speed;
    writeln!(
        out,
        "\nFirst resonance at {speed:.3} turns/s, {:.1} rpm (expected at {expected_speed:.3})",
        speed * 60.0
    )?;
    writeln!(
        out,
        "Ripple of the speed there {} before, {} after: {:.1} times less, in {} experiments\n",
        resonance.before,
        resonance.after,
        resonance.factor(),
        tuning.experiments
    )?;
    for (index, value) in tuning.values.objects() {
        let object = Address { index, sub: 0 };
        writeln!(out, "  {object} = {value:<5} {}", object.entry().map_or("", |entry| entry.name))?;
    }
    writeln!(out, "\nThe same values with other loads, at {speed:.3} turns/s")?;
    for row in &tuning.loads {
        compared(out, &format!("{:.3} Nm", row.conditions.load_torque), row)?;
    }
    writeln!(
        out,
        "The same values at other speeds, with {:.3} Nm",
        resonance.conditions.load_torque
    )?;
    for row in tuning.speeds.iter().step_by(SHOWN) {
        compared(out, &format!("{:.3} turns/s", row.conditions.speed), row)?;
    }
    Ok(())
}

fn compared(out: &mut impl Write, what: &str, row: &Comparison) -> io::Result<()> {
    write!(out, "  {what:>14}  {:>11} before  {:>11} after", row.before, row.after)?;
    match row.factor() {
        factor if factor.is_finite() && factor > 0.0 => writeln!(out, "  {factor:>6.1} times less"),
        _ => writeln!(out),
    }
}

/// The progress of the experiments.
struct Bar(ProgressBar);

impl Bar {
    fn new() -> Self {
        let bar = ProgressBar::new((MOST_EXPERIMENTS + vibration::COMPARED) as u64);
        let style = ProgressStyle::with_template("  {msg:48} [{bar:30}] {elapsed}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
        Self(bar)
    }

    fn show(&self, progress: Progress) {
        match progress {
            Progress::Resonance => self.0.set_message("looking for the resonance"),
            Progress::Values => {}
            Progress::Best(ripple) => return self.0.set_message(format!("trying values: ripple {ripple} so far")),
            Progress::Comparison => {
                self.0.set_message("comparing before and after");
                let done = self.0.position().max(MOST_EXPERIMENTS as u64);
                self.0.set_position(done);
            }
        }
        self.0.inc(1);
    }
}

/// A drive to write the values to.
struct Drive {
    bus: Bus,
    position: u16,
}

impl Drive {
    /// Makes sure that the drive is there and can take the values; tells where it differs from what is simulated.
    fn check(&self, peak_current: u16) -> anyhow::Result<()> {
        on_bus(&self.bus, async |main, pace| {
            let group = found(main, pace, &name(&self.bus)).await?;
            let drive = group.subdevice(main, position(&group, self.position)?)?;
            let identity = drive.identity();
            ensure!(
                (identity.vendor_id, identity.product_id) == (identity::VENDOR, identity::PRODUCT),
                "drive {} is none of this kind, and its objects 0x2060 to 0x2062 may be anything: {}",
                self.position,
                describe::identity(&drive)
            );
            let phases = read(&drive, Address { index: 0x200C, sub: 1 }).await?;
            ensure!(
                phases == 0,
                "drive {} is set to a motor of three phases (0x200C:01), for which the harmonic has no effect",
                self.position
            );
            let current = read(&drive, Address { index: 0x2000, sub: 0 }).await?;
            if current != peak_current {
                writeln!(
                    io::stdout(),
                    "Drive {} has a current of {current} mA (0x2000); the values are going to be for {peak_current} mA.",
                    self.position
                )?;
            }
            Ok(())
        })
    }

    /// Writes the values, and lets the drive save its parameters if wanted.
    fn write(&self, values: &Values, save: bool) -> anyhow::Result<()> {
        on_bus(&self.bus, async |main, pace| {
            let group = found(main, pace, &name(&self.bus)).await?;
            let drive = group.subdevice(main, position(&group, self.position)?)?;
            for (index, value) in values.objects() {
                let address = Address { index, sub: 0 };
                let written = sdo::write(&drive, address, &value.to_le_bytes()).await;
                written.map_err(|error| refused("writing", address, error))?;
            }
            if save {
                let address = Address { index: 0x1010, sub: 1 };
                let written = sdo::write(&drive, address, &value_bytes(address, "1")?).await;
                written.map_err(|error| refused("saving the parameters with", address, error))?;
            }
            let kept = match save {
                true => "and saved with its other parameters",
                false => "until its power-off (--save, or 1 to 0x1010:01, keeps them)",
            };
            writeln!(io::stdout(), "Written to drive {} on {}, {kept}", self.position, name(&self.bus))?;
            Ok(())
        })
    }
}

/// Reads an object of two bytes.
async fn read<S: std::ops::Deref<Target = ethercrab::SubDevice>>(drive: &SubDeviceRef<'_, S>, address: Address) -> anyhow::Result<u16> {
    let value = drive.sdo_read(address.index, address.sub).await;
    value.map_err(|error| refused("reading", address, error))
}
