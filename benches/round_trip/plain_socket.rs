//! A packet socket that just blocks: one system call to receive, one to send.

use std::io;
use std::os::fd::AsRawFd;
use std::time::Duration;

use nix::ifaddrs::getifaddrs;
use nix::sys::socket::{MsgFlags, SockaddrStorage, bind, recv, send};
use socket2::{Domain, Protocol, Socket, Type};
use usr2556e::link::ETHERTYPE;

/// How long a receive blocks before it comes back to see whether there is something else to do.
const LONGEST_BLOCK: Duration = Duration::from_millis(100);

/// EtherCAT frames of one interface.
pub struct PlainSocket(Socket);

impl PlainSocket {
    /// Opens the interface of this name.
    pub fn open(interface: &str) -> io::Result<Self> {
        // This one address leaves the protocol out, and binding then keeps that of the socket.
        let address = link_address(interface)?;
        let protocol = Protocol::from(i32::from(ETHERTYPE.to_be()));
        let socket = Socket::new(Domain::PACKET, Type::RAW, Some(protocol))?;
        bind(socket.as_raw_fd(), &address)?;
        socket.set_read_timeout(Some(LONGEST_BLOCK))?;
        Ok(Self(socket))
    }

    /// The next frame's length, if one came.
    pub fn receive(&self, buffer: &mut [u8]) -> Option<usize> {
        recv(self.0.as_raw_fd(), buffer, MsgFlags::empty()).ok()
    }

    /// Sends a frame.
    pub fn send(&self, frame: &[u8]) -> io::Result<()> {
        send(self.0.as_raw_fd(), frame, MsgFlags::empty())?;
        Ok(())
    }
}

fn link_address(interface: &str) -> io::Result<SockaddrStorage> {
    getifaddrs()?
        .filter(|entry| entry.interface_name == interface)
        .filter_map(|entry| entry.address)
        .find(|address| address.as_link_addr().is_some())
        .ok_or_else(|| io::Error::from(io::ErrorKind::NotFound))
}
