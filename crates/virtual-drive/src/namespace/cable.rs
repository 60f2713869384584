//! A virtual cable: a pair of Ethernet interfaces of which each receives what the other sends. Made over netlink, as the `ip` program would,
//! so that no machine needs that program.
use netlink_packet_core::{NLM_F_ACK, NLM_F_CREATE, NLM_F_EXCL, NLM_F_REQUEST, NetlinkMessage, NetlinkPayload};
use netlink_packet_route::RouteNetlinkMessage;
use netlink_packet_route::link::{InfoData, InfoKind, InfoVeth, LinkAttribute, LinkFlags, LinkInfo, LinkMessage};
use netlink_sys::protocols::NETLINK_ROUTE;
use netlink_sys::{Socket, SocketAddr};
use nix::ifaddrs::getifaddrs;
use nix::net::if_::{InterfaceFlags, if_nametoindex};
use std::fs;
use std::io;
use std::time::{Duration, Instant};

/// The answer to one request, which is short: an error number and the request's header, or both with the request behind them.
const ANSWER: usize = 8192;

/// The kernel defers some news about interfaces by up to a second.
const CARRIER_PATIENCE: Duration = Duration::from_secs(2);

/// Makes the pair and brings both ends and `lo` up. The error names the step that failed, to complete "could not ...".
pub(super) fn lay(one: &str, other: &str) -> Result<(), (&'static str, io::Error)> {
    let mut socket = connect().map_err(|error| ("talk to the kernel about network interfaces", error))?;
    request(&mut socket, new_pair(one, other), NLM_F_CREATE | NLM_F_EXCL).map_err(|error| ("make a virtual cable (veth)", error))?;
    for end in [one, other] {
        // Without this, the kernel looks for routers and neighbours on a wire that belongs to EtherCAT. No IPv6, no such file.
        let _ = fs::write(format!("/proc/sys/net/ipv6/conf/{end}/disable_ipv6"), "1");
    }
    for interface in [one, other, "lo"] {
        switch_on(&mut socket, interface).map_err(|error| ("switch a network interface on", error))?;
    }
    await_carrier(one, other);
    Ok(())
}

/// The kernel connects the ends to their queues a moment after it answered, and loses what is sent before. Who needs to know that the cable works
/// finds out by using it, so this gives up without an error.
fn await_carrier(one: &str, other: &str) {
    let deadline = Instant::now() + CARRIER_PATIENCE;
    while Instant::now() < deadline {
        let Ok(addresses) = getifaddrs() else { return };
        let running = addresses
            .filter(|address| address.flags.contains(InterfaceFlags::IFF_RUNNING))
            .map(|address| address.interface_name);
        let running: Vec<String> = running.collect();
        if [one, other].iter().all(|end| running.iter().any(|name| name == end)) {
            return;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn connect() -> io::Result<Socket> {
    let mut socket = Socket::new(NETLINK_ROUTE)?;
    socket.bind_auto()?;
    socket.connect(&SocketAddr::new(0, 0))?;
    Ok(socket)
}

fn new_pair(one: &str, other: &str) -> RouteNetlinkMessage {
    let mut peer = LinkMessage::default();
    peer.attributes.push(LinkAttribute::IfName(other.into()));
    let mut link = LinkMessage::default();
    link.attributes.push(LinkAttribute::IfName(one.into()));
    let kind = vec![LinkInfo::Kind(InfoKind::Veth), LinkInfo::Data(InfoData::Veth(InfoVeth::Peer(peer)))];
    link.attributes.push(LinkAttribute::LinkInfo(kind));
    RouteNetlinkMessage::NewLink(link)
}

fn switch_on(socket: &mut Socket, interface: &str) -> io::Result<()> {
    let mut link = LinkMessage::default();
    link.header.index = if_nametoindex(interface)?;
    link.header.flags = LinkFlags::Up;
    link.header.change_mask = LinkFlags::Up;
    request(socket, RouteNetlinkMessage::SetLink(link), 0)
}

/// Asks for one thing and waits for the answer.
fn request(socket: &mut Socket, message: RouteNetlinkMessage, flags: u16) -> io::Result<()> {
    let mut message = NetlinkMessage::from(message);
    message.header.flags = NLM_F_REQUEST | NLM_F_ACK | flags;
    message.finalize();
    let mut request = vec![0; message.buffer_len()];
    message.serialize(&mut request);
    socket.send(&request, 0)?;

    let mut answer = Vec::with_capacity(ANSWER);
    socket.recv(&mut answer, 0)?;
    let answer = NetlinkMessage::<RouteNetlinkMessage>::deserialize(&answer).map_err(|error| io::Error::other(error.to_string()))?;
    match answer.payload {
        NetlinkPayload::Error(answer) if answer.code.is_none() => Ok(()),
        NetlinkPayload::Error(answer) => Err(answer.to_io()),
        other => Err(io::Error::other(format!("unexpected answer from the kernel: {other:?}"))),
    }
}
