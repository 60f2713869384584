//! The cables of a line or a ring, by their numbers, to be cut and repaired while everything runs.
//!
//! Cable N leads to drive N from the one before it, cable 1 from the master's card. A ring has one more, from the last drive to the
//! master's second card. There is a link on a cable while it is whole, both of its plugs are in and the master's interface at its end is up.

use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

use esc::{CannotConnect, End, Side};

/// Something done to the cables by hand. Numbers count from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Breaks a cable.
    Cut(usize),
    /// Makes a cable whole again.
    Repair(usize),
    /// Pulls both plugs of a drive. It keeps its supply; those behind it are out of reach, unless from the other end of a ring.
    Unplug(usize),
    /// Puts both plugs of a drive in again.
    Plug(usize),
}

/// `cut 2` and the like.
impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cut(number) => write!(f, "cut {number}"),
            Self::Repair(number) => write!(f, "repair {number}"),
            Self::Unplug(number) => write!(f, "unplug {number}"),
            Self::Plug(number) => write!(f, "plug {number}"),
        }
    }
}

/// A text that is no change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoChange;

impl FromStr for Change {
    type Err = NoChange;

    fn from_str(text: &str) -> Result<Self, NoChange> {
        let (verb, number) = text.split_once(' ').ok_or(NoChange)?;
        let number = number.parse().map_err(|_| NoChange)?;
        match verb {
            "cut" => Ok(Self::Cut(number)),
            "repair" => Ok(Self::Repair(number)),
            "unplug" => Ok(Self::Unplug(number)),
            "plug" => Ok(Self::Plug(number)),
            _ => Err(NoChange),
        }
    }
}

/// Why a change cannot be made. Nothing has changed then, but for [`ChangeError::Taken`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChangeError {
    /// There is no cable of that number.
    NoSuchCable {
        /// The number asked for.
        number: usize,
        /// How many there are.
        cables: usize,
    },
    /// There is no drive of that number.
    NoSuchDrive {
        /// The number asked for.
        number: usize,
        /// How many there are.
        drives: usize,
    },
    /// It is like that already.
    Already(Change),
    /// Another cable, plugged by [`crate::segment::VirtualSegment::connect`], is where this one belongs.
    Taken(CannotConnect),
}

impl fmt::Display for ChangeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoSuchCable { number, cables } => write!(f, "there is no cable {number}: there are {cables}, counted from 1"),
            Self::NoSuchDrive { number, drives } => write!(f, "there is no drive {number}: there are {drives}, counted from 1"),
            Self::Already(Change::Cut(number)) => write!(f, "cable {number} is cut already"),
            Self::Already(Change::Repair(number)) => write!(f, "cable {number} is not cut"),
            Self::Already(Change::Unplug(number)) => write!(f, "drive {number} is unplugged already"),
            Self::Already(Change::Plug(number)) => write!(f, "drive {number} is not unplugged"),
            Self::Taken(reason) => write!(f, "the cable's place is taken: {reason}"),
        }
    }
}

impl std::error::Error for ChangeError {}

/// What keeps a cable from having a link; the first that applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CableState {
    /// There is a link.
    Whole,
    /// It is cut.
    Cut,
    /// This drive, counted from 1, is unplugged.
    Unplugged(usize),
    /// The master's interface is down.
    InterfaceDown,
}

/// One cable at a glance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cable {
    /// Its number, counted from 1.
    pub number: usize,
    /// The end towards the master's first card, and the other one.
    pub ends: [End; 2],
    /// How it is.
    pub state: CableState,
}

impl fmt::Display for Cable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = |end: End| match end {
            End::Master(Side::Primary) => "interface".into(),
            End::Master(Side::Secondary) => "redundant interface".into(),
            End::Port { position, .. } => format!("drive {}", position.saturating_add(1)),
        };
        write!(f, "cable {} ({} to {}): ", self.number, name(self.ends[0]), name(self.ends[1]))?;
        match self.state {
            CableState::Whole => write!(f, "whole"),
            CableState::Cut => write!(f, "cut"),
            CableState::Unplugged(drive) => write!(f, "drive {drive} is unplugged"),
            CableState::InterfaceDown => write!(f, "the interface is down"),
        }
    }
}

/// How the cables ought to be.
#[derive(Clone, Debug)]
pub(crate) struct Cables {
    cut: Vec<bool>,
    unplugged: Vec<bool>,
    /// The master's interfaces, by side.
    down: [bool; 2],
}

impl Cables {
    /// A line of `drives`.
    pub(crate) fn line(drives: usize) -> Self {
        Self {
            cut: vec![false; drives],
            unplugged: vec![false; drives],
            down: [false; 2],
        }
    }

    /// Adds the cable to the second card. Returns its number.
    pub(crate) fn close(&mut self) -> usize {
        self.cut.resize(self.unplugged.len() + 1, false);
        self.cut.len()
    }

    pub(crate) const fn count(&self) -> usize {
        self.cut.len()
    }

    /// Cable `number`, which must exist.
    pub(crate) fn cable(&self, number: usize) -> Cable {
        let drives = self.unplugged.len();
        let before = match number {
            1 => End::Master(Side::Primary),
            _ => End::Port {
                position: number - 2,
                port: 1,
            },
        };
        let behind = match number - 1 {
            position if position == drives => End::Master(Side::Secondary),
            position => End::Port { position, port: 0 },
        };
        let ends = [before, behind];
        let state = if self.cut[number - 1] {
            CableState::Cut
        } else {
            ends.into_iter().find_map(|end| self.obstacle(end)).unwrap_or(CableState::Whole)
        };
        Cable { number, ends, state }
    }

    /// What keeps a link from this end.
    fn obstacle(&self, end: End) -> Option<CableState> {
        match end {
            End::Master(side) => self.down[side as usize].then_some(CableState::InterfaceDown),
            End::Port { position, .. } => self.unplugged[position].then_some(CableState::Unplugged(position + 1)),
        }
    }

    /// Takes a change over. Returns the numbers of the cables that it touches.
    pub(crate) fn change(&mut self, change: Change) -> Result<RangeInclusive<usize>, ChangeError> {
        let cables = self.cut.len();
        let (number, flags, wanted) = match change {
            Change::Cut(number) => (number, &mut self.cut, true),
            Change::Repair(number) => (number, &mut self.cut, false),
            Change::Unplug(number) => (number, &mut self.unplugged, true),
            Change::Plug(number) => (number, &mut self.unplugged, false),
        };
        let of_a_drive = matches!(change, Change::Unplug(_) | Change::Plug(_));
        let count = flags.len();
        let Some(flag) = number.checked_sub(1).and_then(|index| flags.get_mut(index)) else {
            return Err(if of_a_drive {
                ChangeError::NoSuchDrive { number, drives: count }
            } else {
                ChangeError::NoSuchCable { number, cables }
            });
        };
        if *flag == wanted {
            return Err(ChangeError::Already(change));
        }
        *flag = wanted;
        let last = if of_a_drive { (number + 1).min(cables) } else { number };
        Ok(number..=last)
    }

    /// Takes over whether the interface to one of the master's cards is up. Returns the number of the cable that leads there, if there is one.
    pub(crate) fn set_interface(&mut self, side: Side, up: bool) -> Option<usize> {
        self.down[side as usize] = !up;
        (1..=self.cut.len()).find(|&number| self.cable(number).ends.contains(&End::Master(side)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn changes_come_back_from_their_text() {
        for change in [Change::Cut(1), Change::Repair(2), Change::Unplug(30), Change::Plug(400)] {
            assert_eq!(change.to_string().parse(), Ok(change));
        }
        for text in [
            "",
            "cut",
            "cut ",
            "cut -1",
            "cut 1 2",
            "cut  1",
            "burn 1",
            "cut 99999999999999999999",
        ] {
            assert_eq!(text.parse::<Change>(), Err(NoChange), "{text:?}");
        }
    }

    #[test]
    fn what_is_not_there_or_is_so_already_is_told() {
        let mut ring = Cables::line(3);
        ring.close();
        let no_cable = |number| Err(ChangeError::NoSuchCable { number, cables: 4 });
        let no_drive = |number| Err(ChangeError::NoSuchDrive { number, drives: 3 });
        for (change, answer) in [
            (Change::Cut(0), no_cable(0)),
            (Change::Cut(5), no_cable(5)),
            (Change::Repair(usize::MAX), no_cable(usize::MAX)),
            (Change::Unplug(4), no_drive(4)),
            (Change::Plug(0), no_drive(0)),
            (Change::Repair(4), Err(ChangeError::Already(Change::Repair(4)))),
            (Change::Cut(4), Ok(4..=4)),
            (Change::Cut(4), Err(ChangeError::Already(Change::Cut(4)))),
            (Change::Repair(4), Ok(4..=4)),
            (Change::Plug(2), Err(ChangeError::Already(Change::Plug(2)))),
            (Change::Unplug(2), Ok(2..=3)),
            (Change::Unplug(2), Err(ChangeError::Already(Change::Unplug(2)))),
            (Change::Plug(2), Ok(2..=3)),
        ] {
            assert_eq!(ring.change(change), answer, "{change}");
        }
        assert_eq!(
            Cables::line(3).change(Change::Unplug(3)),
            Ok(3..=3),
            "a line ends at its last drive"
        );
    }

    #[test]
    fn each_cable_tells_the_first_reason_for_having_no_link() {
        let mut ring = Cables::line(2);
        ring.close();
        ring.set_interface(Side::Secondary, false);
        ring.change(Change::Unplug(2)).unwrap();
        ring.change(Change::Cut(2)).unwrap();
        let lines: Vec<String> = (1..=3).map(|number| ring.cable(number).to_string()).collect();
        assert_eq!(
            lines,
            [
                "cable 1 (interface to drive 1): whole",
                "cable 2 (drive 1 to drive 2): cut",
                "cable 3 (drive 2 to redundant interface): drive 2 is unplugged",
            ]
        );
        ring.change(Change::Plug(2)).unwrap();
        assert_eq!(ring.cable(3).state, CableState::InterfaceDown);
    }

    proptest! {
        #[test]
        fn any_text_is_a_change_or_none(text in ".{0,80}") {
            if let Ok(change) = text.parse::<Change>() {
                prop_assert!(Cables::line(2).change(change).is_ok_and(|cables| cables.end() <= &2) || Cables::line(2).change(change).is_err());
            }
        }
    }
}
