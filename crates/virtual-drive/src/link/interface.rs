//! What the system tells about a network interface, and whose it is.
use super::open_error::OpenError;
use nix::net::if_::{InterfaceFlags, if_nameindex, if_nametoindex};
use nix::sys::socket::{getsockopt, sockopt::PeerCredentials};
use std::io;
use std::os::linux::net::SocketAddrExt;
use std::os::unix::net::{SocketAddr, UnixListener, UnixStream};

/// What an interface is doing.
pub(super) enum State {
    Gone,
    Down,
    Up { carrier: bool },
}

pub(super) fn state(interface: &str, index: u32) -> State {
    if if_nametoindex(interface) != Ok(index) {
        return State::Gone;
    }
    let Ok(mut addresses) = nix::ifaddrs::getifaddrs() else {
        return State::Gone;
    };
    match addresses.find(|address| address.interface_name == interface) {
        None => State::Gone,
        Some(address) if !address.flags.contains(InterfaceFlags::IFF_UP) => State::Down,
        Some(address) => State::Up {
            // Known at once, while IFF_RUNNING follows up to a second later.
            carrier: address.flags.contains(InterfaceFlags::IFF_LOWER_UP),
        },
    }
}

pub(super) fn existing() -> Vec<String> {
    let Ok(interfaces) = if_nameindex() else { return Vec::new() };
    interfaces
        .iter()
        .map(|interface| interface.name().to_string_lossy().into_owned())
        .collect()
}

/// Makes this process the only drive server on the interface, for as long as the listener lives.
///
/// The claim is a name in the abstract namespace of Unix sockets. That namespace belongs to the network namespace, as the interface's number
/// does, the kernel frees the name however the process ends, and whoever finds it taken can ask by whom.
pub(super) fn claim(interface: &str, index: u32) -> Result<UnixListener, OpenError> {
    let failed = |source| OpenError::System {
        interface: interface.into(),
        doing: "make sure that no other drive server is running",
        source,
    };
    let address = SocketAddr::from_abstract_name(format!("usr2556e drive server on interface {index}")).map_err(failed)?;
    UnixListener::bind_addr(&address).map_err(|error| match error.kind() {
        io::ErrorKind::AddrInUse => {
            let peer = UnixStream::connect_addr(&address)
                .ok()
                .and_then(|stream| getsockopt(&stream, PeerCredentials).ok());
            // Zero stands for a process that cannot be seen from here, in another container.
            let process = peer.map(|peer| peer.pid()).filter(|&process| process > 0);
            OpenError::AlreadyServed {
                interface: interface.into(),
                process,
            }
        }
        _ => failed(error),
    })
}
