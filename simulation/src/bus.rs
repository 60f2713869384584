//! The wire between master and drive, and the time that passes on it.

use board::TICK;
use usr2556e::cables::Change;
use usr2556e::drive::{DriveConfig, VirtualDrive};
use usr2556e::segment::VirtualSegment;
use wire::Nanos;
use wire::frame::{Command, FrameBuilder};

/// Bytes in front of the first datagram: Ethernet and EtherCAT header.
const FRAME_HEADER: usize = 14 + 2;
const DATAGRAM_HEADER: usize = 10;
/// The only cable.
const CABLE: usize = 1;

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
    pub fn new(command: Command, address: u32, data: Vec<u8>) -> Self {
        Self {
            command,
            address,
            data,
            counter: 0,
        }
    }
}

/// One drive at the end of one cable.
pub struct Bus {
    segment: VirtualSegment,
    now: Nanos,
    cut: bool,
}

impl Bus {
    /// A new drive, just switched on.
    pub fn new() -> Self {
        Self {
            segment: VirtualSegment::new([DriveConfig::numbered(0)]),
            now: Nanos(0),
            cut: false,
        }
    }

    /// The drive.
    pub fn drive(&self) -> &VirtualDrive {
        &self.segment.drives()[0]
    }

    /// The drive, to lay a hand on it.
    pub fn drive_mut(&mut self) -> &mut VirtualDrive {
        &mut self.segment.drives_mut()[0]
    }

    /// The present instant.
    pub const fn now(&self) -> Nanos {
        self.now
    }

    /// Whether the cable is whole.
    pub const fn is_connected(&self) -> bool {
        !self.cut
    }

    /// Cuts the cable or repairs it.
    pub fn set_connected(&mut self, connected: bool) {
        if connected == self.cut {
            let change = if connected { Change::Repair(CABLE) } else { Change::Cut(CABLE) };
            self.segment.change(change).expect("the cable is there and in the other state");
            self.cut = !connected;
        }
    }

    /// Sends datagrams in one frame, and lets the drive answer what they have brought. Returns whether the frame came back.
    pub fn exchange(&mut self, datagrams: &mut [Datagram]) -> bool {
        let mut buffer = [0; 1514];
        let mut builder = FrameBuilder::new(&mut buffer, [2, 0, 0, 0, 0, 1]).expect("room for a header");
        for datagram in datagrams.iter() {
            builder
                .datagram(datagram.command, 0, datagram.address, &datagram.data)
                .expect("room for the datagrams of this master");
        }
        let length = builder.finish();
        let frame = &mut buffer[..length];
        let returned = self.segment.process(frame, self.now);
        self.segment.catch_up(self.now);
        if returned {
            let mut at = FRAME_HEADER;
            for datagram in datagrams {
                let data = at + DATAGRAM_HEADER;
                let end = data + datagram.data.len();
                datagram.data.copy_from_slice(&frame[data..end]);
                datagram.counter = u16::from_le_bytes([frame[end], frame[end + 1]]);
                at = end + 2;
            }
        }
        returned
    }

    /// Lets a part of a tick pass, so that the next frame comes between two ticks.
    pub fn wait_within_tick(&mut self, nanoseconds: u64) {
        let tick = self.now.0 / TICK.0;
        let later = self.now.0 + nanoseconds;
        if later / TICK.0 == tick {
            self.now = Nanos(later);
        }
    }

    /// Lets time pass up to the end of the next control tick.
    pub fn tick(&mut self) {
        self.now = Nanos((self.now.0 / TICK.0 + 1) * TICK.0);
        self.segment.catch_up(self.now);
    }
}

impl Default for Bus {
    fn default() -> Self {
        Self::new()
    }
}
