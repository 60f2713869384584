//! The master's network cards: one at a line, two at a ring.
use std::time::Duration;

use esc::Side;

use super::{Link, LinkError, Received};

/// The wires to the master's network cards. Every [`Link`] is the one to its primary card.
pub trait Cards {
    /// Puts one frame on the wire to the card on `side`, as [`Link::send`] does; lost where there is none.
    fn send_to(&mut self, side: Side, frame: &[u8]) -> Result<(), LinkError>;

    /// Waits up to `wait` for a frame of any card, as [`Link::receive`] does, and tells from which. The side means nothing with
    /// [`Received::Soon`] and [`Received::Timeout`].
    fn receive_any(&mut self, buffer: &mut [u8], wait: Duration) -> Result<(Side, Received), LinkError>;
}

impl<L: Link + ?Sized> Cards for L {
    fn send_to(&mut self, side: Side, frame: &[u8]) -> Result<(), LinkError> {
        match side {
            Side::Primary => self.send(frame),
            Side::Secondary => Ok(()),
        }
    }

    fn receive_any(&mut self, buffer: &mut [u8], wait: Duration) -> Result<(Side, Received), LinkError> {
        Ok((Side::Primary, self.receive(buffer, wait)?))
    }
}
