//! `run` and `exec`.

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use anyhow::Context;

use super::arguments::{Exec, Run, Served};
use crate::drive::DriveConfig;
use crate::eeprom_folder::EepromFolder;
use crate::link::pcap::{Recorder, Recording};
use crate::link::raw::{RawLink, Role};
use crate::link::{Link, LinkError};
use crate::namespace;
use crate::segment::VirtualSegment;
use crate::server::{self, Traffic};
use crate::status::StatusLines;

pub(super) fn run(options: &Run) -> anyhow::Result<()> {
    let stop = super::on_signal()?;
    let service = Service::prepare(&options.served, &options.interface)?;
    println!("Serving {} on {}; Ctrl-C ends.", plural(options.served.drives), options.interface);
    let mut lines = StatusLines::new(options.served.drives.into());
    service.serve(&stop, |segment, traffic| lines.show(segment, traffic))?;
    Ok(())
}

pub(super) fn exec(options: &Exec) -> anyhow::Result<ExitCode> {
    // First of all: only a process of one thread can move into a network of its own.
    namespace::enter()?;
    let service = Service::prepare(&options.served, namespace::DRIVE_INTERFACE)?;
    let stop = Arc::new(AtomicBool::new(false));
    let serving = thread::spawn({
        let stop = Arc::clone(&stop);
        move || service.serve(&stop, |_, _| ())
    });
    let ended = namespace::command::run(
        &options.command,
        &[(namespace::INTERFACE_VARIABLE, namespace::MASTER_INTERFACE.as_ref())],
    );
    stop.store(true, Ordering::Relaxed);
    serving.join().map_err(|_| anyhow::anyhow!("the drives' thread has panicked"))??;
    Ok(ExitCode::from(ended.unwrap_or_else(|error| {
        eprintln!("usr2556e: {error}");
        error.exit_code()
    })))
}

fn plural(drives: u16) -> String {
    if drives == 1 {
        "1 drive".into()
    } else {
        format!("{drives} drives")
    }
}

/// Drives, the link to their master, and where their EEPROMs are kept.
struct Service {
    wire: Wire,
    segment: VirtualSegment,
    eeproms: Option<EepromFolder>,
}

/// The link, recorded or not.
enum Wire {
    Bare(RawLink),
    Recorded(Recording<RawLink>),
}

impl Wire {
    fn link(&mut self) -> &mut dyn Link {
        match self {
            Self::Bare(link) => link,
            Self::Recorded(link) => link,
        }
    }

    /// Completes the capture; tells if frames of it could not be written.
    fn finish(self) -> anyhow::Result<()> {
        match self {
            Self::Bare(_) => Ok(()),
            Self::Recorded(link) => link.finish().1.context("the capture is not complete"),
        }
    }
}

impl Service {
    /// Everything that can be wrong with what was typed comes out here, before the first frame.
    fn prepare(served: &Served, interface: &str) -> anyhow::Result<Self> {
        let count = usize::from(served.drives);
        let eeproms = served
            .eeprom
            .as_deref()
            .map(|folder| EepromFolder::open(folder, count))
            .transpose()?;
        let configs = (0..count).map(|position| {
            let eeprom = eeproms.as_ref().map_or(Ok(None), |folder| folder.load(position))?;
            Ok(DriveConfig {
                eeprom,
                ..DriveConfig::numbered(position)
            })
        });
        let segment = VirtualSegment::new(configs.collect::<anyhow::Result<Vec<_>>>()?);
        let link = RawLink::open(interface, Role::DriveServer)?;
        let wire = match &served.record {
            None => Wire::Bare(link),
            Some(file) => {
                let recorder = Recorder::create(file, interface).with_context(|| format!("cannot write the capture {}", file.display()))?;
                Wire::Recorded(Recording::new(link, recorder))
            }
        };
        Ok(Self { wire, segment, eeproms })
    }

    fn serve(mut self, stop: &AtomicBool, mut show: impl FnMut(&VirtualSegment, Traffic)) -> anyhow::Result<()> {
        let eeproms = &mut self.eeproms;
        let mut failure = None;
        let ended: Result<(), LinkError> = server::serve(self.wire.link(), &mut self.segment, stop, |segment, traffic| {
            if let Some(folder) = eeproms
                && let Err(error) = folder.save_rested(segment)
                && failure.is_none()
            {
                eprintln!("usr2556e: {error:#}; the drives go on, and their EEPROMs are saved again at the end");
                failure = Some(());
            }
            show(segment, traffic);
        });
        if let Some(folder) = &mut self.eeproms {
            folder.save_all(&self.segment)?;
        }
        self.wire.finish()?;
        Ok(ended?)
    }
}
