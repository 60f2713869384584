//! A line of chips, through which a frame passes from the first to the last and back.

use wire::Nanos;
use wire::frame::{Layout, SOURCE_ADDRESS};

use crate::chip::{Chip, Pass};

/// Time a chip takes to process or to forward a frame, in ns. Masters assume that both are the same.
pub const PROCESSING_DELAY_NS: u64 = 300;
/// Time a frame takes along the cable between two chips, in ns.
pub const WIRE_DELAY_NS: u64 = 20;

/// Set in the source address of every frame that a slave has processed: "locally administered". By it a master tells its own frames
/// from those that come back.
const PROCESSED_SOURCE: u8 = 0x02;

/// What became of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Processed {
    /// Processed by every chip; goes back to the master.
    Returned,
    /// EtherCAT, but of broken structure or of a type that slaves do not process. The chips have counted an error and taken over no
    /// register writes; it goes back to the master all the same.
    Malformed,
    /// Not EtherCAT: left as it was, and not to be sent back.
    NotEtherCat,
}

/// A line of chips with the master at port 0 of the first; each chip's port 1 leads to the next.
///
/// `S` holds the chips or whatever has one: a `Vec`, an array or a mutable slice of things that give out their [`Chip`].
#[derive(Clone, Debug)]
pub struct Segment<S> {
    drives: S,
}

impl<S> Segment<S> {
    /// Cables the line: links up at port 0 of every chip, and at port 1 of every chip but the last.
    pub fn new<C>(mut drives: S) -> Self
    where
        S: AsMut<[C]>,
        C: AsMut<Chip>,
    {
        let chips = drives.as_mut();
        let count = chips.len();
        for (position, drive) in chips.iter_mut().enumerate() {
            drive.as_mut().set_link(0, true);
            drive.as_mut().set_link(1, position + 1 < count);
        }
        Self { drives }
    }

    /// Lets a frame, whose first byte arrived at `now`, pass through the line. It is changed in place and keeps its length.
    pub fn process<C>(&mut self, frame: &mut [u8], now: Nanos) -> Processed
    where
        S: AsMut<[C]>,
        C: AsMut<Chip>,
    {
        let Some(layout) = Layout::of(frame) else {
            return Processed::NotEtherCat;
        };
        let intact = layout.is_intact(frame);
        let drives = self.drives.as_mut();
        let hop = PROCESSING_DELAY_NS + WIRE_DELAY_NS;
        let mut arrival = now.0;
        let mut beyond = drives.len() as u64;
        for drive in drives.iter_mut() {
            beyond -= 1;
            let pass = Pass {
                entered: now,
                arrival: Nanos(arrival),
                returned: Nanos(arrival.saturating_add(2 * beyond * hop)),
            };
            drive.as_mut().pass_frame(frame, &layout, intact, pass);
            arrival = arrival.saturating_add(hop);
        }
        if !drives.is_empty() {
            frame[SOURCE_ADDRESS] |= PROCESSED_SOURCE;
        }
        if intact { Processed::Returned } else { Processed::Malformed }
    }

    /// The drives, from the master's end.
    pub fn drives(&self) -> &S {
        &self.drives
    }

    /// The drives, from the master's end.
    pub fn drives_mut(&mut self) -> &mut S {
        &mut self.drives
    }
}
