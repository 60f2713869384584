//! What masters for tests, fuzzing, simulation and benchmarks share that do nothing by themselves: frames out of datagrams, and the
//! registers by which process data are set up. What frames go out on, what gets lost of them and how long they take is each user's own.

use device::layout::SyncManager;
use wire::frame::{Command, FrameBuilder, Layout};
use wire::register::sync_manager::ACTIVATE_ENABLE;
use wire::register::{FMMU_SIZE, SM_SIZE};

/// Address of the master's network card; a drive sets bit 1 of its first byte.
pub const SOURCE: [u8; 6] = [0x10; 6];

/// Bytes of an Ethernet frame at the most.
pub const MAX_FRAME: usize = 1514;

/// One datagram on its way and back.
#[derive(Clone, Debug)]
pub struct Datagram {
    /// What it does.
    pub command: Command,
    /// Where, as the frame holds it.
    pub address: u32,
    /// What it carries.
    pub data: Vec<u8>,
    /// The working counter that it came back with.
    pub counter: u16,
}

impl Datagram {
    /// A datagram yet to be sent.
    pub const fn new(command: Command, address: u32, data: Vec<u8>) -> Self {
        Self {
            command,
            address,
            data,
            counter: 0,
        }
    }
}

/// Sends datagrams in one frame. `wire` carries it there and back and tells whether it came back; then data and counters are those that
/// came. Returns whether they did.
///
/// # Panics
/// The datagrams do not fit a frame.
pub fn exchange(datagrams: &mut [Datagram], wire: impl FnOnce(&mut [u8]) -> bool) -> bool {
    let mut buffer = [0; MAX_FRAME];
    let mut builder = FrameBuilder::new(&mut buffer, SOURCE).expect("room for a header");
    for datagram in datagrams.iter() {
        let added = builder.datagram(datagram.command, 0, datagram.address, &datagram.data);
        added.expect("datagrams that fit a frame");
    }
    let length = builder.finish();
    let frame = &mut buffer[..length];
    wire(frame) && take(frame, datagrams)
}

/// Puts what came back into the datagrams.
fn take(frame: &[u8], datagrams: &mut [Datagram]) -> bool {
    let Some(mut walk) = Layout::of(frame).map(|layout| layout.walk()) else {
        return false;
    };
    datagrams.iter_mut().all(|datagram| {
        let answer = walk.next(frame);
        if let Some(answer) = &answer {
            datagram.data.copy_from_slice(answer.data());
            datagram.counter = answer.working_counter();
        }
        answer.is_some()
    })
}

/// The registers of an active sync manager.
pub const fn sync_manager(start: u16, length: u16, control: u8) -> [u8; SM_SIZE as usize] {
    let ([s0, s1], [l0, l1]) = (start.to_le_bytes(), length.to_le_bytes());
    [s0, s1, l0, l1, control, 0, ACTIVATE_ENABLE, 0]
}

/// Which way an FMMU copies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From the drive into the frame: inputs.
    Read = 1,
    /// From the frame into the drive: outputs.
    Write = 2,
}

/// The registers of an active FMMU that lays a sync manager's process data at a logical address.
pub fn fmmu(logical: u32, manager: &SyncManager, direction: Direction) -> [u8; FMMU_SIZE as usize] {
    let mut bytes = [0; FMMU_SIZE as usize];
    bytes[..4].copy_from_slice(&logical.to_le_bytes());
    bytes[4..6].copy_from_slice(&manager.length.to_le_bytes());
    // All bits of the last byte.
    bytes[7] = 7;
    bytes[8..10].copy_from_slice(&manager.start.to_le_bytes());
    bytes[11] = direction as u8;
    bytes[12] = 1;
    bytes
}
