//! The packet socket of one network interface, and whether the interface is up.
use super::interface::{State, claim, existing, state};
use super::open_error::OpenError;
use super::raw::Role;
use super::{ETHERTYPE, LinkError, Received, sys};
use nix::errno::Errno;
use nix::net::if_::if_nametoindex;
use nix::sys::socket::{MsgFlags, recv, send};
use std::io;
use std::os::fd::{AsFd, AsRawFd, BorrowedFd, OwnedFd};
use std::os::unix::net::UnixListener;
use std::time::{Duration, Instant};

/// How often an interface that is down is asked whether it is up again, and one whose partner matters whether it is there.
const CHECK: Duration = Duration::from_millis(100);

/// When an interface is as good as off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DownWhen {
    /// It was switched off.
    Off,
    /// It was switched off, or nobody is at the other end of its cable.
    Alone,
}

/// One interface. What it does not take is lost, as on a wire, and counted; so is what comes while it is down.
#[derive(Debug)]
pub(super) struct PacketSocket {
    interface: String,
    index: u32,
    socket: OwnedFd,
    down_when: DownWhen,
    up: bool,
    /// When to ask next whether the interface is up.
    next_check: Option<Instant>,
    lost: u64,
    /// Held for its name, which only one drive server can have.
    _only_server: Option<UnixListener>,
}

impl PacketSocket {
    pub(super) fn open(interface: &str, role: Role, down_when: DownWhen) -> Result<Self, OpenError> {
        let name = || interface.to_string();
        let missing = || OpenError::Missing {
            interface: name(),
            existing: existing(),
        };
        let index = if_nametoindex(interface).map_err(|_| missing())?;
        match state(interface, index) {
            State::Gone => return Err(missing()),
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
        let only_server = match role {
            Role::DriveServer => Some(claim(interface, index)?),
            Role::Master => None,
        };
        Ok(Self {
            interface: name(),
            index,
            socket,
            down_when,
            up: true,
            next_check: (down_when == DownWhen::Alone).then(Instant::now),
            lost: 0,
            _only_server: only_server,
        })
    }

    pub(super) fn interface(&self) -> &str {
        &self.interface
    }

    pub(super) const fn lost(&self) -> u64 {
        self.lost
    }

    /// When [`Self::check`] has something to do.
    pub(super) const fn next_check(&self) -> Option<Instant> {
        self.next_check
    }

    pub(super) fn descriptor(&self) -> BorrowedFd<'_> {
        self.socket.as_fd()
    }

    pub(super) fn carrier(&self) -> bool {
        matches!(state(&self.interface, self.index), State::Up { carrier: true })
    }

    /// A frame that is there already, or the end of the interface's being up.
    pub(super) fn poll(&mut self, buffer: &mut [u8]) -> Result<Option<Received>, LinkError> {
        // Every round but the last empties the receive queue by one, whose size is limited.
        loop {
            // With MSG_TRUNC the kernel tells the frame's length, not how much of it fitted.
            match recv(self.socket.as_raw_fd(), buffer, MsgFlags::MSG_DONTWAIT | MsgFlags::MSG_TRUNC) {
                Ok(length) if self.up && length <= buffer.len() => return Ok(Some(Received::Frame(length))),
                Ok(_) => self.lose(),
                Err(Errno::EAGAIN) => return Ok(None),
                Err(Errno::EINTR) => {}
                Err(Errno::ENETDOWN) => {
                    self.next_check = Some(Instant::now());
                    if matches!(state(&self.interface, self.index), State::Gone) {
                        return Err(self.removed());
                    }
                    if self.up {
                        self.up = false;
                        return Ok(Some(Received::Down));
                    }
                }
                Err(error) => return Err(self.failed("receive", error)),
            }
        }
    }

    pub(super) fn send(&mut self, frame: &[u8]) -> Result<(), LinkError> {
        match send(self.socket.as_raw_fd(), frame, MsgFlags::MSG_DONTWAIT) {
            Ok(_) => Ok(()),
            // Down, no partner, queue full, just removed: the next `receive` finds out which, if it matters.
            Err(Errno::ENETDOWN | Errno::ENOBUFS | Errno::EAGAIN | Errno::ENXIO | Errno::EINTR) => {
                self.lose();
                Ok(())
            }
            Err(error) => Err(self.failed("send a frame", error)),
        }
    }

    /// Whether the interface has gone down or come up, if it is time to ask.
    pub(super) fn check(&mut self, now: Instant) -> Result<Option<Received>, LinkError> {
        if self.next_check.is_none_or(|due| now < due) {
            return Ok(None);
        }
        let up = match state(&self.interface, self.index) {
            State::Gone => return Err(self.removed()),
            State::Down => false,
            State::Up { carrier } => carrier || self.down_when == DownWhen::Off,
        };
        let watched = !up || self.down_when == DownWhen::Alone;
        self.next_check = watched.then(|| now + CHECK);
        let changed = up != self.up;
        self.up = up;
        Ok(changed.then_some(if up { Received::Up } else { Received::Down }))
    }

    /// A lost frame is a reason to ask at once whether the interface is what it was.
    fn lose(&mut self) {
        self.lost += 1;
        self.next_check = self.next_check.map(|_| Instant::now());
    }

    fn removed(&self) -> LinkError {
        LinkError::Removed {
            interface: self.interface.clone(),
        }
    }

    pub(super) fn failed(&self, doing: &'static str, error: Errno) -> LinkError {
        LinkError::System {
            interface: self.interface.clone(),
            doing,
            source: error.into(),
        }
    }
}
