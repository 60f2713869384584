//! EtherCAT frames on a network interface, through a Linux packet socket.
//!
//! The kernel takes the tag off a frame that came with one (VLAN) before a packet socket sees it; such a frame is answered without its tag.
use super::interface::{State, claim, existing, state};
use super::open_error::OpenError;
use super::wait::{Plan, Predictor};
use super::{ETHERTYPE, Link, LinkError, Received, sys};
use crate::clock::sleep_precisely;
use nix::errno::Errno;
use nix::net::if_::if_nametoindex;
use nix::poll::{PollFd, PollFlags, ppoll};
use nix::sys::socket::{MsgFlags, recv, send};
use std::io;
use std::os::fd::{AsFd, AsRawFd, OwnedFd};
use std::os::unix::net::UnixListener;
use std::thread::{self, ThreadId};
use std::time::{Duration, Instant};

/// How often an interface that is down is asked whether it is up again.
const DOWN_CHECK: Duration = Duration::from_millis(100);

/// No wait needs to be longer; keeps instants from overflowing.
const LONGEST_WAIT: Duration = Duration::from_secs(3600);

/// Which end of the wire a link is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Answers the master's frames: one per interface, waits predictively.
    DriveServer,
    /// Sends frames and awaits their return: waits by blocking.
    Master,
}

/// EtherCAT frames on a network interface.
///
/// A frame that the interface does not take (no partner, its queue full) is lost, as on a wire, and counted in [`RawLink::lost`].
#[derive(Debug)]
pub struct RawLink {
    interface: String,
    index: u32,
    socket: OwnedFd,
    /// Only a drive server predicts: a master knows when the frame that it sent comes back.
    predictor: Option<Predictor>,
    /// When to ask next whether the interface is up again; `None` while it is up.
    down: Option<Instant>,
    lost: u64,
    /// The thread whose timers were made precise.
    precise: Option<ThreadId>,
    /// Held for its name, which only one drive server can have.
    _only_server: Option<UnixListener>,
}

impl RawLink {
    /// Opens the network interface of this name, which must be up.
    pub fn open(interface: &str, role: Role) -> Result<Self, OpenError> {
        let name = || interface.to_string();
        let index = if_nametoindex(interface).map_err(|_| OpenError::Missing {
            interface: name(),
            existing: existing(),
        })?;
        match state(interface, index) {
            State::Gone => {
                return Err(OpenError::Missing {
                    interface: name(),
                    existing: existing(),
                });
            }
            State::Down => return Err(OpenError::Down { interface: name() }),
            State::Up { .. } => {}
        }
        let socket = sys::packet_socket(index, ETHERTYPE).map_err(|(doing, source)| match source.kind() {
            io::ErrorKind::PermissionDenied => OpenError::NoPermission { interface: name() },
            _ => OpenError::System {
                interface: name(),
                doing,
                source,
            },
        })?;
        let (predictor, only_server) = match role {
            Role::DriveServer => (Some(new_predictor()), Some(claim(interface, index)?)),
            Role::Master => (None, None),
        };
        Ok(RawLink {
            interface: name(),
            index,
            socket,
            predictor,
            down: None,
            lost: 0,
            precise: None,
            _only_server: only_server,
        })
    }

    /// The interface's name.
    pub fn interface(&self) -> &str {
        &self.interface
    }

    /// Frames that the interface did not take, and received ones that were longer than the buffer.
    pub fn lost(&self) -> u64 {
        self.lost
    }

    /// Whether there is a partner at the other end of the cable. False also while the interface is down or gone.
    pub fn carrier(&self) -> bool {
        matches!(state(&self.interface, self.index), State::Up { carrier: true })
    }

    /// A frame that is there already.
    fn poll(&mut self, buffer: &mut [u8]) -> Result<Option<Received>, LinkError> {
        loop {
            // With MSG_TRUNC the kernel tells the frame's length, not how much of it fitted.
            match recv(self.socket.as_raw_fd(), buffer, MsgFlags::MSG_DONTWAIT | MsgFlags::MSG_TRUNC) {
                Ok(length) if length <= buffer.len() => return Ok(Some(Received::Frame(length))),
                // Bounded by the socket's receive queue, and each round empties it by one.
                Ok(_) => self.lost += 1,
                Err(Errno::EAGAIN) => return Ok(None),
                Err(Errno::EINTR) => {}
                Err(Errno::ENETDOWN) => {
                    self.down = Some(Instant::now());
                    return match state(&self.interface, self.index) {
                        State::Gone => Err(self.removed()),
                        State::Up { .. } | State::Down => Ok(Some(Received::Down)),
                    };
                }
                Err(error) => return Err(self.failed("receive", error)),
            }
        }
    }

    /// Sleeps until `until`, or until something happens at the socket.
    fn sleep(&self, until: Instant) -> Result<(), LinkError> {
        let left = until.saturating_duration_since(Instant::now());
        match ppoll(&mut [PollFd::new(self.socket.as_fd(), PollFlags::POLLIN)], Some(left.into()), None) {
            Ok(_) | Err(Errno::EINTR) => Ok(()),
            Err(error) => Err(self.failed("wait", error)),
        }
    }

    /// Looks for a frame without sleeping.
    fn spin(&mut self, buffer: &mut [u8], until: Instant) -> Result<Option<Received>, LinkError> {
        loop {
            let found = self.poll(buffer)?;
            if found.is_some() || Instant::now() >= until {
                return Ok(found);
            }
            // Yielding costs next to nothing while no one else wants this core, and lets a master on the same core send what is looked for.
            thread::yield_now();
        }
    }

    /// The next frame, or what else comes first.
    fn next(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<Received, LinkError> {
        loop {
            if let Some(received) = self.poll(buffer)? {
                return Ok(received);
            }
            let now = Instant::now();
            let plan = self.predictor.as_mut().map_or(Plan::Block, |predictor| predictor.plan(now));
            if now >= deadline && plan != Plan::Announce {
                return Ok(Received::Timeout);
            }
            match plan {
                Plan::SleepUntil(time) => self.sleep(time.min(deadline))?,
                Plan::Announce => return Ok(Received::Soon),
                Plan::SpinUntil(time) => {
                    if let Some(received) = self.spin(buffer, time.min(deadline))? {
                        return Ok(received);
                    }
                }
                Plan::Block => self.sleep(deadline)?,
            }
        }
    }

    /// Waits for an interface that is down. The socket works again by itself when the interface does.
    fn await_up(&mut self, mut next_check: Instant, deadline: Instant) -> Result<Received, LinkError> {
        loop {
            let now = Instant::now();
            if now >= next_check {
                match state(&self.interface, self.index) {
                    State::Gone => return Err(self.removed()),
                    State::Up { .. } => {
                        self.down = None;
                        self.predictor = self.predictor.as_ref().map(|_| new_predictor());
                        return Ok(Received::Up);
                    }
                    State::Down => next_check = now + DOWN_CHECK,
                }
                self.down = Some(next_check);
            }
            if now >= deadline {
                return Ok(Received::Timeout);
            }
            thread::sleep(next_check.min(deadline).saturating_duration_since(now));
        }
    }

    /// Frames are announced late where sleeps are not precise; a link may change threads.
    fn be_precise(&mut self) {
        let thread = Some(thread::current().id());
        if self.precise != thread {
            self.precise = thread;
            sleep_precisely();
        }
    }

    fn removed(&self) -> LinkError {
        LinkError::Removed {
            interface: self.interface.clone(),
        }
    }

    fn failed(&self, doing: &'static str, error: Errno) -> LinkError {
        LinkError::System {
            interface: self.interface.clone(),
            doing,
            source: error.into(),
        }
    }
}

impl Link for RawLink {
    fn send(&mut self, frame: &[u8]) -> Result<(), LinkError> {
        match send(self.socket.as_raw_fd(), frame, MsgFlags::MSG_DONTWAIT) {
            Ok(_) => Ok(()),
            // Down, no partner, queue full, just removed: the next `receive` finds out which, if it matters.
            Err(Errno::ENETDOWN | Errno::ENOBUFS | Errno::EAGAIN | Errno::ENXIO | Errno::EINTR) => {
                self.lost += 1;
                Ok(())
            }
            Err(error) => Err(self.failed("send a frame", error)),
        }
    }

    fn receive(&mut self, buffer: &mut [u8], wait: Duration) -> Result<Received, LinkError> {
        let deadline = Instant::now() + wait.min(LONGEST_WAIT);
        if let Some(next_check) = self.down {
            return self.await_up(next_check, deadline);
        }
        if self.predictor.is_some() {
            self.be_precise();
        }
        let received = self.next(buffer, deadline)?;
        if let (Received::Frame(_), Some(predictor)) = (received, &mut self.predictor) {
            predictor.arrived(Instant::now());
        }
        Ok(received)
    }
}

/// On a single core, spinning would keep a master on the same machine from sending what is spun for.
fn new_predictor() -> Predictor {
    // Cores that are online, not those this process may use: a server bound to one core leaves the master another.
    let cores = nix::unistd::sysconf(nix::unistd::SysconfVar::_NPROCESSORS_ONLN);
    Predictor::new(Instant::now(), cores.is_ok_and(|cores| cores > Some(1)))
}
