//! `run` and `exec`.

use std::fmt;
use std::io::{self, Write};
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::SystemTime;

use anyhow::{Context, bail};

use super::arguments::{Exec, Run, Served};
use crate::drive::DriveConfig;
use crate::eeprom_folder::EepromFolder;
use crate::link::lossy::{Loss, Lossy};
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
    service.tell_loss();
    let mut lines = StatusLines::new(options.served.drives.into());
    service.serve(&stop, |segment, traffic| lines.show(segment, traffic))?;
    Ok(())
}

pub(super) fn exec(options: &Exec) -> anyhow::Result<ExitCode> {
    // First of all: only a process of one thread can move into a network of its own.
    namespace::enter()?;
    let service = Service::prepare(&options.served, Place::Interface(namespace::DRIVE_INTERFACE))?;
    service.tell_loss();
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

/// What is to be lost.
fn loss(served: &Served) -> Option<Loss> {
    served.lose.map(|percent| Loss {
        share: percent / 100.0,
        seed: served.seed.unwrap_or_else(any_seed),
    })
}

/// Another number at each start, short enough to be typed.
fn any_seed() -> u64 {
    let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    u64::from(now.subsec_nanos())
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

/// Drives, the link to their master, its capture, and where the drives' EEPROMs are kept.
struct Service {
    link: Box<dyn Link + Send>,
    loss: Option<Loss>,
    recorder: Option<Recorder>,
    segment: VirtualSegment,
    eeproms: Option<EepromFolder>,
}

impl Service {
    /// Everything that can be wrong with what was typed comes out here, before the first frame.
    fn prepare(served: &Served, place: Place<'_>) -> anyhow::Result<Self> {
        let count = usize::from(served.drives);
        let eeproms = served
            .eeprom
            .as_deref()
            .map(|folder| EepromFolder::open(folder, count))
            .transpose()?;
        let configs = (0..count).map(|position| {
            let eeprom = eeproms.as_ref().map_or(Ok(None), |folder| folder.load(position))?;
            let config = DriveConfig {
                eeprom,
                ..DriveConfig::numbered(position)
            };
            Ok(config.drifting(position, served.clock_drift.unwrap_or(0.0)))
        });
        let segment = VirtualSegment::new(configs.collect::<anyhow::Result<Vec<_>>>()?);
        let mut link = place.open()?;
        let loss = loss(served);
        if let Some(loss) = loss {
            link = Box::new(Lossy::new(link, loss));
        }
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
            loss,
            recorder,
            segment,
            eeproms,
        })
    }

    /// Says which frames get lost, on standard error, as the command of `exec` has the standard output.
    fn tell_loss(&self) {
        if let Some(loss) = self.loss {
            eprintln!(
                "Losing {} % of the frames of each direction; --seed {} loses the same ones again.",
                loss.share * 100.0,
                loss.seed
            );
        }
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
