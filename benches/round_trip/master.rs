//! The master's side: a socket that blocks until its frame is back.

use std::thread;
use std::time::{Duration, Instant};

use benchmarks::bring_up;
use benchmarks::bus::Bus;
use benchmarks::cyclic::{Cycle, Image, has_worked};
use usr2556e::link::raw::{RawLink, Role};
use usr2556e::link::{Link, MAX_FRAME, Received};
use usr2556e::namespace::MASTER_INTERFACE;

/// A frame that is not back by then is lost.
const LOST: Duration = Duration::from_millis(500);

/// When the next frame is sent.
#[derive(Clone, Copy, Debug)]
pub enum Pace {
    /// As soon as the last one is back.
    FlatOut,
    /// At this interval.
    Every(Duration),
}

/// A master with the frames of a cycle.
pub struct Master {
    link: RawLink,
    cycle: Cycle,
}

/// Round trip times of an exchange, and what went wrong.
#[derive(Debug, Default)]
pub struct Times {
    /// Of the frames that came back, in the order in which they were sent.
    pub round_trips: Vec<Duration>,
    /// Frames that did not come back, or came back without having passed the drives in OP.
    pub failed: usize,
}

impl Master {
    /// A master on its end of the cable.
    pub fn open() -> Self {
        // A master's timers are precise as well; 50 us late would be late beyond what links predict.
        let _ = nix::sys::prctl::set_timerslack(1);
        Self {
            link: RawLink::open(MASTER_INTERFACE, Role::Master).expect("an interface of this namespace's own"),
            cycle: Cycle::new(1, Image::Separate, true),
        }
    }

    /// Brings the drive to Operation Enabled.
    pub fn bring_up(&mut self) {
        let mut cycle = self.cycle.clone();
        bring_up::to_op(self, &mut cycle);
        bring_up::enable(self, &mut cycle);
        self.cycle = cycle;
    }

    /// Sends the cyclic frame `count` times, through `drives` drives in OP.
    pub fn exchange(&mut self, pace: Pace, count: usize, drives: u16) -> Times {
        let frame = self.cycle.frames().remove(0);
        let mut times = Times::default();
        let mut buffer = [0; MAX_FRAME];
        let mut due = Instant::now();
        for _ in 0..count {
            if let Pace::Every(interval) = pace {
                due += interval;
                thread::sleep(due.saturating_duration_since(Instant::now()));
            }
            let sent = Instant::now();
            match self.round_trip(&frame, &mut buffer) {
                Some(length) => {
                    times.round_trips.push(sent.elapsed());
                    times.failed += usize::from(!has_worked(&buffer[..length], drives));
                }
                None => times.failed += 1,
            }
        }
        times
    }

    fn round_trip(&mut self, frame: &[u8], buffer: &mut [u8]) -> Option<usize> {
        self.link.send(frame).expect("the cable stays");
        match self.link.receive(buffer, LOST).expect("the cable stays") {
            Received::Frame(length) => Some(length),
            _ => None,
        }
    }
}

impl Bus for Master {
    fn exchange(&mut self, frame: &mut [u8]) {
        let mut buffer = [0; MAX_FRAME];
        let length = self.round_trip(frame, &mut buffer).expect("the drive answers");
        frame.copy_from_slice(&buffer[..length]);
    }

    fn pause(&mut self, span: Duration) {
        thread::sleep(span);
    }
}
