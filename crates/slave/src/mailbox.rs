//! Receiving, answering, counting and repeating mailbox messages (ETG.1000.4, mailbox).

use heapless::{Deque, Vec};
use wire::coe::{Emergency, SdoResponse, Service};
use wire::foe;
use wire::mailbox::{HEADER_SIZE, Header, MailboxError, Protocol};
use wire::register::{self, sync_manager};
use wire::{AlEvents, EscAccess};

use crate::configuration::MAX_MAILBOX;
use crate::emergency::Emergencies;
use crate::information::Information;
use crate::sync_managers::{self, MAILBOX_IN, MAILBOX_OUT, SyncManager};

/// A whole mailbox.
type Message = Vec<u8, MAX_MAILBOX>;

/// How many answers wait while the master does not fetch them; further requests stay in the chip.
const QUEUE: usize = 4;
/// The last counter before it starts again at 1.
const LAST_COUNTER: u8 = 7;
/// The counter in the last byte of a mailbox header.
const COUNTER: u8 = 0x70;
const COUNTER_SHIFT: u8 = 4;

/// Both mailboxes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Mailbox {
    out: SyncManager,
    back: SyncManager,
    /// The counter of the last request; 0 if there was none.
    last_request: u8,
    /// The counter of the next message.
    counter: u8,
    /// One more than wait usually, for an answer taken back by a repeat request.
    queue: Deque<Message, { QUEUE + 1 }>,
    /// What waits until no answer does.
    emergencies: Emergencies,
    /// What lies in the chip and was perhaps not fetched yet.
    loaded: Option<Message>,
    /// What it tells, if it is an emergency.
    loaded_emergency: Option<Emergency>,
    /// What the master fetched last, for the case that the frame was lost.
    fetched: Option<Message>,
    /// The level of the repeat request that was answered last.
    repeat: bool,
}

impl Mailbox {
    /// The mailbox at power-on, not started.
    pub(crate) fn at_power_on() -> Self {
        Self {
            emergencies: Emergencies::at_power_on(),
            ..Self::default()
        }
    }

    /// Starts mailbox communication with empty mailboxes.
    pub(crate) fn start(&mut self, esc: &mut impl EscAccess, all: &[SyncManager; 4]) {
        *self = Self {
            out: all[MAILBOX_OUT],
            back: all[MAILBOX_IN],
            counter: 1,
            emergencies: core::mem::take(&mut self.emergencies),
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

    /// The length of the mailbox from the master, in bytes.
    pub(crate) fn request_capacity(&self) -> usize {
        usize::from(self.out.length)
    }

    /// Whether a request can be taken.
    pub(crate) fn has_room(&self) -> bool {
        self.queue.len() < QUEUE
    }

    /// Takes the request that lies in the chip; `None` for one that was answered already, or is an answer itself.
    ///
    /// The request is given with its header and the bytes the header tells of, or with the error to answer.
    ///
    /// An emergency that was not fetched yet makes way for the answer, because not every master takes one in place of it.
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
        if self.loaded_emergency.is_some() && !self.is_free(esc) {
            self.unload(esc);
        }
        let end = HEADER_SIZE + usize::from(header.length);
        Some((header, buffer[..length].get(HEADER_SIZE..end).ok_or(MailboxError::InvalidSize)))
    }

    /// Queues an SDO response to the request with this header.
    pub(crate) fn respond(&mut self, request: &Header, response: &SdoResponse<'_>) {
        let (front, data) = response.parts();
        self.queue(request, Protocol::COE, &[&response.service().header(), &front, data]);
    }

    /// Queues a message of SDO information for the request with this header.
    pub(crate) fn inform(&mut self, request: &Header, information: &Information) {
        let service = Service::SdoInformation.header();
        self.queue(request, Protocol::COE, &[&service, &information.header.bytes(), &information.data]);
    }

    /// Queues a message of FoE that answers the one with this header.
    pub(crate) fn transfer(&mut self, request: &Header, message: &foe::Message<'_>) {
        let (front, rest) = message.parts();
        self.queue(request, Protocol::FOE, &[&front, rest]);
    }

    /// Queues a mailbox error reply to the request with this header.
    pub(crate) fn refuse(&mut self, request: &Header, error: MailboxError) {
        self.queue(request, Protocol::ERROR, &[&error.bytes()]);
    }

    /// Looks at the device's present fault, of which the master is told when it changes.
    pub(crate) fn observe(&mut self, present: Emergency) {
        self.emergencies.observe(present);
    }

    fn queue(&mut self, request: &Header, protocol: Protocol, parts: &[&[u8]]) {
        if let Some(message) = self.message(request, protocol, parts) {
            // Requests are taken only while the queue has room.
            let _ = self.queue.push_back(message);
        }
    }

    /// A message whose counter is still to be set; the mailbox's length bounds that of `parts`.
    fn message(&self, request: &Header, protocol: Protocol, parts: &[&[u8]]) -> Option<Message> {
        let length: usize = parts.iter().map(|part| part.len()).sum();
        let header = Header {
            length: length as u16,
            protocol,
            counter: 0,
            ..*request
        };
        let mut message = Message::new();
        let fits = core::iter::once(&header.bytes()[..])
            .chain(parts.iter().copied())
            .all(|part| message.extend_from_slice(part).is_ok());
        debug_assert!(fits && message.len() <= self.capacity());
        // Unused bytes are sent as zeros; the last byte makes the mailbox full.
        message.resize(self.capacity().min(MAX_MAILBOX), 0).ok()?;
        Some(message)
    }

    /// Puts the next message into the chip if the last was fetched: an answer, or when none waits, an emergency.
    pub(crate) fn send(&mut self, esc: &mut impl EscAccess) {
        if (!self.queue.is_empty() || !self.emergencies.is_empty()) && self.is_free(esc) {
            self.load_next(esc);
        }
    }

    /// Whether everything was fetched.
    pub(crate) fn is_idle(&mut self, esc: &mut impl EscAccess) -> bool {
        self.queue.is_empty() && self.is_free(esc)
    }

    /// Follows the master's repeat request: when it toggles, what was fetched last is offered again, before what waits.
    pub(crate) fn follow_repeat(&mut self, esc: &mut impl EscAccess, requested: bool) {
        if requested == self.repeat {
            return;
        }
        let free = self.is_free(esc);
        if let Some(fetched) = self.fetched.take() {
            if !free {
                self.unload(esc);
            }
            esc.write(self.back.start, &fetched);
            self.loaded = Some(fetched);
        }
        self.answer_repeat(esc, requested);
    }

    /// Whether the mailbox to the master is empty in the chip.
    fn is_free(&mut self, esc: &mut impl EscAccess) -> bool {
        if self.loaded.is_some() {
            let status = register::SM + MAILBOX_IN as u16 * register::SM_SIZE + sync_manager::STATUS;
            if esc.read_u8(status) & sync_manager::STATUS_FULL != 0 {
                return false;
            }
            self.fetched = self.loaded.take();
            self.loaded_emergency = None;
        }
        true
    }

    fn load_next(&mut self, esc: &mut impl EscAccess) {
        if let Some(message) = self.queue.pop_front() {
            self.load(esc, message);
        } else if let Some(emergency) = self.emergencies.next() {
            const TO_MASTER: Header = Header {
                length: 0,
                address: 0,
                channel: 0,
                protocol: Protocol::COE,
                counter: 0,
            };
            let parts: [&[u8]; 2] = [&Service::Emergency.header(), &emergency.bytes()];
            if let Some(message) = self.message(&TO_MASTER, Protocol::COE, &parts) {
                self.load(esc, message);
                self.loaded_emergency = Some(emergency);
            }
        }
    }

    /// Puts a message into the chip, with the next counter.
    fn load(&mut self, esc: &mut impl EscAccess, mut message: Message) {
        if let Some(kind) = message.get_mut(HEADER_SIZE - 1) {
            *kind = *kind & !COUNTER | self.counter << COUNTER_SHIFT;
        }
        self.counter = if self.counter == LAST_COUNTER { 1 } else { self.counter + 1 };
        esc.write(self.back.start, &message);
        self.loaded = Some(message);
    }

    /// Takes what lies in the chip back; it will be the first of its kind to be sent, and with the same counter if nothing new goes before.
    fn unload(&mut self, esc: &mut impl EscAccess) {
        empty(esc, MAILBOX_IN);
        self.answer_repeat(esc, self.repeat);
        let Some(message) = self.loaded.take() else { return };
        if let Some(kind) = message.get(HEADER_SIZE - 1) {
            self.counter = (kind & COUNTER) >> COUNTER_SHIFT;
        }
        match self.loaded_emergency.take() {
            Some(emergency) => self.emergencies.take_back(emergency),
            // Requests are taken only while the queue has room for this one too.
            None => _ = self.queue.push_front(message),
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
