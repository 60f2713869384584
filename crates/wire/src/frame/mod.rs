//! Ethernet frames that carry EtherCAT: finding the EtherCAT part, walking its datagrams in place, and building frames (ETG.1000.4, 5).
//!
//! | module | holds |
//! |---|---|
//! | here | [`Layout`], [`Walk`], [`Datagram`]: frames in place |
//! | [`command`] | what a datagram asks |
//! | [`builder`] | [`FrameBuilder`]: new frames |
//!
//! Nothing is copied: a [`Datagram`] is a view of its bytes in the frame. Lengths and "more follows" bits are claims of the sender, so
//! [`Walk`] hands out only datagrams that lie completely inside the frame, and says afterwards whether the claims held.

pub mod builder;
pub mod command;

use core::ops::Range;

pub use builder::{FrameBuilder, NoRoom};
pub use command::Command;

/// EtherType of EtherCAT.
pub const ETHERTYPE: u16 = 0x88A4;
/// EtherType of an 802.1Q tag.
pub const ETHERTYPE_VLAN: u16 = 0x8100;
/// Bytes of an Ethernet header without a tag.
pub const ETHERNET_HEADER: usize = 14;
/// Offset of the source address in an Ethernet frame.
pub const SOURCE_ADDRESS: usize = 6;
/// Bytes of an 802.1Q tag.
pub const VLAN_TAG: usize = 4;
/// Bytes of the EtherCAT header.
pub const ETHERCAT_HEADER: usize = 2;
/// Bytes of a datagram's header.
pub const DATAGRAM_HEADER: usize = 10;
/// Bytes of a working counter.
pub const WORKING_COUNTER: usize = 2;
/// Greatest length of the datagrams of one frame that the EtherCAT header can state.
pub const MAX_LENGTH: usize = 0x07FF;
/// Type of EtherCAT frame that consists of datagrams.
pub const TYPE_DATAGRAMS: u8 = 1;

const LENGTH_MASK: u16 = 0x07FF;
const CIRCULATING: u16 = 0x4000;
const MORE_FOLLOWS: u16 = 0x8000;

/// The address field of a physical datagram: position or station address `adp`, and offset `ado` in the slave.
pub const fn physical_address(adp: u16, ado: u16) -> u32 {
    adp as u32 | (ado as u32) << 16
}

/// Where the EtherCAT part of a frame is, and what its header says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    header: usize,
    length: usize,
    frame_type: u8,
    available: usize,
}

impl Layout {
    /// Finds the EtherCAT header behind the Ethernet header and at most one 802.1Q tag.
    ///
    /// `None` if the frame is too short for one or carries something else.
    pub fn of(frame: &[u8]) -> Option<Self> {
        let ethertype = |at: usize| frame.get(at..at + 2).map(|bytes| u16::from_be_bytes([bytes[0], bytes[1]]));
        let header = match ethertype(ETHERNET_HEADER - 2)? {
            ETHERTYPE => ETHERNET_HEADER,
            ETHERTYPE_VLAN if ethertype(ETHERNET_HEADER - 2 + VLAN_TAG)? == ETHERTYPE => ETHERNET_HEADER + VLAN_TAG,
            _ => return None,
        };
        let bytes = frame.get(header..header + ETHERCAT_HEADER)?;
        let word = u16::from_le_bytes([bytes[0], bytes[1]]);
        Some(Self {
            header,
            length: usize::from(word & LENGTH_MASK),
            frame_type: (word >> 12) as u8,
            available: frame.len() - header - ETHERCAT_HEADER,
        })
    }

    /// Type of the EtherCAT frame, [`TYPE_DATAGRAMS`] for one that slaves process.
    pub const fn frame_type(&self) -> u8 {
        self.frame_type
    }

    /// Length of all datagrams in bytes, as the header states it.
    pub const fn length(&self) -> usize {
        self.length
    }

    /// Whether the header states more bytes than the frame has.
    pub const fn is_overlong(&self) -> bool {
        self.length > self.available
    }

    /// Starts a walk over the datagrams. There are none if the frame is of another type.
    pub fn walk(&self) -> Walk {
        let first = self.header + ETHERCAT_HEADER;
        let state = if self.frame_type == TYPE_DATAGRAMS {
            State::More
        } else {
            State::Broken
        };
        Walk {
            position: first,
            end: first + self.length.min(self.available),
            state,
        }
    }

    /// Whether the frame is of the type that slaves process and every claim of length holds.
    ///
    /// Bytes behind the last datagram are padding and never looked at.
    pub fn is_intact(&self, frame: &[u8]) -> bool {
        let mut walk = self.walk();
        while walk.next_range(frame).is_some() {}
        walk.state == State::Complete && !self.is_overlong()
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    More,
    Complete,
    Broken,
}

/// A walk over the datagrams of a frame; every step checks that the datagram fits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Walk {
    position: usize,
    end: usize,
    state: State,
}

impl Walk {
    /// The next datagram to look at and change.
    pub fn next_mut<'f>(&mut self, frame: &'f mut [u8]) -> Option<Datagram<&'f mut [u8]>> {
        let range = self.next_range(frame)?;
        frame.get_mut(range).map(Datagram)
    }

    /// The next datagram to look at.
    pub fn next<'f>(&mut self, frame: &'f [u8]) -> Option<Datagram<&'f [u8]>> {
        let range = self.next_range(frame)?;
        frame.get(range).map(Datagram)
    }

    fn next_range(&mut self, frame: &[u8]) -> Option<Range<usize>> {
        if self.state != State::More {
            return None;
        }
        let room = frame.get(self.position..self.end).unwrap_or_default();
        let size = match room.first_chunk::<DATAGRAM_HEADER>() {
            Some(header) => {
                let word = u16::from_le_bytes([header[6], header[7]]);
                self.state = if word & MORE_FOLLOWS == 0 { State::Complete } else { State::More };
                DATAGRAM_HEADER + usize::from(word & LENGTH_MASK) + WORKING_COUNTER
            }
            None => usize::MAX,
        };
        if size > room.len() {
            self.state = State::Broken;
            return None;
        }
        let start = self.position;
        self.position += size;
        Some(start..start + size)
    }
}

/// One datagram in place: header, data and working counter.
///
/// Made by [`Walk`], which checked that the bytes are as many as the header says.
#[derive(Debug)]
pub struct Datagram<T>(T);

impl<T: AsRef<[u8]>> Datagram<T> {
    fn word(&self, at: usize) -> u16 {
        let bytes = self.0.as_ref();
        u16::from_le_bytes([bytes[at], bytes[at + 1]])
    }

    fn counter_at(&self) -> usize {
        self.0.as_ref().len() - WORKING_COUNTER
    }

    /// The command.
    pub fn command(&self) -> Command {
        Command::from(self.0.as_ref()[0])
    }

    /// The index by which the master recognises the datagram.
    pub fn index(&self) -> u8 {
        self.0.as_ref()[1]
    }

    /// Position or station address.
    pub fn adp(&self) -> u16 {
        self.word(2)
    }

    /// Offset in the slave's memory.
    pub fn ado(&self) -> u16 {
        self.word(4)
    }

    /// Logical address.
    pub fn logical_address(&self) -> u32 {
        physical_address(self.adp(), self.ado())
    }

    /// Whether another datagram follows.
    pub fn more_follows(&self) -> bool {
        self.word(6) & MORE_FOLLOWS != 0
    }

    /// Whether the frame has come once into a part of the segment that lost its way to the master.
    pub fn is_circulating(&self) -> bool {
        self.word(6) & CIRCULATING != 0
    }

    /// The ECAT event request of the slaves passed so far.
    pub fn events(&self) -> u16 {
        self.word(8)
    }

    /// The data.
    pub fn data(&self) -> &[u8] {
        &self.0.as_ref()[DATAGRAM_HEADER..self.counter_at()]
    }

    /// The working counter.
    pub fn working_counter(&self) -> u16 {
        self.word(self.counter_at())
    }
}

impl<T: AsRef<[u8]> + AsMut<[u8]>> Datagram<T> {
    fn set_word(&mut self, at: usize, value: u16) {
        self.0.as_mut()[at..at + 2].copy_from_slice(&value.to_le_bytes());
    }

    /// Counts the position on by one slave; it wraps.
    pub fn increment_adp(&mut self) {
        self.set_word(2, self.adp().wrapping_add(1));
    }

    /// Marks the frame as one that has come into a part of the segment that lost its way to the master.
    pub fn set_circulating(&mut self) {
        self.set_word(6, self.word(6) | CIRCULATING);
    }

    /// Adds a slave's events.
    pub fn add_events(&mut self, events: u16) {
        self.set_word(8, self.events() | events);
    }

    /// The data.
    pub fn data_mut(&mut self) -> &mut [u8] {
        let end = self.counter_at();
        &mut self.0.as_mut()[DATAGRAM_HEADER..end]
    }

    /// Adds to the working counter; it wraps.
    pub fn add_working_counter(&mut self, increment: u16) {
        let at = self.counter_at();
        self.set_word(at, self.working_counter().wrapping_add(increment));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOURCE: [u8; 6] = [0x10; 6];

    fn two_datagrams(buffer: &mut [u8], tag: Option<u16>) -> usize {
        let mut builder = match tag {
            Some(tag) => FrameBuilder::tagged(buffer, SOURCE, tag),
            None => FrameBuilder::new(buffer, SOURCE),
        }
        .unwrap();
        builder
            .datagram(Command::Fprd, 7, physical_address(0x1001, 0x0130), &[0; 6])
            .unwrap();
        builder.datagram(Command::Lrw, 8, 0x0001_0203, &[1, 2, 3]).unwrap();
        builder.finish()
    }

    #[test]
    fn a_built_frame_reads_back_with_and_without_a_tag() {
        for tag in [None, Some(0x6001)] {
            let mut buffer = [0xEE; 100];
            let length = two_datagrams(&mut buffer, tag);
            let frame = &buffer[..length];
            let layout = Layout::of(frame).unwrap();
            assert!(layout.is_intact(frame));
            assert_eq!(layout.length(), 18 + 15);

            let mut walk = layout.walk();
            let first = walk.next(frame).unwrap();
            assert_eq!(
                (first.command(), first.index(), first.adp(), first.ado()),
                (Command::Fprd, 7, 0x1001, 0x0130)
            );
            assert!(first.more_follows());
            let second = walk.next(frame).unwrap();
            assert_eq!(
                (second.command(), second.logical_address(), second.data()),
                (Command::Lrw, 0x0001_0203, &[1, 2, 3][..])
            );
            assert!(!second.more_follows());
            assert!(walk.next(frame).is_none());
        }
    }

    #[test]
    fn changes_land_in_the_frame_and_wrap() {
        let mut buffer = [0; 100];
        let length = two_datagrams(&mut buffer, None);
        let frame = &mut buffer[..length];
        let mut walk = Layout::of(frame).unwrap().walk();
        let mut datagram = walk.next_mut(frame).unwrap();
        datagram.add_working_counter(0xFFFF);
        datagram.add_working_counter(3);
        datagram.add_events(0x0004);
        datagram.add_events(0x0008);
        datagram.increment_adp();
        datagram.data_mut()[0] = 9;
        assert_eq!(
            (datagram.working_counter(), datagram.events(), datagram.adp(), datagram.data()[0]),
            (2, 0x000C, 0x1002, 9)
        );
    }

    #[test]
    fn foreign_and_short_frames_are_not_ethercat() {
        let mut buffer = [0; 100];
        let length = two_datagrams(&mut buffer, None);
        assert!(Layout::of(&buffer[..ETHERNET_HEADER + 1]).is_none());
        buffer[12] = 0x08;
        assert!(Layout::of(&buffer[..length]).is_none());
        buffer[12..20].copy_from_slice(&[0x81, 0, 0, 1, 0x81, 0, 0, 1]);
        assert!(Layout::of(&buffer[..length]).is_none(), "only one tag is looked through");
    }

    #[test]
    fn lying_lengths_break_the_walk_where_they_lie() {
        let mut buffer = [0; 100];
        let length = two_datagrams(&mut buffer, None);
        let datagrams = |frame: &[u8]| {
            let layout = Layout::of(frame).unwrap();
            let mut walk = layout.walk();
            let count = core::iter::from_fn(|| walk.next(frame).map(|_| ())).count();
            (count, layout.is_intact(frame))
        };
        assert_eq!(datagrams(&buffer[..length]), (2, true));
        assert_eq!(datagrams(&buffer[..length + 20]), (2, true), "padding is no concern");
        assert_eq!(datagrams(&buffer[..length - 1]), (1, false), "truncated");
        let mut more = buffer;
        more[16 + 18 + 7] |= 0x80;
        assert_eq!(
            datagrams(&more[..length + 20]),
            (2, false),
            "more follows, but there is no room for it"
        );
        let mut overrun = buffer;
        overrun[16 + 18 + 6] = 200;
        assert_eq!(datagrams(&overrun[..length]), (1, false));
        let mut other_type = buffer;
        other_type[15] = 0x50;
        assert_eq!(datagrams(&other_type[..length]), (0, false));
    }
}
