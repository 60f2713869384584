//! New drives that get a capture's frames at the capture's instants.

use usr2556e::segment::VirtualSegment;
use wire::frame::Layout;
use wire::{Nanos, register};

use crate::capture::Exchange;

/// How long a serving program lets the simulation stand still at most.
const IDLE_STEP: u64 = 10_000_000;

/// How far the simulation has caught up when a frame comes, which a capture does not tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CaughtUp {
    /// As far as ever possible.
    Fully,
    /// No further than behind the frame before.
    Hardly,
}

/// New drives, switched on at an instant of the capture.
pub struct Rerun {
    segment: VirtualSegment,
    switched_on: u64,
    simulated: u64,
    caught_up: CaughtUp,
}

impl Rerun {
    /// `drives` new drives.
    pub fn new(drives: usize, switched_on: u64, caught_up: CaughtUp) -> Self {
        Self {
            segment: VirtualSegment::of(drives),
            switched_on,
            simulated: 0,
            caught_up,
        }
    }

    /// The drives' answer.
    pub fn answer(&mut self, exchange: &Exchange) -> Vec<u8> {
        let arrived = exchange.arrived - self.switched_on;
        while self.simulated + IDLE_STEP < arrived {
            self.catch_up(self.simulated + IDLE_STEP);
        }
        if self.caught_up == CaughtUp::Fully {
            self.catch_up(arrived);
        }
        let mut frame = exchange.asked.clone();
        assert!(self.segment.process(&mut frame, Nanos(arrived)), "the frame does not come back");
        self.catch_up(exchange.simulated - self.switched_on);
        frame
    }

    fn catch_up(&mut self, instant: u64) {
        self.segment.catch_up(Nanos(instant));
        self.simulated = instant;
    }
}

/// When the drives of a capture were switched on, in ns since the Unix epoch, by the local time at which the first of them received a frame
/// (0x0918): masters read it to set up distributed clocks.
///
/// The time is not simply counted back, as the clock may already have been following a master's; drives that were switched on at the right
/// instant show the right time.
pub fn switched_on(drives: usize, exchanges: &[Exchange]) -> u64 {
    let mut instant = exchanges[0].arrived;
    for _ in 0..10 {
        let mut rerun = Rerun::new(drives, instant, CaughtUp::Fully);
        let times = exchanges.iter().find_map(|exchange| {
            let answer = rerun.answer(exchange);
            Some((receive_time(&exchange.answered)?, receive_time(&answer)?))
        });
        let (recorded, shown) = times.expect("a master that reads the receive time");
        if recorded == shown {
            return instant;
        }
        instant = instant.wrapping_sub(recorded.wrapping_sub(shown));
    }
    panic!("no instant of switching on gives the recorded receive time");
}

/// The answer to reading 0x0918, if that is what the frame is.
fn receive_time(frame: &[u8]) -> Option<u64> {
    let datagram = Layout::of(frame)?.walk().next(frame)?;
    let is_it = datagram.ado() == register::DC_PROCESSING_TIME && datagram.working_counter() == 1;
    is_it.then(|| datagram.data().try_into().map(u64::from_le_bytes).ok()).flatten()
}
