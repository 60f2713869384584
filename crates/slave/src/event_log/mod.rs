//! What has happened to the device since power-on: one bounded log, shown as object 0x10F3 and as a file.
//!
//! | module | holds |
//! |---|---|
//! | here | the log: the last [`CAPACITY`] events, each with its number and the device's time |
//! | `event` | what can happen, how severe it is, and in which words it is told |
//! | `history` | the log as object 0x10F3, diagnosis history (ETG.1020) |
//! | `report` | the log as lines of text |
//!
//! When the log is full, the oldest event makes way. It is not kept over power cycles.

mod event;
pub(crate) mod history;
pub(crate) mod report;

use heapless::Vec;
use wire::coe::Emergency;

pub(crate) use event::Event;
pub use event::{MESSAGES, MessageText, Severity};
use history::Acknowledgement;

/// How many events the log holds.
pub const CAPACITY: usize = 32;

/// An event in the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Record {
    /// Counts the events since power-on; the first is 0.
    pub(crate) number: u32,
    /// When it happened: 0x10F8 then, in ns.
    pub(crate) time: u64,
    pub(crate) event: Event,
}

/// The log.
#[derive(Clone, Debug, Default)]
pub(crate) struct EventLog {
    /// An event's place here is that of its message in 0x10F3.
    records: Vec<Record, CAPACITY>,
    /// The place of the newest, if there are any.
    newest: usize,
    /// The number of the next event.
    next: u32,
    /// The device's time at the present poll.
    time: u64,
    /// The fault that was present at the last poll; 0 for none.
    fault: u16,
    /// What a client of 0x10F3 has seen.
    acknowledgement: Acknowledgement,
}

impl EventLog {
    /// Begins a poll at the device's time: the first is power-on. A change of the present fault is an event.
    pub(crate) fn observe(&mut self, time: u64, present: Emergency) {
        self.time = time;
        if self.next == 0 && self.records.is_empty() {
            self.add(Event::PowerOn);
        }
        let before = core::mem::replace(&mut self.fault, present.code);
        match (before, present.code) {
            (before, code) if before == code => {}
            (before, 0) => self.add(Event::FaultCleared { code: before }),
            (_, code) => self.add(Event::Fault {
                code,
                register: present.register,
            }),
        }
    }

    /// Adds an event of the present poll, unless a client of 0x10F3 has switched its kind off.
    pub(crate) fn add(&mut self, event: Event) {
        if self.acknowledgement.leaves_out(event.severity()) {
            return;
        }
        let record = Record {
            number: self.next,
            time: self.time,
            event,
        };
        self.next = self.next.wrapping_add(1);
        match self.records.push(record) {
            Ok(()) => self.newest = self.records.len() - 1,
            Err(record) => {
                self.newest = (self.newest + 1) % CAPACITY;
                self.records[self.newest] = record;
                self.acknowledgement.overwritten(self.newest);
            }
        }
        self.acknowledgement.added();
    }

    /// Forgets all events. Numbers go on.
    fn clear(&mut self) {
        self.records.clear();
        self.acknowledgement.cleared();
    }

    /// The event with this number, if the log still holds it.
    fn record(&self, number: u32) -> Option<&Record> {
        self.records.iter().find(|record| record.number == number)
    }

    /// The numbers of the events in the log.
    fn numbers(&self) -> core::ops::Range<u32> {
        self.next.wrapping_sub(self.records.len() as u32)..self.next
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_events_stay_and_their_numbers_count_on() {
        let mut log = EventLog::default();
        for time in 0..100 {
            log.time = time;
            log.add(Event::ParametersSaved);
        }
        assert_eq!(log.numbers(), 68..100);
        assert!(log.numbers().all(|number| log.record(number).unwrap().time == u64::from(number)));
        assert_eq!(log.record(67), None);
        log.clear();
        log.add(Event::PowerOn);
        assert_eq!(log.numbers(), 100..101);
    }

    #[test]
    fn a_change_of_fault_is_an_event_and_a_lasting_fault_is_none() {
        let mut log = EventLog::default();
        for code in [0, 0, 0x3110, 0x3110, 0x7500, 0, 0] {
            log.observe(
                5,
                Emergency {
                    code,
                    register: 1,
                    ..Emergency::default()
                },
            );
        }
        let events: std::vec::Vec<Event> = log.records.iter().map(|record| record.event).collect();
        assert_eq!(
            events,
            [
                Event::PowerOn,
                Event::Fault { code: 0x3110, register: 1 },
                Event::Fault { code: 0x7500, register: 1 },
                Event::FaultCleared { code: 0x7500 }
            ]
        );
    }
}
