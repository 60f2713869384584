//! The demonstration: one virtual drive and the built-in master in one process, from power-on to a report.
//!
//! | module | holds |
//! |---|---|
//! | [`session`] | what the master does: scan, OP with clocks, homing, a move, a sine |
//! | [`samples`] | what was seen in each cycle |
//! | [`report`] | the figures drawn from it |
//! | [`picture`] | the picture drawn from it |

pub mod picture;
pub mod report;
pub mod samples;
pub mod session;

use std::cell::RefCell;
use std::fs;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use anyhow::Context;
use plant::PlantConfig;

use crate::clock::Clock;
use crate::drive::DriveConfig;
use crate::link::pcap::Recorder;
use crate::master;
use crate::motor::commissioning::Commissioning;
use crate::segment::{InMemory, VirtualSegment};
use report::Report;

/// Name of the capture in the output folder.
pub const CAPTURE_NAME: &str = "usr2556e-demo.pcapng";
/// Name of the picture in the output folder.
pub const PICTURE_NAME: &str = "usr2556e-demo.svg";

/// What a demonstration has left behind.
pub struct Outcome {
    /// The figures.
    pub report: Report,
    /// The capture of everything on the wire.
    pub capture: PathBuf,
    /// The picture of positions, velocities, lag, torque in reserve, currents and bus.
    pub picture: PathBuf,
}

/// What hangs on the drive.
#[derive(Clone, Copy, Debug, Default)]
pub struct Machine {
    /// Motor, axis, load and supply.
    pub plant: PlantConfig,
    /// What the master tells the drive about its motor; `None` for the values at delivery.
    pub commissioning: Option<Commissioning>,
}

/// Shows a drive at work and leaves capture and picture in `output`, in place of those of an earlier run.
///
/// # Errors
/// A file cannot be written, or the drive does not do what it should.
pub fn run(output: &Path, clock: Clock, machine: &Machine, progress: &mut dyn session::Progress) -> anyhow::Result<Outcome> {
    fs::create_dir_all(output)
        .with_context(|| format!("cannot make the folder {}; choose another one with --output DIR", output.display()))?;
    let capture = output.join(CAPTURE_NAME);
    let picture = output.join(PICTURE_NAME);
    let unwritable = |path: &Path| format!("cannot write {}; choose another folder with --output DIR", path.display());
    // Both files are opened before the drive moves: a minute's work is not lost to a folder that cannot be written.
    let recorder = Recorder::create(&capture, "usr2556e").with_context(|| unwritable(&capture))?;
    fs::write(&picture, "").with_context(|| unwritable(&picture))?;

    let drive = DriveConfig {
        plant: machine.plant,
        ..DriveConfig::numbered(0)
    };
    let link = Rc::new(RefCell::new(
        InMemory::new(VirtualSegment::new([drive]), clock).with_recorder(recorder),
    ));
    let motor = || link.borrow().segment().drives()[0].motor();
    let samples = master::run(&mut link.clone(), async |main, pace| {
        session::hold(main, pace, &motor, machine.commissioning, progress).await
    })??;

    let recorder = link.borrow_mut().take_recorder();
    recorder.map_or(Ok(()), Recorder::finish).with_context(|| unwritable(&capture))?;
    fs::write(&picture, picture::draw(&samples)?).with_context(|| unwritable(&picture))?;
    Ok(Outcome {
        report: Report::of(&samples),
        capture,
        picture,
    })
}
