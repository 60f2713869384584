//! Serving a segment to whatever master is at the other end of a link, or of two.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Receiver;
use std::time::{Duration, SystemTime};

use esc::Side;
use wire::Nanos;

use crate::clock::Clock;
use crate::control::Request;
use crate::link::cards::Cards;
use crate::link::pcap::{Direction, Recorder};
use crate::link::{LinkError, MAX_FRAME, Received};
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
    /// Frames that were not EtherCAT, or got lost on their way.
    pub ignored: u64,
}

/// What takes part in serving besides drives and links.
#[derive(Default)]
pub struct Attendants<'a> {
    /// Gets every frame: on its first interface those of the primary card, on its second those of the secondary.
    ///
    /// Time stamps are the time of day, taken from the drives' own clock: a frame's is the instant at which it reached them, an answer's the
    /// instant up to which they were simulated behind it. Replayed at these instants, new drives give the same answers.
    pub recorder: Option<&'a mut Recorder>,
    /// Where orders to the cables come from. They are carried out between two frames, within 10 ms.
    pub requests: Option<&'a Receiver<Request>>,
}

/// Answers frames until `stop` is set.
///
/// A frame is answered first; the simulation catches up behind it, and once more shortly before the next frame is expected. Where an
/// interface goes down, its drive has no link until it is up again. `observe` is called a few times a second.
///
/// # Errors
/// A link is of no more use.
pub fn serve(
    cards: &mut (impl Cards + ?Sized),
    segment: &mut VirtualSegment,
    stop: &AtomicBool,
    observe: impl FnMut(&VirtualSegment, Traffic),
) -> Result<(), LinkError> {
    serve_attended(cards, segment, Attendants::default(), stop, observe)
}

/// Like [`serve`], with a recording of every frame or orders from outside.
///
/// # Errors
/// A link is of no more use.
pub fn serve_attended(
    cards: &mut (impl Cards + ?Sized),
    segment: &mut VirtualSegment,
    mut attendants: Attendants<'_>,
    stop: &AtomicBool,
    mut observe: impl FnMut(&VirtualSegment, Traffic),
) -> Result<(), LinkError> {
    let clock = Clock::real_time();
    let switched_on = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    let mut traffic = Traffic::default();
    let mut observed = Nanos(0);
    let (mut buffer, mut asked) = ([0; MAX_FRAME], [0; MAX_FRAME]);
    while !stop.load(Ordering::Relaxed) {
        let (side, received) = cards.receive_any(&mut buffer, IDLE_STEP)?;
        let arrived = clock.now();
        let mut exit = None;
        match received {
            Received::Frame(length) => {
                if attendants.recorder.is_some() {
                    asked[..length].copy_from_slice(&buffer[..length]);
                }
                exit = answer(cards, segment, side, &mut buffer[..length], arrived, &mut traffic)?;
            }
            Received::Soon | Received::Timeout => {}
            Received::Down => segment.set_interface(side, false),
            Received::Up => segment.set_interface(side, true),
        }
        let now = clock.now();
        segment.catch_up(now);
        if let (Received::Frame(length), Some(recorder)) = (received, &mut attendants.recorder) {
            let time_of_day = |instant: Nanos| switched_on + Duration::from_nanos(instant.0);
            recorder.record_on(side as u32, time_of_day(arrived), Direction::Inbound, &asked[..length]);
            if let Some(exit) = exit {
                recorder.record_on(exit as u32, time_of_day(now), Direction::Outbound, &buffer[..length]);
            }
        }
        if let Some(request) = attendants.requests.and_then(|requests| requests.try_recv().ok()) {
            request.carry_out(segment);
        }
        if now.since(observed) >= OBSERVE_INTERVAL.0 {
            observed = now;
            observe(segment, traffic);
        }
    }
    observe(segment, traffic);
    Ok(())
}

/// Lets a frame go its way through the drives and sends it on where it comes out. Returns where that is.
fn answer(
    cards: &mut (impl Cards + ?Sized),
    segment: &mut VirtualSegment,
    side: Side,
    frame: &mut [u8],
    now: Nanos,
    traffic: &mut Traffic,
) -> Result<Option<Side>, LinkError> {
    let exit = segment.process_from(side, frame, now);
    if let Some(exit) = exit {
        traffic.answered += 1;
        cards.send_to(exit, frame)?;
    } else {
        traffic.ignored += 1;
    }
    Ok(exit)
}

#[cfg(test)]
mod tests {
    use std::collections::VecDeque;
    use std::sync::mpsc::{SyncSender, sync_channel};

    use super::*;
    use crate::drive::DriveConfig;
    use crate::link::pcap::read_pcapng;

    use Event::{Down, Frame, Order, Up};
    use Side::{Primary, Secondary};

    /// What happens at the wires.
    #[derive(Clone, Copy)]
    enum Event {
        /// A frame of the master: BRD of one byte.
        Frame(Side),
        Down(Side),
        Up(Side),
        Order(&'static str),
    }

    /// Plays events, and keeps what comes out: where, and with which working counter.
    struct Wires<'a> {
        events: VecDeque<Event>,
        orders: SyncSender<Request>,
        stop: &'a AtomicBool,
        sent: Vec<(Side, u8)>,
    }

    fn count_slaves() -> [u8; 60] {
        let mut frame = [0; 60];
        frame[12..16].copy_from_slice(&[0x88, 0xA4, 13, 0x10]);
        (frame[16], frame[22]) = (7, 1);
        frame
    }

    impl Cards for Wires<'_> {
        fn send_to(&mut self, side: Side, frame: &[u8]) -> Result<(), LinkError> {
            self.sent.push((side, frame[27]));
            Ok(())
        }

        fn receive_any(&mut self, buffer: &mut [u8], _wait: Duration) -> Result<(Side, Received), LinkError> {
            Ok(match self.events.pop_front() {
                Some(Frame(side)) => {
                    buffer[..60].copy_from_slice(&count_slaves());
                    (side, Received::Frame(60))
                }
                Some(Down(side)) => (side, Received::Down),
                Some(Up(side)) => (side, Received::Up),
                Some(Order(text)) => {
                    let order = text.parse().expect("an order");
                    self.orders.send(Request::new(order, sync_channel(1).0)).expect("a server");
                    (Primary, Received::Timeout)
                }
                None => {
                    self.stop.store(true, Ordering::Relaxed);
                    (Primary, Received::Timeout)
                }
            })
        }
    }

    /// What comes out when this happens to a segment.
    fn play(segment: &mut VirtualSegment, events: &[Event], recorder: Option<&mut Recorder>) -> Vec<(Side, u8)> {
        let stop = AtomicBool::new(false);
        let (orders, requests) = sync_channel(1);
        let mut wires = Wires {
            events: events.iter().copied().collect(),
            orders,
            stop: &stop,
            sent: Vec::new(),
        };
        let attendants = Attendants {
            recorder,
            requests: Some(&requests),
        };
        serve_attended(&mut wires, segment, attendants, &stop, |_, _| ()).expect("these wires do not fail");
        wires.sent
    }

    /// A frame of each card.
    const BOTH: [Event; 2] = [Frame(Primary), Frame(Secondary)];

    #[test]
    fn frames_leave_a_ring_where_its_cables_lead_them() {
        let mut segment = VirtualSegment::ring((0..3).map(DriveConfig::numbered));
        let whole = &[(Secondary, 3), (Primary, 0)][..];
        for (event, sent) in [
            (Order("list"), whole),
            (Order("cut 2"), &[(Primary, 1), (Secondary, 2)]),
            (Order("repair 2"), whole),
            (Order("unplug 2"), &[(Primary, 1), (Secondary, 1)]),
            (Order("cut 3"), &[(Primary, 1), (Secondary, 1)]),
            (Order("plug 2"), &[(Primary, 2), (Secondary, 1)]),
            (Order("repair 3"), whole),
            (Order("cut 9"), whole),
            (Down(Secondary), &[(Primary, 3)]),
            (Down(Primary), &[]),
            (Up(Secondary), &[(Secondary, 3)]),
            (Order("cut 4"), &[]),
            (Up(Primary), &[(Primary, 3)]),
            (Order("repair 4"), whole),
        ] {
            assert_eq!(
                play(&mut segment, &[&[event], &BOTH[..]].concat(), None),
                sent,
                "after {}",
                name(event)
            );
        }
    }

    fn name(event: Event) -> String {
        match event {
            Frame(side) => format!("a frame of {side:?}"),
            Down(side) => format!("{side:?} down"),
            Up(side) => format!("{side:?} up"),
            Order(text) => text.into(),
        }
    }

    #[test]
    fn a_cut_line_ends_before_the_cut() {
        let mut segment = VirtualSegment::of(3);
        let events = [
            Order("cut 3"),
            Frame(Primary),
            Order("cut 1"),
            Frame(Primary),
            Order("repair 1"),
            Frame(Primary),
        ];
        assert_eq!(play(&mut segment, &events, None), [(Primary, 2), (Primary, 2)]);
    }

    #[test]
    fn a_recording_keeps_the_cards_apart() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("ring.pcapng");
        let mut recorder = Recorder::create(&file, "one").unwrap().with_interface("other").unwrap();
        let mut segment = VirtualSegment::ring([DriveConfig::numbered(0)]);
        let events = [&BOTH[..], &[Order("cut 1")], &BOTH].concat();
        play(&mut segment, &events, Some(&mut recorder));
        recorder.finish().unwrap();
        let packets = read_pcapng(&file).unwrap();
        let seen: Vec<_> = packets
            .iter()
            .map(|packet| (packet.interface, packet.direction.unwrap(), packet.data[27]))
            .collect();
        let (inbound, outbound) = (Direction::Inbound, Direction::Outbound);
        assert_eq!(
            seen,
            [
                (0, inbound, 0),
                (1, outbound, 1),
                (1, inbound, 0),
                (0, outbound, 0),
                (0, inbound, 0),
                (1, inbound, 0),
                (1, outbound, 1),
            ]
        );
    }
}
