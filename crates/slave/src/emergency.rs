//! Emergency messages on their way to the master (ETG.1000.6, emergency).

use heapless::Deque;
use wire::coe::Emergency;

/// How many messages wait while the master does not fetch them.
const WAITING: usize = 4;

/// The messages that wait, and what the master was told last.
#[derive(Clone, Debug, Default)]
pub(crate) struct Emergencies {
    /// The code that the master knows of; `None` until the device was looked at for the first time since the mailbox started.
    told: Option<u16>,
    /// One more than wait usually, for a message that made way for an answer.
    waiting: Deque<Emergency, { WAITING + 1 }>,
}

impl Emergencies {
    /// Before the first mailbox since power-on, when no master knows of any fault.
    pub(crate) const fn at_power_on() -> Self {
        Self {
            told: Some(0),
            waiting: Deque::new(),
        }
    }

    /// Looks at the device's present fault: a code other than the last one makes a message, but what was there before the mailbox was started
    /// anew does not. While no more messages can wait, changes pass unseen; only the last of them is told later.
    pub(crate) fn observe(&mut self, present: Emergency) {
        match self.told {
            None => self.told = Some(present.code),
            Some(code) if code != present.code && self.waiting.len() < WAITING && self.waiting.push_back(present).is_ok() => {
                self.told = Some(present.code);
            }
            Some(_) => {}
        }
    }

    /// Whether no message waits.
    pub(crate) fn is_empty(&self) -> bool {
        self.waiting.is_empty()
    }

    /// The next message.
    pub(crate) fn next(&mut self) -> Option<Emergency> {
        self.waiting.pop_front()
    }

    /// Takes a message back that is to be sent again before the others.
    pub(crate) fn take_back(&mut self, emergency: Emergency) {
        // No more than one is on its way, and there is room for one more than wait.
        let _ = self.waiting.push_front(emergency);
    }
}
