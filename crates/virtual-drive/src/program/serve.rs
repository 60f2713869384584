//! `run` and `exec`.

use std::fmt;
use std::io::{self, Write};
use std::net::SocketAddr;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::SystemTime;

use anyhow::{Context, bail, ensure};
use tempfile::TempDir;

use super::arguments::{Exec, Run, Served};
use crate::control::{CONTROL_VARIABLE, ControlSocket};
use crate::drive::DriveConfig;
use crate::kept_folder::KeptFolder;
use crate::link::LinkError;
use crate::link::cards::Cards;
use crate::link::lossy::{Loss, LossyCards};
use crate::link::pcap::Recorder;
use crate::link::raw::{RawLink, RawPair, Role};
use crate::link::udp::UdpLink;
use crate::namespace;
use crate::segment::VirtualSegment;
use crate::server::{self, Attendants};
use crate::status::StatusLines;

pub(super) fn run(options: &Run) -> anyhow::Result<()> {
    let stop = super::on_signal()?;
    let place = match (options.udp, &options.interface, &options.redundant) {
        (Some(address), _, _) => Place::Udp(address),
        (None, Some(interface), None) => Place::Line(interface),
        (None, Some(interface), Some(redundant)) => Place::Ring([interface, redundant]),
        (None, None, _) => bail!("name the interface to serve with --interface IFACE, or an address with --udp ADDRESS:PORT"),
    };
    let mut service = Service::prepare(&options.served, place)?;
    service.control = options.control.as_deref().map(ControlSocket::bind).transpose()?;
    writeln!(io::stdout(), "Serving {} on {place}; Ctrl-C ends.", plural(options.served.drives))?;
    service.tell_loss();
    let mut lines = StatusLines::new(options.served.drives.into());
    service.serve(&stop, |segment| lines.show(segment))?;
    Ok(())
}

pub(super) fn exec(options: &Exec) -> anyhow::Result<ExitCode> {
    // First of all: only a process of one thread can move into a network of its own.
    namespace::enter()?;
    let mut environment = vec![(namespace::INTERFACE_VARIABLE, namespace::MASTER_INTERFACE.as_ref())];
    let place = if options.ring {
        namespace::close_ring()?;
        environment.push((
            namespace::REDUNDANT_INTERFACE_VARIABLE,
            namespace::REDUNDANT_MASTER_INTERFACE.as_ref(),
        ));
        Place::Ring([namespace::DRIVE_INTERFACE, namespace::REDUNDANT_DRIVE_INTERFACE])
    } else {
        Place::Line(namespace::DRIVE_INTERFACE)
    };
    let mut service = Service::prepare(&options.served, place)?;
    // Removed last, when the socket in it is.
    let folder = folder_of_ones_own()?;
    let control = folder.path().join("control");
    service.control = Some(ControlSocket::bind(&control)?);
    environment.push((CONTROL_VARIABLE, control.as_os_str()));
    service.tell_loss();
    let stop = Arc::new(AtomicBool::new(false));
    let serving = thread::spawn({
        let stop = Arc::clone(&stop);
        move || service.serve(&stop, |_| ())
    });
    let ended = namespace::command::run(&options.command, &environment);
    stop.store(true, Ordering::Relaxed);
    serving.join().map_err(|_| anyhow::anyhow!("the drives' thread has panicked"))??;
    Ok(ExitCode::from(ended.unwrap_or_else(|error| {
        eprintln!("usr2556e: {error}");
        error.exit_code()
    })))
}

/// Where nobody else can put anything.
fn folder_of_ones_own() -> anyhow::Result<TempDir> {
    tempfile::Builder::new()
        .prefix("usr2556e-")
        .tempdir()
        .context("cannot make a folder for the control socket; the environment variable TMPDIR chooses where")
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
    Line(&'a str),
    Ring([&'a str; 2]),
    Udp(SocketAddr),
}

impl Place<'_> {
    fn open(self) -> anyhow::Result<Box<dyn Cards + Send>> {
        Ok(match self {
            Self::Line(interface) => Box::new(RawLink::open(interface, Role::DriveServer)?),
            Self::Ring([one, other]) => {
                ensure!(
                    one != other,
                    "--interface and --redundant must name two interfaces, not {one} twice"
                );
                Box::new(RawPair::open([one, other])?)
            }
            Self::Udp(address) => Box::new(UdpLink::serve(address)?),
        })
    }

    fn recorder(self, file: &Path) -> io::Result<Recorder> {
        match self {
            Self::Line(interface) => Recorder::create(file, interface),
            Self::Ring([one, other]) => Recorder::create(file, one)?.with_interface(other),
            Self::Udp(_) => Recorder::create(file, &self.to_string()),
        }
    }
}

impl fmt::Display for Place<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(interface) => write!(f, "{interface}"),
            Self::Ring([one, other]) => write!(f, "the ring between {one} and {other}"),
            Self::Udp(address) => write!(f, "UDP {address}"),
        }
    }
}

/// Drives, the wires to their master, what passed there, who cuts cables, and the folder that keeps the drives' memories.
struct Service {
    cards: Box<dyn Cards + Send>,
    loss: Option<Loss>,
    recorder: Option<Recorder>,
    control: Option<ControlSocket>,
    segment: VirtualSegment,
    kept: Option<KeptFolder>,
}

impl Service {
    /// Everything that can be wrong with what was typed comes out here, before the first frame.
    fn prepare(served: &Served, place: Place<'_>) -> anyhow::Result<Self> {
        let count = usize::from(served.drives);
        let kept = served.keep.as_deref().map(|folder| KeptFolder::open(folder, count)).transpose()?;
        let configs = (0..count).map(|position| {
            let config = match &kept {
                Some(folder) => folder.load(position)?,
                None => DriveConfig::numbered(position),
            };
            let config = DriveConfig {
                plant: served.equipment.plant(),
                ..config
            };
            Ok(config.drifting(position, served.clock_drift.unwrap_or(0.0)))
        });
        let configs = configs.collect::<anyhow::Result<Vec<_>>>()?;
        let segment = match place {
            Place::Ring(_) => VirtualSegment::ring(configs),
            Place::Line(_) | Place::Udp(_) => VirtualSegment::new(configs),
        };
        let mut cards = place.open()?;
        let loss = loss(served);
        if let Some(loss) = loss {
            cards = Box::new(LossyCards::new(cards, loss));
        }
        let create = |file: &Path| {
            place.recorder(file).with_context(|| {
                format!(
                    "cannot write the capture {}; choose another file with --record FILE",
                    file.display()
                )
            })
        };
        let recorder = served.record.as_deref().map(create).transpose()?;
        Ok(Self {
            cards,
            loss,
            recorder,
            control: None,
            segment,
            kept,
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

    fn serve(mut self, stop: &AtomicBool, mut show: impl FnMut(&VirtualSegment)) -> anyhow::Result<()> {
        let kept = &mut self.kept;
        let mut failure = None;
        let observe = |segment: &VirtualSegment, _| {
            if let Some(folder) = kept
                && let Err(error) = folder.save_rested(segment)
                && failure.is_none()
            {
                eprintln!("usr2556e: {error:#}; the drives go on, and what is kept of them is written again at the end");
                failure = Some(());
            }
            show(segment);
        };
        let attendants = Attendants {
            recorder: self.recorder.as_mut(),
            requests: self.control.as_ref().map(ControlSocket::requests),
        };
        let ended: Result<(), LinkError> = server::serve_attended(&mut *self.cards, &mut self.segment, attendants, stop, observe);
        if let Some(folder) = &mut self.kept {
            folder.save_all(&self.segment)?;
        }
        if let Some(recorder) = self.recorder {
            recorder.finish().context("the capture is not complete")?;
        }
        Ok(ended?)
    }
}
