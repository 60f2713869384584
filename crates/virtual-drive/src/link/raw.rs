//! EtherCAT frames on network interfaces, through Linux packet sockets.
//!
//! The kernel takes the tag off a frame that came with one (VLAN) before a packet socket sees it; such a frame is answered without its tag.
use super::cards::Cards;
use super::open_error::OpenError;
use super::socket::{DownWhen, PacketSocket};
use super::waiter::Waiter;
use super::{Link, LinkError, Received};
use esc::Side;
use std::time::Duration;

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
    socket: [PacketSocket; 1],
    /// Only a drive server predicts: a master knows when the frame that it sent comes back.
    waiter: Waiter,
}

impl RawLink {
    /// Opens the network interface of this name, which must be up.
    pub fn open(interface: &str, role: Role) -> Result<Self, OpenError> {
        let waiter = match role {
            Role::DriveServer => Waiter::predictive(),
            Role::Master => Waiter::blocking(),
        };
        Ok(Self {
            socket: [PacketSocket::open(interface, role, DownWhen::Off)?],
            waiter,
        })
    }

    /// The interface's name.
    pub fn interface(&self) -> &str {
        self.socket[0].interface()
    }

    /// Frames that the interface did not take, and received ones that were longer than the buffer or came while it was down.
    pub fn lost(&self) -> u64 {
        self.socket[0].lost()
    }

    /// Whether there is a partner at the other end of the cable. False also while the interface is down or gone.
    pub fn carrier(&self) -> bool {
        self.socket[0].carrier()
    }
}

impl Link for RawLink {
    fn send(&mut self, frame: &[u8]) -> Result<(), LinkError> {
        self.socket[0].send(frame)
    }

    fn receive(&mut self, buffer: &mut [u8], wait: Duration) -> Result<Received, LinkError> {
        Ok(self.waiter.receive(&mut self.socket, buffer, wait)?.1)
    }
}

/// The drives' ends of the two cables of a ring.
///
/// An interface that loses its partner is told as [`Received::Down`] too: in a ring, that is a broken cable, round which frames find
/// another way.
#[derive(Debug)]
pub struct RawPair {
    sockets: [PacketSocket; 2],
    waiter: Waiter,
}

impl RawPair {
    /// Opens the two interfaces, which must be up: the one before the first drive, and the one behind the last.
    pub fn open(interfaces: [&str; 2]) -> Result<Self, OpenError> {
        let [primary, secondary] = interfaces.map(|interface| PacketSocket::open(interface, Role::DriveServer, DownWhen::Alone));
        Ok(Self {
            sockets: [primary?, secondary?],
            waiter: Waiter::predictive(),
        })
    }
}

impl Cards for RawPair {
    fn send_to(&mut self, side: Side, frame: &[u8]) -> Result<(), LinkError> {
        self.sockets[side as usize].send(frame)
    }

    fn receive_any(&mut self, buffer: &mut [u8], wait: Duration) -> Result<(Side, Received), LinkError> {
        let (place, received) = self.waiter.receive(&mut self.sockets, buffer, wait)?;
        Ok(([Side::Primary, Side::Secondary][place], received))
    }
}
