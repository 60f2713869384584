//! The wire between master and drive, and the time that passes on it.

use board::TICK;
use plant::PlantConfig;
use raw_master::Datagram;
use usr2556e::cables::Change;
use usr2556e::drive::{DriveConfig, VirtualDrive};
use usr2556e::segment::VirtualSegment;
use wire::Nanos;

/// The only cable.
const CABLE: usize = 1;

/// One drive at the end of one cable.
pub struct Bus {
    segment: VirtualSegment,
    now: Nanos,
    cut: bool,
}

impl Bus {
    /// A new drive in its machine, just switched on.
    pub fn new(machine: PlantConfig) -> Self {
        let drive = DriveConfig {
            plant: machine,
            ..DriveConfig::numbered(0)
        };
        Self {
            segment: VirtualSegment::new([drive]),
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
        raw_master::exchange(datagrams, |frame| {
            let returned = self.segment.process(frame, self.now);
            self.segment.catch_up(self.now);
            returned
        })
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
