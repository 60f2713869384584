//! The raw links where there are no Linux packet sockets: opening one says so, and nothing else can be reached.
use super::cards::Cards;
use super::open_error::OpenError;
use super::{Link, LinkError, Received};
use esc::Side;
use std::convert::Infallible;
use std::time::Duration;

/// Which end of the wire a link is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Answers the master's frames.
    DriveServer,
    /// Sends frames and awaits their return.
    Master,
}

/// EtherCAT frames on a network interface; cannot exist on this operating system.
#[derive(Debug)]
pub struct RawLink(Infallible);

impl RawLink {
    /// Always [`OpenError::OnlyOnLinux`] here.
    pub fn open(interface: &str, _role: Role) -> Result<Self, OpenError> {
        Err(OpenError::OnlyOnLinux {
            interface: interface.into(),
        })
    }

    /// The interface's name.
    pub fn interface(&self) -> &str {
        match self.0 {}
    }

    /// Frames lost so far.
    pub fn lost(&self) -> u64 {
        match self.0 {}
    }

    /// Whether there is a partner at the other end of the cable.
    pub fn carrier(&self) -> bool {
        match self.0 {}
    }
}

impl Link for RawLink {
    fn send(&mut self, _frame: &[u8]) -> Result<(), LinkError> {
        match self.0 {}
    }

    fn receive(&mut self, _buffer: &mut [u8], _wait: Duration) -> Result<Received, LinkError> {
        match self.0 {}
    }
}

/// The drives' ends of the two cables of a ring; cannot exist on this operating system.
#[derive(Debug)]
pub struct RawPair(Infallible);

impl RawPair {
    /// Always [`OpenError::OnlyOnLinux`] here.
    pub fn open(interfaces: [&str; 2]) -> Result<Self, OpenError> {
        Err(OpenError::OnlyOnLinux {
            interface: interfaces[0].into(),
        })
    }
}

impl Cards for RawPair {
    fn send_to(&mut self, _side: Side, _frame: &[u8]) -> Result<(), LinkError> {
        match self.0 {}
    }

    fn receive_any(&mut self, _buffer: &mut [u8], _wait: Duration) -> Result<(Side, Received), LinkError> {
        match self.0 {}
    }
}
