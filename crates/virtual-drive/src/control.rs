//! Orders to a drive server from outside, through a Unix socket: `usr2556e cable` and whoever speaks its protocol.
//!
//! A connection is one order: a line of text, `list`, `cut N`, `repair N`, `unplug N` or `plug N`. The answer is the line `ok` and what there is to say, or the
//! line `error` and why not, and the connection's end.

use std::fmt;
use std::str::FromStr;
use std::sync::mpsc::SyncSender;

use crate::cables::Change;
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
}

impl fmt::Display for Order {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::List => write!(f, "list"),
            Self::Change(change) => change.fmt(f),
        }
    }
}

/// A text that is no order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoOrder;

impl fmt::Display for NoOrder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "not understood; orders are list, cut N, repair N, unplug N and plug N")
    }
}

impl FromStr for Order {
    type Err = NoOrder;

    fn from_str(text: &str) -> Result<Self, NoOrder> {
        match text {
            "list" => Ok(Self::List),
            _ => text.parse().map(Self::Change).map_err(|_| NoOrder),
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
        Order::List => return Ok(segment.cables().map(|cable| format!("{cable}\n")).collect()),
    }
    Ok(String::new())
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
    fn an_order_is_carried_out_though_nobody_waits_any_more() {
        let mut segment = VirtualSegment::of(2);
        let (sender, receiver) = sync_channel(1);
        drop(receiver);
        Request::new(Order::Change(Change::Cut(1)), sender).carry_out(&mut segment);
        assert_eq!(answer("cut 1", &mut segment), Err("cable 1 is cut already".into()));
    }
}
