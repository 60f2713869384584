//! The system calls of a packet socket that no safe crate offers: `bind` to an interface and the `PACKET_*` options.
//!
//! Invariants that the unsafe blocks rely on:
//! - Every pointer handed to the kernel points to a live local of exactly the type that the call documents, together with its own size.
//!   The kernel only reads through them and keeps none of them.
//! - A descriptor becomes an [`OwnedFd`] in the same expression that checks it, so that it is closed exactly once on every path.
//! - `sockaddr_ll` and `packet_mreq` are plain integers and arrays of integers, for which all bytes zero is a valid value.
#![allow(unsafe_code)]

use std::ffi::c_int;
use std::io;
use std::mem;
use std::os::fd::{AsRawFd, FromRawFd, OwnedFd};

/// A packet socket that gets the frames with this EtherType that arrive on interface number `index`, whoever they are addressed to.
///
/// The error names the step that failed, to complete "could not ...".
pub(super) fn packet_socket(index: u32, ethertype: u16) -> Result<OwnedFd, (&'static str, io::Error)> {
    let index = c_int::try_from(index).map_err(|_| ("address it", io::Error::from(io::ErrorKind::InvalidInput)))?;
    let socket = silent_socket().map_err(|error| ("open a packet socket", error))?;
    // Past the queueing discipline: nothing may hold a frame of a bus back. Outgoing frames never come back to a socket that is bound to one
    // protocol, but that is the kernel's present practice; the option makes it a promise where the kernel (4.20) knows it.
    set_option(&socket, libc::PACKET_QDISC_BYPASS, &1_i32).map_err(|error| ("bypass the queueing discipline", error))?;
    let _ = set_option(&socket, libc::PACKET_IGNORE_OUTGOING, &1_i32);
    // Masters address their frames to everyone or to no one; a real interface lets only the former through.
    let membership = libc::packet_mreq {
        mr_ifindex: index,
        mr_type: libc::PACKET_MR_PROMISC as u16,
        mr_alen: 0,
        mr_address: [0; 8],
    };
    set_option(&socket, libc::PACKET_ADD_MEMBERSHIP, &membership).map_err(|error| ("receive frames for any address", error))?;
    bind(&socket, index, ethertype).map_err(|error| ("listen", error))?;
    Ok(socket)
}

/// A packet socket that gets nothing until it is bound, so that no other interface's frames are in its queue.
fn silent_socket() -> io::Result<OwnedFd> {
    // SAFETY: takes no pointers; a descriptor that is not negative is new and ours.
    unsafe {
        match libc::socket(libc::AF_PACKET, libc::SOCK_RAW | libc::SOCK_CLOEXEC | libc::SOCK_NONBLOCK, 0) {
            descriptor if descriptor >= 0 => Ok(OwnedFd::from_raw_fd(descriptor)),
            _ => Err(io::Error::last_os_error()),
        }
    }
}

fn set_option<T>(socket: &OwnedFd, option: c_int, value: &T) -> io::Result<()> {
    // SAFETY: pointer and size are those of one live value.
    let result = unsafe {
        libc::setsockopt(
            socket.as_raw_fd(),
            libc::SOL_PACKET,
            option,
            std::ptr::from_ref(value).cast(),
            size_of::<T>() as libc::socklen_t,
        )
    };
    if result == 0 { Ok(()) } else { Err(io::Error::last_os_error()) }
}

fn bind(socket: &OwnedFd, index: c_int, ethertype: u16) -> io::Result<()> {
    // SAFETY: see the invariant on zeroed address structures.
    let mut address: libc::sockaddr_ll = unsafe { mem::zeroed() };
    address.sll_family = libc::AF_PACKET as u16;
    address.sll_protocol = ethertype.to_be();
    address.sll_ifindex = index;
    // SAFETY: pointer and size are those of one live value.
    let result = unsafe {
        libc::bind(
            socket.as_raw_fd(),
            std::ptr::from_ref(&address).cast(),
            size_of::<libc::sockaddr_ll>() as libc::socklen_t,
        )
    };
    if result == 0 { Ok(()) } else { Err(io::Error::last_os_error()) }
}
