//! `run` and `exec`.

use std::fmt;
use std::io::{self, Write};
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use anyhow::{Context, bail};

use super::arguments::{Exec, Run, Served};
use crate::drive::DriveConfig;
use crate::kept_folder::KeptFolder;
use crate::link::pcap::Recorder;
use crate::link::raw::{RawLink, Role};
use crate::link::udp::UdpLink;
use crate::link::{Link, LinkError};
use crate::namespace;
use crate::segment::VirtualSegment;
use crate::server::{self, Traffic};
use crate::status::StatusLines;

pub(super) fn run(options: &Run) -> anyhow::Result<()> {
    let stop = super::on_signal()?;
    let place = match (options.udp, &options.interface) {
        (Some(address), _) => Place::Udp(address),
        (None, Some(interface)) => Place::Interface(interface),
        (None, None) => bail!("name the interface to serve with --interface IFACE, or an address with --udp ADDRESS:PORT"),
    };
    let service = Service::prepare(&options.served, place)?;
    writeln!(io::stdout(), "Serving {} on {place}; Ctrl-C ends.", plural(options.served.drives))?;
    let mut lines = StatusLines::new(options.served.drives.into());
    service.serve(&stop, |segment, traffic| lines.show(segment, traffic))?;
    Ok(())
}

pub(super) fn exec(options: &Exec) -> anyhow::Result<ExitCode> {
    // First of all: only a process of one thread can move into a network of its own.
    namespace::enter()?;
    let service = Service::prepare(&options.served, Place::Interface(namespace::DRIVE_INTERFACE))?;
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

/// Where drives are served.
#[derive(Clone, Copy)]
enum Place<'a> {
    Interface(&'a str),
    Udp(SocketAddr),
}

impl Place<'_> {
    fn open(self) -> anyhow::Result<Box<dyn Link + Send>> {
        Ok(match self {
            Self::Interface(interface) => Box::new(RawLink::open(interface, Role::DriveServer)?),
            Self::Udp(address) => Box::new(UdpLink::serve(address)?),
        })
    }
}

impl fmt::Display for Place<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Interface(interface) => write!(f, "{interface}"),
            Self::Udp(address) => write!(f, "UDP {address}"),
        }
    }
}

/// Drives, the link to their master, its capture, and the folder that keeps the drives' memories.
struct Service {
    link: Box<dyn Link + Send>,
    recorder: Option<Recorder>,
    segment: VirtualSegment,
    kept: Option<KeptFolder>,
}

impl Service {
    /// Everything that can be wrong with what was typed comes out here, before the first frame.
    fn prepare(served: &Served, place: Place<'_>) -> anyhow::Result<Self> {
        let count = usize::from(served.drives);
        let kept = served.keep.as_deref().map(|folder| KeptFolder::open(folder, count)).transpose()?;
        let configs = (0..count).map(|position| match &kept {
            Some(folder) => folder.load(position),
            None => Ok(DriveConfig::numbered(position)),
        });
        let segment = VirtualSegment::new(configs.collect::<anyhow::Result<Vec<_>>>()?);
        let link = place.open()?;
        let create = |file: &PathBuf| {
            Recorder::create(file, &place.to_string()).with_context(|| {
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
            kept,
        })
    }

    fn serve(mut self, stop: &AtomicBool, mut show: impl FnMut(&VirtualSegment, Traffic)) -> anyhow::Result<()> {
        let kept = &mut self.kept;
        let mut failure = None;
        let observe = |segment: &VirtualSegment, traffic| {
            if let Some(folder) = kept
                && let Err(error) = folder.save_rested(segment)
                && failure.is_none()
            {
                eprintln!("usr2556e: {error:#}; the drives go on, and what is kept of them is written again at the end");
                failure = Some(());
            }
            show(segment, traffic);
        };
        let ended: Result<(), LinkError> = server::serve_recorded(&mut self.link, &mut self.segment, self.recorder.as_mut(), stop, observe);
        if let Some(folder) = &mut self.kept {
            folder.save_all(&self.segment)?;
        }
        if let Some(recorder) = self.recorder {
            recorder.finish().context("the capture is not complete")?;
        }
        Ok(ended?)
    }
}
