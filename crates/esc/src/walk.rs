//! The way of one frame: port by port through the chips that are plugged together (ESC data sheet, section I, 3.2).
//!
//! Inside a chip a frame goes from port 0 through the processing unit to ports 3, 1, 2 and back to 0; it leaves where a loop is open and
//! comes back in there. So every way into a chip leads to exactly one way out, no way is taken twice, and a frame comes out at a master or
//! is lost after four steps a chip at the most, however the cables run.

use wire::Nanos;
use wire::frame::Layout;

use crate::chip::{Chip, Pass};
use crate::ports::PORTS;
use crate::segment::{End, Side};

/// Time a chip takes to process or to forward a frame, in ns. Masters assume that both are the same.
pub const PROCESSING_DELAY_NS: u64 = 300;
/// Time a frame takes along the cable between two chips, in ns.
pub const WIRE_DELAY_NS: u64 = 20;

/// The port to which a frame goes inside the chip from each.
const NEXT: [usize; PORTS] = [3, 2, 0, 1];
/// Ports that are open in the midst of a line, and at its end.
const MIDST: u8 = 0b0011;
const LAST: u8 = 0b0001;

/// A frame on its way.
pub(crate) struct Journey<'f> {
    pub(crate) frame: &'f mut [u8],
    pub(crate) layout: Layout,
    /// Its structure holds to the end.
    pub(crate) intact: bool,
    /// When it entered the segment.
    pub(crate) entered: Nanos,
    /// Distinguishes it from the frames before it; never 0.
    pub(crate) number: u64,
}

impl Journey<'_> {
    const fn pass(&self, arrival: Nanos) -> Pass {
        Pass {
            entered: self.entered,
            arrival,
            frame: self.number,
        }
    }

    /// Marks every datagram as circulating; whether one was already.
    fn circulate(&mut self) -> bool {
        let mut circulated = false;
        let mut walk = self.layout.walk();
        while let Some(mut datagram) = walk.next_mut(self.frame) {
            circulated |= datagram.is_circulating();
            datagram.set_circulating();
        }
        circulated
    }
}

const fn one_hop_after(time: Nanos) -> Nanos {
    Nanos(time.0.saturating_add(PROCESSING_DELAY_NS + WIRE_DELAY_NS))
}

/// Follows a frame from the end of a cable, reached at `arrival`; the master's side where it comes out, if it does.
pub(crate) fn follow<C: AsMut<Chip>>(drives: &mut [C], from: End, arrival: Nanos, journey: &mut Journey) -> Option<Side> {
    let mut end = from;
    let mut time = arrival;
    for _ in 0..=PORTS * drives.len() {
        let (position, port) = match end {
            End::Master(side) => return Some(side),
            End::Port { position, port } => (position, port),
        };
        let chip = drives.get_mut(position)?.as_mut();
        let out = chip.route(port, time, journey)?;
        end = chip.ports.peers[out].filter(|_| chip.ports.has_link(out))?;
        time = one_hop_after(time);
    }
    None
}

/// Follows a frame along `drives` that are plugged into each other as a line, which is what [`follow`] does, but faster: the way
/// back is gone only if somebody wants to know when the frame came by.
pub(crate) fn follow_line<C: AsMut<Chip>>(drives: &mut [C], length: usize, journey: &mut Journey) -> Option<Side> {
    let mut time = journey.entered;
    let mut latched = false;
    for position in 0..length {
        let chip = drives.get_mut(position)?.as_mut();
        if !chip.ports.are(if position + 1 < length { MIDST } else { LAST }) {
            return follow(drives, End::Port { position, port: 0 }, time, journey);
        }
        let pass = journey.pass(time);
        chip.pass_frame(journey, pass);
        latched |= chip.ports.latched(journey.number);
        time = one_hop_after(time);
    }
    if latched && length > 1 {
        let back = End::Port {
            position: length - 2,
            port: 1,
        };
        return follow(drives, back, time, journey);
    }
    Some(Side::Primary)
}

impl Chip {
    /// Takes a frame in at `port` and lets it through to the port where it leaves, if it does.
    fn route(&mut self, port: usize, arrival: Nanos, journey: &mut Journey) -> Option<usize> {
        self.begin_frame(journey.number, journey.entered);
        if !self.ports.takes_in(port) {
            self.refuse_frame(port);
            return None;
        }
        self.note_arrival(port, arrival);
        let open = self.ports.passable();
        let mut at = port;
        for _ in 0..=PORTS {
            if at == 0 {
                let circulates = port != 0 && self.ports.is_upstream_lost();
                if circulates && journey.circulate() {
                    return None;
                }
                let pass = journey.pass(arrival);
                self.pass_frame(journey, pass);
            }
            at = NEXT[at];
            if open >> at & 1 != 0 {
                return Some(at);
            }
        }
        None
    }
}
