//! `run` and `exec`.

use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use anyhow::Context;

use super::arguments::{Exec, Run, Served};
use crate::drive::DriveConfig;
use crate::eeprom_folder::EepromFolder;
use crate::link::LinkError;
use crate::link::pcap::Recorder;
use crate::link::raw::{RawLink, Role};
use crate::namespace;
use crate::segment::VirtualSegment;
use crate::server::{self, Traffic};
use crate::status::StatusLines;

pub(super) fn run(options: &Run) -> anyhow::Result<()> {
    let stop = super::on_signal()?;
    let service = Service::prepare(&options.served, &options.interface)?;
    writeln!(
        io::stdout(),
        "Serving {} on {}; Ctrl-C ends.",
        plural(options.served.drives),
        options.interface
    )?;
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

/// Drives, the link to their master, its capture, and where the drives' EEPROMs are kept.
struct Service {
    link: RawLink,
    recorder: Option<Recorder>,
    segment: VirtualSegment,
    eeproms: Option<EepromFolder>,
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
        let create = |file: &PathBuf| {
            Recorder::create(file, interface).with_context(|| {
                format!(
                    "cannot write the capture {}; choose another file with --record FILE",
                    file.display()
                )
            })
        };
        let recorder = served.record.as_ref().map(create).transpose()?;
        Ok(Self {
            link,
            recorder,
            segment,
            eeproms,
        })
    }

    fn serve(mut self, stop: &AtomicBool, mut show: impl FnMut(&VirtualSegment, Traffic)) -> anyhow::Result<()> {
        let eeproms = &mut self.eeproms;
        let mut failure = None;
        let observe = |segment: &VirtualSegment, traffic| {
            if let Some(folder) = eeproms
                && let Err(error) = folder.save_rested(segment)
                && failure.is_none()
            {
                eprintln!("usr2556e: {error:#}; the drives go on, and their EEPROMs are saved again at the end");
                failure = Some(());
            }
            show(segment, traffic);
        };
        let ended: Result<(), LinkError> = server::serve_recorded(&mut self.link, &mut self.segment, self.recorder.as_mut(), stop, observe);
        if let Some(folder) = &mut self.eeproms {
            folder.save_all(&self.segment)?;
        }
        if let Some(recorder) = self.recorder {
            recorder.finish().context("the capture is not complete")?;
        }
        Ok(ended?)
    }
}
