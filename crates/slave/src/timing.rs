//! How long events of synchronisation wait, for the times of 0x1C32 and 0x1C33 (ETG.1020).
//!
//! A SYNC signal is dated by the chip's own clock, a frame by the poll that finds its outputs: the chip does not say when they came.

use wire::al::AlState;
use wire::register;
use wire::{EscAccess, Nanos};

use crate::stack::Slave;

/// An event of synchronisation that has been served.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Event {
    served: Nanos,
    /// How long it had waited by then in ns; 0 if nobody asked.
    waited: u32,
}

impl Event {
    /// An event found at `now`.
    pub(crate) const fn found(now: Nanos) -> Self {
        Self { served: now, waited: 0 }
    }

    /// SYNC0 or SYNC1, found at `now`; `next` is the register with the time of the signal's next pulse, a cycle after the one found.
    pub(crate) fn dated(esc: &mut impl EscAccess, next: u16, cycle: u32, now: Nanos) -> Self {
        let time = read_time(esc, register::DC_SYSTEM_TIME);
        let pulse = read_time(esc, next).wrapping_sub(cycle.into());
        // A pulse between the two readings leaves a time that lies ahead: then it has not waited.
        let waited = u32::try_from(time.wrapping_sub(pulse)).unwrap_or(0);
        Self { served: now, waited }
    }

    /// How long after the event `now` is, in ns.
    pub(crate) fn age(self, now: Nanos) -> u32 {
        let since = u32::try_from(now.since(self.served)).unwrap_or(u32::MAX);
        self.waited.saturating_add(since)
    }
}

fn read_time(esc: &mut impl EscAccess, address: u16) -> u64 {
    let mut bytes = [0; 8];
    esc.read(address, &mut bytes);
    u64::from_le_bytes(bytes)
}

/// How many pulses with this cycle passed unserved between two that were served, `interval` ns apart.
pub(crate) fn unserved(interval: u64, cycle: u32) -> u16 {
    let cycle = u64::from(cycle.max(1));
    let pulses = interval.saturating_add(cycle / 2) / cycle;
    u16::try_from(pulses.saturating_sub(1)).unwrap_or(u16::MAX)
}

impl Slave {
    /// An event of synchronisation: inputs are due. Those of the last one are late if they are not ready yet.
    pub(crate) fn synchronized(&mut self, event: Event) {
        if self.inputs_due.replace(event).is_some() {
            self.count_too_small(1);
        }
    }

    /// Counts events that came too early for the one before.
    pub(crate) fn count_too_small(&mut self, events: u16) {
        if self.status.state == AlState::Op {
            for parameters in self.area.sync_parameters() {
                parameters.too_small = parameters.too_small.saturating_add(events);
            }
        }
    }

    /// A SYNC signal just found. Its date takes two readings of the chip, which are spared while nobody asks for times.
    pub(crate) fn date(&self, esc: &mut impl EscAccess, next: u16, cycle: u32, now: Nanos) -> Event {
        if self.area.outputs.is_measuring() || self.area.inputs.is_measuring() {
            Event::dated(esc, next, cycle, now)
        } else {
            Event::found(now)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pulses_are_unserved_only_when_a_whole_cycle_passed_without_service() {
        for (interval, expected) in [
            (0, 0),
            (950_000, 0),
            (1_050_000, 0),
            (1_499_999, 0),
            (1_500_000, 1),
            (2_000_000, 1),
            (3_040_000, 2),
            (u64::MAX, u16::MAX),
        ] {
            assert_eq!(unserved(interval, 1_000_000), expected, "{interval}");
        }
        assert_eq!(unserved(5, 0), 4, "no cycle is no division by zero");
    }
}
