//! Orders to a drive server from outside, through a Unix socket: `usr2556e cable`, `usr2556e fault` and whoever speaks its protocol.
//!
//! A connection is one order: a line of text, `list`, `cut N`, `repair N`, `unplug N` or `plug N` for the cables, `faults`, `break N WHAT` or `mend N` for
//! the drives ([`crate::breakdown`]). The answer is the line `ok` and what there is to say, or the line `error` and why not, and the connection's end.

use std::fmt;
use std::str::FromStr;
use std::sync::mpsc::SyncSender;

use crate::breakdown::{Breakdown, Damage};
use crate::cables::Change;
use crate::drive::VirtualDrive;
use crate::segment::VirtualSegment;

#[cfg(unix)]
mod socket;
#[cfg(not(unix))]
#[path = "control/socket_elsewhere.rs"]
mod socket;

pub use socket::{ControlSocket, ask};

/// The environment variable in which a command of `usr2556e exec` finds the socket's path.
pub const CONTROL_VARIABLE: &str = "USR2556E_CONTROL";

/// What can be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// How all cables are, a line each.
    List,
    /// Something to be done to the cables.
    Change(Change),
    /// What is broken at all drives, a line each.
    Faults,
    /// Something to be broken or mended.
    Damage(Damage),
}

impl fmt::Display for Order {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::List => write!(f, "list"),
            Self::Change(change) => change.fmt(f),
            Self::Faults => write!(f, "faults"),
            Self::Damage(damage) => damage.fmt(f),
        }
    }
}

/// A text that is no order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoOrder;

impl fmt::Display for NoOrder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "not understood; orders are list, cut N, repair N, unplug N, plug N, faults, break N WHAT and mend N"
        )
    }
}

impl FromStr for Order {
    type Err = NoOrder;

    fn from_str(text: &str) -> Result<Self, NoOrder> {
        match text {
            "list" => Ok(Self::List),
            "faults" => Ok(Self::Faults),
            _ => text
                .parse()
                .map(Self::Change)
                .or_else(|_| text.parse().map(Self::Damage))
                .map_err(|_| NoOrder),
        }
    }
}

/// What came of an order: what there is to say, or why it was not carried out.
pub type Answer = Result<String, String>;

/// An order, and who waits for the answer.
#[derive(Debug)]
pub struct Request {
    order: Order,
    answer: SyncSender<Answer>,
}

impl Request {
    /// The answer goes to the other end of `answer`, which should have room for it: nobody waits until it has.
    pub const fn new(order: Order, answer: SyncSender<Answer>) -> Self {
        Self { order, answer }
    }

    /// Does what is asked for, and tells.
    pub fn carry_out(self, segment: &mut VirtualSegment) {
        // Who asked may be gone; what was asked for is done all the same.
        let _ = self.answer.try_send(carry_out(self.order, segment));
    }
}

fn carry_out(order: Order, segment: &mut VirtualSegment) -> Answer {
    match order {
        Order::Change(change) => segment.change(change).map_err(|error| error.to_string())?,
        Order::Damage(damage) => segment.damage(damage).map_err(|error| error.to_string())?,
        Order::List => return Ok(segment.cables().map(|cable| format!("{cable}\n")).collect()),
        Order::Faults => {
            return Ok((1..)
                .zip(segment.drives())
                .map(|(number, drive)| faults_of(number, drive))
                .collect());
        }
    }
    Ok(String::new())
}

fn faults_of(number: usize, drive: &VirtualDrive) -> String {
    let faults: Vec<String> = Breakdown::all_of(&drive.plant().faults()).map(|what| what.to_string()).collect();
    match faults.is_empty() {
        true => format!("drive {number}: whole\n"),
        false => format!("drive {number}: {}\n", faults.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::sync_channel;

    use super::*;

    fn answer(order: &str, segment: &mut VirtualSegment) -> Answer {
        let (sender, receiver) = sync_channel(1);
        Request::new(order.parse().unwrap(), sender).carry_out(segment);
        receiver.recv().unwrap()
    }

    #[test]
    fn orders_are_carried_out_or_refused_with_a_reason() {
        let mut segment = VirtualSegment::of(2);
        assert_eq!(answer("cut 2", &mut segment), Ok(String::new()));
        assert_eq!(answer("cut 2", &mut segment), Err("cable 2 is cut already".into()));
        assert_eq!(
            answer("cut 3", &mut segment),
            Err("there is no cable 3: there are 2, counted from 1".into())
        );
        assert_eq!(
            answer("list", &mut segment),
            Ok("cable 1 (interface to drive 1): whole\ncable 2 (drive 1 to drive 2): cut\n".into())
        );
    }

    #[test]
    fn what_is_broken_is_listed_until_it_is_mended() {
        let mut segment = VirtualSegment::of(2);
        assert_eq!(answer("break 2 open-a", &mut segment), Ok(String::new()));
        assert_eq!(answer("break 2 supply 3000", &mut segment), Ok(String::new()));
        assert_eq!(
            answer("faults", &mut segment),
            Ok("drive 1: whole\ndrive 2: open-a, supply 3000\n".into())
        );
        assert_eq!(answer("mend 2", &mut segment), Ok(String::new()));
        assert_eq!(answer("faults", &mut segment), Ok("drive 1: whole\ndrive 2: whole\n".into()));
        assert_eq!(
            answer("mend 3", &mut segment),
            Err("there is no drive 3: there are 2, counted from 1".into())
        );
    }

    #[test]
    fn an_order_is_carried_out_though_nobody_waits_any_more() {
        let mut segment = VirtualSegment::of(2);
        let (sender, receiver) = sync_channel(1);
        drop(receiver);
        Request::new(Order::Change(Change::Cut(1)), sender).carry_out(&mut segment);
        assert_eq!(answer("cut 1", &mut segment), Err("cable 1 is cut already".into()));
    }
}
