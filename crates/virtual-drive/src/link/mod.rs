//! The wire between a master and the drives: whole Ethernet frames in, whole Ethernet frames out.
//!
//! | module | what it holds |
//! |---|---|
//! | [`cards`] | [`cards::Cards`]: the wires to the master's one or two network cards |
//! | [`raw`] | [`raw::RawLink`], [`raw::RawPair`]: EtherCAT frames on one or two network interfaces (Linux packet sockets) |
//! | `socket` | the packet socket of one interface |
//! | `waiter` | waiting at several of them at once |
//! | `interface` | what the system tells about an interface, and the claim of the one drive server on it |
//! | `sys` | the few system calls `raw` needs and no safe crate offers; the only unsafe code |
//! | [`open_error`] | why an interface could not be opened, and what to type |
//! | [`lossy`] | [`lossy::Lossy`]: any link, with frames lost |
//! | [`udp`] | [`udp::UdpLink`]: EtherCAT frames in UDP packets, without privileges |
//! | [`wait`] | [`wait::Predictor`]: when the next cyclic frame is due, and whether spinning for it pays |
//! | [`pcap`] | recording of any link to .pcapng, and reading captures back for replays |
use std::fmt;
use std::io;
use std::time::Duration;

pub mod cards;
#[cfg(target_os = "linux")]
mod interface;
pub mod lossy;
pub mod open_error;
pub mod pcap;
#[cfg(target_os = "linux")]
pub mod raw;
#[cfg(not(target_os = "linux"))]
#[path = "raw_elsewhere.rs"]
pub mod raw;
#[cfg(target_os = "linux")]
mod socket;
#[cfg(target_os = "linux")]
mod sys;
pub mod udp;
pub mod wait;
#[cfg(target_os = "linux")]
mod waiter;

/// EtherType of EtherCAT (ETG.1000.4, 5.3).
pub const ETHERTYPE: u16 = 0x88A4;

/// The longest Ethernet frame without its check sequence: 14 bytes of header, 4 of VLAN tag, 1500 of data, and 4 to spare
/// for interfaces that hand the check sequence over. A receive buffer of this size takes every frame.
pub const MAX_FRAME: usize = 1522;

/// What [`Link::receive`] came back with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Received {
    /// A frame, in the first so many bytes of the buffer.
    Frame(usize),
    /// A cyclic frame is expected within the guard time ([`wait::GUARD`]). Whoever simulates brings its simulation up to date now, so that the
    /// frame finds it ready, and calls again at once. Comes at most once per cycle, and only from links that predict.
    Soon,
    /// Nothing came within the given time.
    Timeout,
    /// The interface was switched off, or in a ring has lost its partner. Told once; the link waits for it to come back and loses what is
    /// sent meanwhile, like a pulled cable.
    Down,
    /// The interface is on again. Told once after [`Received::Down`].
    Up,
}

/// A wire with one master or one line of drives at this end.
pub trait Link {
    /// Puts one Ethernet frame, from its destination address to the end of its data, on the wire.
    ///
    /// `Ok` says that it was handed over, not that anyone got it: a wire that is cut loses frames without a word.
    fn send(&mut self, frame: &[u8]) -> Result<(), LinkError>;

    /// Waits up to `wait` for a frame. Returns at once if one is there already, whatever `wait` says.
    ///
    /// A frame longer than `buffer` is lost; [`MAX_FRAME`] bytes take all of them.
    fn receive(&mut self, buffer: &mut [u8], wait: Duration) -> Result<Received, LinkError>;
}

impl<L: Link + ?Sized> Link for Box<L> {
    fn send(&mut self, frame: &[u8]) -> Result<(), LinkError> {
        (**self).send(frame)
    }

    fn receive(&mut self, buffer: &mut [u8], wait: Duration) -> Result<Received, LinkError> {
        (**self).receive(buffer, wait)
    }
}

/// Why a link is of no more use.
#[derive(Debug)]
pub enum LinkError {
    /// The interface no longer exists, or another one has taken its name.
    Removed {
        /// Its name.
        interface: String,
    },
    /// The other end of a link inside this process is gone.
    Closed,
    /// The system refused.
    System {
        /// The interface's name.
        interface: String,
        /// What was asked for, to complete "could not ...".
        doing: &'static str,
        /// The system's answer.
        source: io::Error,
    },
}

impl fmt::Display for LinkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LinkError::Removed { interface } => {
                write!(
                    f,
                    "network interface {interface:?} was removed while in use; once it exists again, start this command again"
                )
            }
            LinkError::Closed => write!(f, "the other end of the link is gone"),
            LinkError::System { interface, doing, source } => write!(f, "could not {doing} on network interface {interface:?}: {source}"),
        }
    }
}

impl std::error::Error for LinkError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            LinkError::System { source, .. } => Some(source),
            LinkError::Removed { .. } | LinkError::Closed => None,
        }
    }
}
