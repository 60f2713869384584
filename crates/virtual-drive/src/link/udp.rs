//! EtherCAT over UDP (ETG.1000.4, 5.2): the same datagrams behind an IP and a UDP header, on port 0x88A4. It needs no privileges and passes
//! routers, but its timing is that of any network traffic.
//!
//! What crosses is the EtherCAT part of a frame. The Ethernet header that frames have inside this program is put in front here.
use std::fmt;
use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::time::Duration;

use wire::frame::{ETHERNET_HEADER, SOURCE_ADDRESS};

use super::{ETHERTYPE, Link, LinkError, MAX_FRAME, Received};

/// The UDP port of EtherCAT.
pub const PORT: u16 = 0x88A4;

/// The system takes a wait of zero for one without end.
const SHORTEST_WAIT: Duration = Duration::from_micros(1);

/// Set in the source address of what comes back to a master, as slaves do on Ethernet.
const PROCESSED_SOURCE: u8 = 0x02;

/// Why an address could not be used.
#[derive(Debug)]
pub struct BindError {
    address: SocketAddr,
    source: io::Error,
}

impl fmt::Display for BindError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.source.kind() {
            io::ErrorKind::AddrInUse => write!(
                f,
                "{} is in use, perhaps by another drive server; stop it, or choose another port with --udp ADDRESS:PORT",
                self.address
            ),
            io::ErrorKind::AddrNotAvailable => write!(
                f,
                "{} is no address of this computer; 0.0.0.0:{PORT} serves all of its networks, 127.0.0.1:{PORT} only itself",
                self.address
            ),
            _ => write!(f, "cannot use {}: {}", self.address, self.source),
        }
    }
}

impl std::error::Error for BindError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.source)
    }
}

/// EtherCAT frames in UDP packets.
#[derive(Debug)]
pub struct UdpLink {
    socket: UdpSocket,
    /// Where frames go: the drives, or whoever sent the last frame.
    peer: Option<SocketAddr>,
    /// The Ethernet header for what is received.
    header: [u8; ETHERNET_HEADER],
    is_master: bool,
}

impl UdpLink {
    /// The drives' end: takes frames at `address` and answers whoever sent them.
    ///
    /// # Errors
    /// The address is in use, or none of this computer's.
    pub fn serve(address: SocketAddr) -> Result<Self, BindError> {
        let socket = UdpSocket::bind(address).map_err(|source| BindError { address, source })?;
        Ok(Self::new(socket, None))
    }

    /// The master's end of a wire to drives at `drives`.
    ///
    /// # Errors
    /// There is no way to that address.
    pub fn connect(drives: SocketAddr) -> Result<Self, BindError> {
        let any = SocketAddr::new(if drives.is_ipv4() { [0; 4].into() } else { [0_u16; 8].into() }, 0);
        let socket = UdpSocket::bind(any)
            .and_then(|socket| socket.connect(drives).map(|()| socket))
            .map_err(|source| BindError { address: drives, source })?;
        Ok(Self::new(socket, Some(drives)))
    }

    fn new(socket: UdpSocket, peer: Option<SocketAddr>) -> Self {
        let mut header = [0xFF; ETHERNET_HEADER];
        header[SOURCE_ADDRESS..ETHERNET_HEADER - 2].fill(0);
        header[ETHERNET_HEADER - 2..].copy_from_slice(&ETHERTYPE.to_be_bytes());
        let is_master = peer.is_some();
        Self {
            socket,
            peer,
            header,
            is_master,
        }
    }

    /// Where frames are taken.
    ///
    /// # Errors
    /// The system does not say.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.socket.local_addr()
    }

    fn failed(&self, doing: &'static str, source: io::Error) -> LinkError {
        let interface = self.peer.map_or_else(|| "UDP".into(), |peer| format!("UDP {peer}"));
        LinkError::System { interface, doing, source }
    }
}

/// Whether an error says that the other end is not there now: packets are lost then, as on a wire that is cut.
fn is_loss(error: &io::Error) -> bool {
    use io::ErrorKind::{ConnectionRefused, ConnectionReset, HostUnreachable, Interrupted, NetworkUnreachable, TimedOut, WouldBlock};
    matches!(
        error.kind(),
        WouldBlock | TimedOut | Interrupted | ConnectionRefused | ConnectionReset | HostUnreachable | NetworkUnreachable
    )
}

impl Link for UdpLink {
    fn send(&mut self, frame: &[u8]) -> Result<(), LinkError> {
        let Some((header, packet)) = frame.split_first_chunk::<ETHERNET_HEADER>() else {
            return Ok(());
        };
        let sent = if self.is_master {
            self.header = *header;
            self.header[SOURCE_ADDRESS] |= PROCESSED_SOURCE;
            self.socket.send(packet)
        } else {
            self.peer.map_or(Ok(0), |peer| self.socket.send_to(packet, peer))
        };
        match sent {
            Err(error) if !is_loss(&error) => Err(self.failed("send a frame", error)),
            _ => Ok(()),
        }
    }

    fn receive(&mut self, buffer: &mut [u8], wait: Duration) -> Result<Received, LinkError> {
        let Some((header, packet)) = buffer.split_first_chunk_mut::<ETHERNET_HEADER>() else {
            return Ok(Received::Timeout);
        };
        let timeout = self.socket.set_read_timeout(Some(wait.max(SHORTEST_WAIT)));
        timeout.map_err(|error| self.failed("set a time-out", error))?;
        match self.socket.recv_from(packet) {
            // A packet that fills the buffer may have been longer.
            Ok((length, _)) if length >= packet.len().min(MAX_FRAME) => Ok(Received::Timeout),
            Ok((length, from)) => {
                *header = self.header;
                if !self.is_master {
                    self.peer = Some(from);
                }
                Ok(Received::Frame(ETHERNET_HEADER + length))
            }
            Err(error) if is_loss(&error) => Ok(Received::Timeout),
            Err(error) => Err(self.failed("receive", error)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair() -> (UdpLink, UdpLink) {
        let drives = UdpLink::serve(([127, 0, 0, 1], 0).into()).unwrap();
        let master = UdpLink::connect(drives.address().unwrap()).unwrap();
        (master, drives)
    }

    fn frame(link: &mut UdpLink, buffer: &mut [u8]) -> usize {
        for _ in 0..100 {
            match link.receive(buffer, Duration::from_millis(100)).unwrap() {
                Received::Frame(length) => return length,
                other => assert_eq!(other, Received::Timeout),
            }
        }
        panic!("no frame came");
    }

    #[test]
    fn a_frame_goes_there_and_comes_back_with_the_masters_header_marked_as_processed() {
        let (mut master, mut drives) = pair();
        let mut sent = vec![0xFF; 6];
        sent.extend([0x10; 6]);
        sent.extend([0x88, 0xA4, 0x0D, 0x10, 7, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0]);
        master.send(&sent).unwrap();
        let mut buffer = [0; MAX_FRAME];
        let length = frame(&mut drives, &mut buffer);
        assert_eq!(length, sent.len());
        assert_eq!(buffer[12..length], sent[12..]);
        buffer[length - 2] = 1;
        drives.send(&buffer[..length]).unwrap();
        let length = frame(&mut master, &mut buffer);
        assert_eq!(buffer[6..12], [0x12, 0x10, 0x10, 0x10, 0x10, 0x10]);
        assert_eq!((buffer[length - 2], length), (1, sent.len()));
    }

    #[test]
    fn an_address_in_use_is_told_with_a_remedy() {
        let first = UdpLink::serve(([127, 0, 0, 1], 0).into()).unwrap();
        let error = UdpLink::serve(first.address().unwrap()).unwrap_err().to_string();
        assert!(error.contains("--udp ADDRESS:PORT"), "{error}");
        let error = UdpLink::serve(([192, 0, 2, 1], 0).into()).unwrap_err().to_string();
        assert!(error.contains("no address of this computer"), "{error}");
    }

    #[test]
    fn a_missing_partner_is_silence_and_no_error() {
        let (mut master, drives) = pair();
        drop(drives);
        for _ in 0..3 {
            master.send(&[0; 60]).unwrap();
            assert_eq!(
                master.receive(&mut [0; MAX_FRAME], Duration::from_millis(1)).unwrap(),
                Received::Timeout
            );
        }
    }
}
