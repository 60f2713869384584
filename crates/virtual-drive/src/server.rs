//! Serving a segment to whatever master is at the other end of a link.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, SystemTime};

use wire::Nanos;

use crate::clock::Clock;
use crate::link::pcap::{Direction, Recorder};
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
    observe: impl FnMut(&VirtualSegment, Traffic),
) -> Result<(), LinkError> {
    serve_recorded(link, segment, None, stop, observe)
}

/// Like [`serve`], with every frame going to `recorder`.
///
/// Time stamps are the time of day, taken from the drives' own clock: a frame's is the instant at which it reached them, an answer's the
/// instant up to which they were simulated behind it. Replayed at these instants, new drives give the same answers.
///
/// # Errors
/// The link is of no more use.
pub fn serve_recorded(
    link: &mut (impl Link + ?Sized),
    segment: &mut VirtualSegment,
    mut recorder: Option<&mut Recorder>,
    stop: &AtomicBool,
    mut observe: impl FnMut(&VirtualSegment, Traffic),
) -> Result<(), LinkError> {
    let clock = Clock::real_time();
    let switched_on = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    let mut traffic = Traffic {
        up: true,
        ..Traffic::default()
    };
    let mut observed = Nanos(0);
    let (mut buffer, mut asked) = ([0; MAX_FRAME], [0; MAX_FRAME]);
    while !stop.load(Ordering::Relaxed) {
        let received = link.receive(&mut buffer, IDLE_STEP)?;
        let arrived = clock.now();
        let mut answered = false;
        match received {
            Received::Frame(length) => {
                if recorder.is_some() {
                    asked[..length].copy_from_slice(&buffer[..length]);
                }
                answered = answer(link, segment, &mut buffer[..length], arrived, &mut traffic)?;
            }
            Received::Soon | Received::Timeout => {}
            Received::Down => traffic.up = false,
            Received::Up => traffic.up = true,
        }
        let now = clock.now();
        segment.catch_up(now);
        if let (Received::Frame(length), Some(recorder)) = (received, &mut recorder) {
            let time_of_day = |instant: Nanos| switched_on + Duration::from_nanos(instant.0);
            recorder.record(time_of_day(arrived), Direction::Inbound, &asked[..length]);
            if answered {
                recorder.record(time_of_day(now), Direction::Outbound, &buffer[..length]);
            }
        }
        if now.since(observed) >= OBSERVE_INTERVAL.0 {
            observed = now;
            observe(segment, traffic);
        }
    }
    observe(segment, traffic);
    Ok(())
}

/// Sends a frame back after its way through the drives. Returns whether it is one that comes back.
fn answer(
    link: &mut (impl Link + ?Sized),
    segment: &mut VirtualSegment,
    frame: &mut [u8],
    now: Nanos,
    traffic: &mut Traffic,
) -> Result<bool, LinkError> {
    let returns = segment.process(frame, now);
    if returns {
        traffic.answered += 1;
        link.send(frame)?;
    } else {
        traffic.ignored += 1;
    }
    Ok(returns)
}
