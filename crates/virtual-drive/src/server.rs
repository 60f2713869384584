//! Serving a segment to whatever master is at the other end of a link.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use wire::Nanos;

use crate::clock::Clock;
use crate::link::{Link, LinkError, MAX_FRAME, Received};
use crate::segment::VirtualSegment;

/// How long the simulation may stand still when nothing comes.
const IDLE_STEP: Duration = Duration::from_millis(10);

/// How often the observer is called.
const OBSERVE_INTERVAL: Nanos = Nanos(200_000_000);

/// What has passed so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Frames answered.
    pub answered: u64,
    /// Frames that were not EtherCAT.
    pub ignored: u64,
    /// Whether the interface is on.
    pub up: bool,
}

/// Answers frames until `stop` is set.
///
/// A frame is answered first; the simulation catches up behind it, and once more shortly before the next frame is expected. `observe`
/// is called a few times a second.
///
/// # Errors
/// The link is of no more use.
pub fn serve(
    link: &mut (impl Link + ?Sized),
    segment: &mut VirtualSegment,
    stop: &AtomicBool,
    mut observe: impl FnMut(&VirtualSegment, Traffic),
) -> Result<(), LinkError> {
    let clock = Clock::real_time();
    let mut traffic = Traffic {
        up: true,
        ..Traffic::default()
    };
    let mut observed = Nanos(0);
    let mut buffer = [0; MAX_FRAME];
    while !stop.load(Ordering::Relaxed) {
        match link.receive(&mut buffer, IDLE_STEP)? {
            Received::Frame(length) => answer(link, segment, &mut buffer[..length], clock.now(), &mut traffic)?,
            Received::Soon | Received::Timeout => {}
            Received::Down => traffic.up = false,
            Received::Up => traffic.up = true,
        }
        let now = clock.now();
        segment.catch_up(now);
        if now.since(observed) >= OBSERVE_INTERVAL.0 {
            observed = now;
            observe(segment, traffic);
        }
    }
    observe(segment, traffic);
    Ok(())
}

fn answer(
    link: &mut (impl Link + ?Sized),
    segment: &mut VirtualSegment,
    frame: &mut [u8],
    now: Nanos,
    traffic: &mut Traffic,
) -> Result<(), LinkError> {
    if segment.process(frame, now) {
        traffic.answered += 1;
        link.send(frame)
    } else {
        traffic.ignored += 1;
        Ok(())
    }
}
