//! Receiving, answering, counting and repeating mailbox messages (ETG.1000.4, mailbox).

use heapless::{Deque, Vec};
use wire::coe::SdoResponse;
use wire::mailbox::{HEADER_SIZE, Header, MailboxError, Protocol};
use wire::register::{self, sync_manager};
use wire::{AlEvents, EscAccess};

use crate::configuration::MAX_MAILBOX;
use crate::sync_managers::{self, MAILBOX_IN, MAILBOX_OUT, SyncManager};

/// A whole mailbox.
type Message = Vec<u8, MAX_MAILBOX>;

/// How many answers wait while the master does not fetch them; further requests stay in the chip.
const QUEUE: usize = 4;
/// The last counter before it starts again at 1.
const LAST_COUNTER: u8 = 7;

/// Both mailboxes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Mailbox {
    out: SyncManager,
    back: SyncManager,
    /// The counter of the last request; 0 if there was none.
    last_request: u8,
    /// The counter of the next answer.
    counter: u8,
    /// One more than wait usually, for an answer taken back by a repeat request.
    queue: Deque<Message, { QUEUE + 1 }>,
    /// What lies in the chip and was perhaps not fetched yet.
    loaded: Option<Message>,
    /// What the master fetched last, for the case that the frame was lost.
    fetched: Option<Message>,
    /// The level of the repeat request that was answered last.
    repeat: bool,
}

impl Mailbox {
    /// Starts mailbox communication with empty mailboxes.
    pub(crate) fn start(&mut self, esc: &mut impl EscAccess, all: &[SyncManager; 4]) {
        *self = Self {
            out: all[MAILBOX_OUT],
            back: all[MAILBOX_IN],
            counter: 1,
            ..Self::default()
        };
        for index in [MAILBOX_OUT, MAILBOX_IN] {
            empty(esc, index);
        }
        self.answer_repeat(esc, all[MAILBOX_IN].repeat_requested());
    }

    /// Forgets everything: the state machine is back in INIT.
    pub(crate) fn stop(&mut self) {
        *self = Self::default();
    }

    /// Whether the master has moved a mailbox since [`Self::start`].
    pub(crate) fn was_moved(&self, all: &[SyncManager; 4]) -> bool {
        !self.out.same_area(&all[MAILBOX_OUT]) || !self.back.same_area(&all[MAILBOX_IN])
    }

    /// The length of the mailbox to the master, in bytes.
    pub(crate) fn capacity(&self) -> usize {
        usize::from(self.back.length)
    }

    /// Whether a request can be taken.
    pub(crate) fn has_room(&self) -> bool {
        self.queue.len() < QUEUE
    }

    /// Takes the request that lies in the chip; `None` for one that was answered already, or is an answer itself.
    ///
    /// The request is given with its header and the bytes the header tells of, or with the error to answer.
    pub(crate) fn receive<'b>(
        &mut self,
        esc: &mut impl EscAccess,
        buffer: &'b mut [u8; MAX_MAILBOX],
    ) -> Option<(Header, Result<&'b [u8], MailboxError>)> {
        let length = usize::from(self.out.length).min(MAX_MAILBOX);
        // The whole mailbox is read, for only the last byte makes it empty.
        esc.read(self.out.start, &mut buffer[..length]);
        let header = Header::parse(&buffer[..length])?;
        let repeated = header.counter != 0 && header.counter == self.last_request;
        // An error reply is never answered, or two devices could go on for ever.
        if repeated || header.protocol == Protocol::ERROR {
            return None;
        }
        if header.counter != 0 {
            self.last_request = header.counter;
        }
        let end = HEADER_SIZE + usize::from(header.length);
        Some((header, buffer[..length].get(HEADER_SIZE..end).ok_or(MailboxError::InvalidSize)))
    }

    /// Queues an SDO response to the request with this header.
    pub(crate) fn respond(&mut self, request: &Header, response: &SdoResponse<'_>) {
        let (front, data) = response.parts();
        self.queue(request, Protocol::COE, &[&response.service().header(), &front, data]);
    }

    /// Queues a mailbox error reply to the request with this header.
    pub(crate) fn refuse(&mut self, request: &Header, error: MailboxError) {
        self.queue(request, Protocol::ERROR, &[&error.bytes()]);
    }

    /// Queues a message; the mailbox's length bounds that of `parts`.
    fn queue(&mut self, request: &Header, protocol: Protocol, parts: &[&[u8]]) {
        let length: usize = parts.iter().map(|part| part.len()).sum();
        let header = Header {
            length: length as u16,
            protocol,
            counter: self.counter,
            ..*request
        };
        let mut message = Message::new();
        let fits = core::iter::once(&header.bytes()[..])
            .chain(parts.iter().copied())
            .all(|part| message.extend_from_slice(part).is_ok());
        debug_assert!(fits && message.len() <= self.capacity());
        // Unused bytes are sent as zeros; the last byte makes the mailbox full.
        if message.resize(self.capacity().min(MAX_MAILBOX), 0).is_ok() && self.queue.push_back(message).is_ok() {
            self.counter = if self.counter == LAST_COUNTER { 1 } else { self.counter + 1 };
        }
    }

    /// Puts the next answer into the chip if the last was fetched.
    pub(crate) fn send(&mut self, esc: &mut impl EscAccess) {
        if !self.queue.is_empty() && self.is_free(esc) {
            self.load_next(esc);
        }
    }

    /// Follows the master's repeat request: when it toggles, what was fetched last is offered again, before what waits.
    pub(crate) fn follow_repeat(&mut self, esc: &mut impl EscAccess, requested: bool) {
        if requested == self.repeat {
            return;
        }
        let free = self.is_free(esc);
        if let Some(fetched) = self.fetched.take() {
            if !free {
                empty(esc, MAILBOX_IN);
            }
            if let Some(unread) = self.loaded.take() {
                // Requests are taken only while the queue has room for this one too.
                let _ = self.queue.push_front(unread);
            }
            esc.write(self.back.start, &fetched);
            self.loaded = Some(fetched);
        }
        self.answer_repeat(esc, requested);
        self.send(esc);
    }

    /// Whether the mailbox to the master is empty in the chip.
    fn is_free(&mut self, esc: &mut impl EscAccess) -> bool {
        if self.loaded.is_some() {
            let status = register::SM + MAILBOX_IN as u16 * register::SM_SIZE + sync_manager::STATUS;
            if esc.read_u8(status) & sync_manager::STATUS_FULL != 0 {
                return false;
            }
            self.fetched = self.loaded.take();
        }
        true
    }

    fn load_next(&mut self, esc: &mut impl EscAccess) {
        if let Some(message) = self.queue.pop_front() {
            esc.write(self.back.start, &message);
            self.loaded = Some(message);
        }
    }

    fn answer_repeat(&mut self, esc: &mut impl EscAccess, requested: bool) {
        let acknowledge = if requested { sync_manager::PDI_REPEAT_ACK } else { 0 };
        sync_managers::write_pdi_control(esc, MAILBOX_IN, acknowledge);
        self.repeat = requested;
    }
}

/// The event that the master has written a request.
pub(crate) const REQUEST_EVENT: u32 = AlEvents::sync_manager(MAILBOX_OUT);

/// Empties a mailbox in the chip: switching it off and on resets its buffer.
fn empty(esc: &mut impl EscAccess, index: usize) {
    sync_managers::write_pdi_control(esc, index, sync_manager::PDI_DEACTIVATE);
    sync_managers::write_pdi_control(esc, index, 0);
}
