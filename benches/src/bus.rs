//! What frames go out on.

use std::time::Duration;

use usr2556e::drive::DriveConfig;
use usr2556e::segment::VirtualSegment;
use wire::Nanos;

/// What a frame spends on a 100 Mbit/s wire at the least.
pub const FRAME_TIME: Nanos = Nanos(6_720);

/// A wire with drives at its other end.
pub trait Bus {
    /// Sends a frame and puts what came back in its place.
    fn exchange(&mut self, frame: &mut [u8]);

    /// Lets time pass.
    fn pause(&mut self, span: Duration);
}

/// Drives in memory; time passes only as the benchmark says.
pub struct Lockstep {
    /// The drives.
    pub segment: VirtualSegment,
    /// The present instant.
    pub now: Nanos,
}

impl Lockstep {
    /// `count` drives just switched on, all clocks the same.
    pub fn new(count: usize) -> Self {
        let drives = (0..count).map(|position| DriveConfig {
            clock_offset_ns: 0,
            ..DriveConfig::numbered(position)
        });
        Self {
            segment: VirtualSegment::new(drives),
            now: Nanos(0),
        }
    }
}

impl Bus for Lockstep {
    fn exchange(&mut self, frame: &mut [u8]) {
        self.now.0 += FRAME_TIME.0;
        assert!(self.segment.process(frame, self.now), "an EtherCAT frame comes back");
        self.segment.catch_up(self.now);
    }

    fn pause(&mut self, span: Duration) {
        self.now = self.now.after(span);
        self.segment.catch_up(self.now);
    }
}
