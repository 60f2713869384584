//! Chips and the cables between them, through which a frame passes.

use core::fmt;

use wire::Nanos;
use wire::frame::Layout;

use crate::chip::Chip;
use crate::walk::{Journey, follow, follow_line};
pub use crate::walk::{PROCESSING_DELAY_NS, WIRE_DELAY_NS};

/// One of the master's two network cards.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Side {
    /// The one that leads a line, and a ring from its beginning.
    Primary,
    /// The one at a ring's other end.
    Secondary,
}

/// One end of a cable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum End {
    /// In a network card of the master.
    Master(Side),
    /// In a chip's port.
    Port {
        /// Which of the segment's drives, counted from 0.
        position: usize,
        /// 0 to 3.
        port: usize,
    },
}

/// Why a cable cannot be plugged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CannotConnect {
    /// There is no such drive, or it has no such port.
    NoSuchPort(End),
    /// Another cable is plugged there.
    Occupied(End),
    /// Both ends are the same.
    SameEnd,
}

impl fmt::Display for CannotConnect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoSuchPort(end) => write!(f, "there is no {end:?}"),
            Self::Occupied(end) => write!(f, "{end:?} has a cable"),
            Self::SameEnd => write!(f, "a cable has two ends"),
        }
    }
}

impl core::error::Error for CannotConnect {}

/// What became of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Processed {
    /// Whole; goes back to the master.
    Returned,
    /// EtherCAT, but of broken structure or of a type that slaves do not process. The chips have counted an error and taken over no
    /// register writes; it goes back to the master all the same.
    Malformed,
    /// Never comes back: its way ended at a port without a cable, at a closed loop or at the circulating bit.
    Lost,
    /// Not EtherCAT: left as it was, and not to be sent back.
    NotEtherCat,
}

/// Chips plugged together.
///
/// A new segment is a line. Cables can be unplugged and plugged while frames run, for branches, for a ring with two network cards of the
/// master, for broken cables and for drives that come and go. Loops open at once where a real chip takes some milliseconds.
///
/// `S` holds the chips or whatever has one: a `Vec`, an array or a mutable slice of things that give out their [`Chip`]. A chip
/// keeps its cables when its drive is power cycled; one put in another's place comes without.
#[derive(Clone, Debug)]
pub struct Segment<S> {
    drives: S,
    masters: [Option<End>; 2],
    /// How many drives follow each other as a line from the primary card on.
    line: usize,
    frames: u64,
}

impl<S> Segment<S> {
    /// Cables a line: the primary card to port 0 of the first chip, each chip's port 1 to port 0 of the next.
    pub fn new<C>(drives: S) -> Self
    where
        S: AsMut<[C]>,
        C: AsMut<Chip>,
    {
        let mut segment = Self {
            drives,
            masters: [None; 2],
            line: 0,
            frames: 0,
        };
        let mut upstream = End::Master(Side::Primary);
        for position in 0..segment.drives.as_mut().len() {
            segment.join(upstream, End::Port { position, port: 0 });
            upstream = End::Port { position, port: 1 };
        }
        segment.line = segment.line_length();
        segment
    }

    /// Plugs a cable: from then on there is a link at both ends.
    ///
    /// # Errors
    /// An end does not exist or is taken. Nothing has changed then.
    pub fn connect<C>(&mut self, one: End, other: End) -> Result<(), CannotConnect>
    where
        S: AsMut<[C]>,
        C: AsMut<Chip>,
    {
        if one == other {
            return Err(CannotConnect::SameEnd);
        }
        for end in [one, other] {
            let slot = self.slot(end).ok_or(CannotConnect::NoSuchPort(end))?;
            if slot.is_some() {
                return Err(CannotConnect::Occupied(end));
            }
        }
        self.join(one, other);
        self.line = self.line_length();
        Ok(())
    }

    /// Unplugs, or breaks, the cable that ends here; the link is lost at both ends. Returns the other end, if there was a cable.
    pub fn disconnect<C>(&mut self, end: End) -> Option<End>
    where
        S: AsMut<[C]>,
        C: AsMut<Chip>,
    {
        let other = self.connected(end)?;
        self.plug(end, None);
        // A chip put in another's place does not know of this cable.
        if self.slot(other) == Some(Some(end)) {
            self.plug(other, None);
        }
        self.line = self.line_length();
        Some(other)
    }

    /// Where the cable that is plugged in here ends.
    pub fn connected<C>(&mut self, end: End) -> Option<End>
    where
        S: AsMut<[C]>,
        C: AsMut<Chip>,
    {
        self.slot(end)?
    }

    /// Lets a frame pass, whose first byte arrived at `now` from the primary card and which must come out there again; one that leaves
    /// elsewhere is lost. It is changed in place and keeps its length.
    pub fn process<C>(&mut self, frame: &mut [u8], now: Nanos) -> Processed
    where
        S: AsMut<[C]>,
        C: AsMut<Chip>,
    {
        match self.process_from(Side::Primary, frame, now) {
            (_, Some(Side::Secondary)) => Processed::Lost,
            (processed, _) => processed,
        }
    }

    /// Lets a frame pass, whose first byte arrived at `now` from a card of the master. Tells also at which card it comes out; at
    /// none if it is lost or no EtherCAT.
    pub fn process_from<C>(&mut self, side: Side, frame: &mut [u8], now: Nanos) -> (Processed, Option<Side>)
    where
        S: AsMut<[C]>,
        C: AsMut<Chip>,
    {
        let Some(layout) = Layout::of(frame) else {
            return (Processed::NotEtherCat, None);
        };
        let intact = layout.is_intact(frame);
        // Number 0 is that of no frame.
        self.frames = self.frames.wrapping_add(1).max(1);
        let mut journey = Journey {
            frame,
            layout,
            intact,
            entered: now,
            number: self.frames,
        };
        let drives = self.drives.as_mut();
        let exit = if drives.is_empty() {
            Some(side)
        } else if side == Side::Primary && self.line != 0 {
            follow_line(drives, self.line, &mut journey)
        } else {
            self.masters[side as usize].and_then(|first| follow(drives, first, now, &mut journey))
        };
        let processed = match (exit, intact) {
            (None, _) => Processed::Lost,
            (Some(_), true) => Processed::Returned,
            (Some(_), false) => Processed::Malformed,
        };
        (processed, exit)
    }

    /// The drives.
    pub fn drives(&self) -> &S {
        &self.drives
    }

    /// The drives. More may be added; they come without cables.
    pub fn drives_mut(&mut self) -> &mut S {
        &mut self.drives
    }

    /// What is plugged in at an end, if there is such an end.
    fn slot<C>(&mut self, end: End) -> Option<Option<End>>
    where
        S: AsMut<[C]>,
        C: AsMut<Chip>,
    {
        match end {
            End::Master(side) => Some(self.masters[side as usize]),
            End::Port { position, port } => {
                let ports = &self.drives.as_mut().get_mut(position)?.as_mut().ports;
                ports.peers[..ports.count()].get(port).copied()
            }
        }
    }

    fn join<C>(&mut self, one: End, other: End)
    where
        S: AsMut<[C]>,
        C: AsMut<Chip>,
    {
        self.plug(one, Some(other));
        self.plug(other, Some(one));
    }

    fn plug<C>(&mut self, end: End, other: Option<End>)
    where
        S: AsMut<[C]>,
        C: AsMut<Chip>,
    {
        match end {
            End::Master(side) => self.masters[side as usize] = other,
            End::Port { position, port } => {
                if let Some(drive) = self.drives.as_mut().get_mut(position) {
                    let chip = drive.as_mut();
                    chip.ports.peers[port] = other;
                    chip.set_link(port, other.is_some());
                }
            }
        }
    }

    fn line_length<C>(&mut self) -> usize
    where
        S: AsMut<[C]>,
        C: AsMut<Chip>,
    {
        let mut next = self.masters[Side::Primary as usize];
        let mut length = 0;
        for (position, drive) in self.drives.as_mut().iter_mut().enumerate() {
            if next != Some(End::Port { position, port: 0 }) {
                break;
            }
            next = drive.as_mut().ports.peers[1];
            length = position + 1;
        }
        length
    }
}
