//! The AL event request (0x0220), on the slave stack's time.
//!
//! A frame is answered before the slave's own time has caught up with its arrival, so what the frame raises waits until then.

use wire::Nanos;

const WAITING: usize = 8;

/// Events the slave stack sees, and events that wait for its time to come.
#[derive(Clone, Debug, Default)]
pub(crate) struct Events {
    visible: u32,
    waiting: [(Nanos, u32); WAITING],
    count: usize,
}

impl Events {
    /// The events the slave stack sees now.
    pub(crate) const fn visible(&self) -> u32 {
        self.visible
    }

    /// Raises events that become visible at `at`.
    ///
    /// When more frames wait than there is room for, the newest events join those before them and are seen early rather than never.
    pub(crate) fn raise_at(&mut self, at: Nanos, bits: u32) {
        let waiting = &mut self.waiting[..self.count];
        if let Some(entry) = waiting.iter_mut().find(|entry| entry.0 == at) {
            entry.1 |= bits;
        } else if self.count < WAITING {
            self.waiting[self.count] = (at, bits);
            self.count += 1;
        } else {
            self.waiting[WAITING - 1].1 |= bits;
        }
    }

    /// Raises events that are visible at once.
    pub(crate) const fn raise(&mut self, bits: u32) {
        self.visible |= bits;
    }

    /// Takes back events the slave stack has seen.
    pub(crate) const fn acknowledge(&mut self, bits: u32) {
        self.visible &= !bits;
    }

    /// Takes back events, seen or not.
    pub(crate) fn cancel(&mut self, bits: u32) {
        self.visible &= !bits;
        for entry in &mut self.waiting[..self.count] {
            entry.1 &= !bits;
        }
    }

    /// Makes visible what was raised until `now`.
    pub(crate) fn release(&mut self, now: Nanos) {
        let mut kept = 0;
        for at in 0..self.count {
            let entry = self.waiting[at];
            if entry.0 <= now {
                self.visible |= entry.1;
            } else {
                self.waiting[kept] = entry;
                kept += 1;
            }
        }
        self.count = kept;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_wait_for_their_time() {
        let mut events = Events::default();
        events.raise_at(Nanos(10), 1);
        events.raise_at(Nanos(20), 2);
        events.release(Nanos(9));
        assert_eq!(events.visible(), 0);
        events.release(Nanos(10));
        assert_eq!(events.visible(), 1);
        events.acknowledge(3);
        events.release(Nanos(20));
        assert_eq!(events.visible(), 2);
    }

    #[test]
    fn cancelled_events_never_come() {
        let mut events = Events::default();
        events.raise_at(Nanos(10), 3);
        events.cancel(1);
        events.release(Nanos(10));
        assert_eq!(events.visible(), 2);
    }

    #[test]
    fn no_event_is_lost_when_many_frames_wait() {
        let mut events = Events::default();
        for bit in 0..32 {
            events.raise_at(Nanos(bit), 1 << bit);
        }
        events.release(Nanos(31));
        assert_eq!(events.visible(), u32::MAX);
    }
}
