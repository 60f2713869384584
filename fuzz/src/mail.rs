//! Mailbox messages of a plain master to the first drive of a bus.

use device::layout::{MAILBOX_MAX, SYNC_MANAGERS};
use wire::coe::{HEADER_SIZE as COE_HEADER, SDO_SIZE, Service, information};
use wire::foe;
use wire::mailbox::{HEADER_SIZE, Header, MailboxError, Protocol};

use crate::bus::Bus;

/// Messages that may lie between two others at the most: a list of all objects in the shortest mailbox.
const MOST_MESSAGES: usize = 256;

/// The master's end of the mailboxes.
#[derive(Clone, Debug)]
pub struct Postbox {
    /// Bytes of each mailbox.
    pub length: u16,
    /// The counter of the last message sent.
    counter: u8,
}

/// A message from the drive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Letter {
    /// Its header.
    pub header: Header,
    /// The bytes that the header tells of.
    pub body: Vec<u8>,
}

impl Letter {
    /// A message out of a whole mailbox.
    ///
    /// # Panics
    /// If it is none that a drive may send.
    fn parse(mailbox: &[u8]) -> Self {
        let header = Header::parse(mailbox).expect("a mailbox has room for a header");
        let length = usize::from(header.length);
        let body = mailbox[HEADER_SIZE..]
            .get(..length)
            .expect("a message must fit its mailbox")
            .to_vec();
        assert!((1..=7).contains(&header.counter), "counter {}", header.counter);
        let allowed = match header.protocol {
            Protocol::ERROR => body.len() == MailboxError::Syntax.bytes().len(),
            Protocol::COE => is_coe_of_a_drive(&body),
            Protocol::FOE => matches!(
                foe::Message::parse(&body),
                Some(foe::Message::Data { .. } | foe::Message::Ack { .. } | foe::Message::Error { .. } | foe::Message::Busy { .. })
            ),
            _ => false,
        };
        assert!(allowed, "{header:?} {body:02X?}");
        Self { header, body }
    }

    /// The CoE service, if it is a CoE message.
    pub fn service(&self) -> Option<Service> {
        (self.header.protocol == Protocol::COE)
            .then(|| Service::from_code(self.body[1] >> 4))
            .flatten()
    }
}

/// Whether a drive may send this after the mailbox header.
fn is_coe_of_a_drive(body: &[u8]) -> bool {
    let service = body.get(1).and_then(|service| Service::from_code(service >> 4));
    let least = match service {
        Some(Service::Emergency | Service::SdoRequest | Service::SdoResponse) => SDO_SIZE,
        Some(Service::SdoInformation) => information::HEADER_SIZE,
        _ => return false,
    };
    body.len() >= COE_HEADER + least
}

impl Postbox {
    /// Mailboxes of this length that nothing was sent through yet.
    pub const fn new(length: u16) -> Self {
        Self { length, counter: 0 }
    }

    /// The counter of the next message.
    pub fn next_counter(&mut self) -> u8 {
        self.counter = self.counter % 7 + 1;
        self.counter
    }

    /// Sends a message of a protocol; whether the mailbox was empty.
    pub fn send(&mut self, bus: &mut Bus, protocol: Protocol, body: &[u8]) -> bool {
        let header = Header {
            length: body.len() as u16,
            address: 0,
            channel: 0,
            protocol,
            counter: self.next_counter(),
        };
        self.put(bus, &[&header.bytes()[..], body].concat())
    }

    /// Sends a CoE message; whether the mailbox was empty.
    pub fn send_coe(&mut self, bus: &mut Bus, service: Service, body: &[u8]) -> bool {
        self.send(bus, Protocol::COE, &[&service.header()[..], body].concat())
    }

    /// Writes a whole mailbox that begins with these bytes; whether the mailbox was empty.
    pub fn put(&self, bus: &mut Bus, bytes: &[u8]) -> bool {
        let mut mailbox = bytes.to_vec();
        mailbox.resize(self.length.into(), 0);
        bus.write(SYNC_MANAGERS[0].start, &mailbox)
    }

    /// Reads the mailbox, if there is something in it.
    ///
    /// # Panics
    /// If there is something that no drive may send.
    pub fn fetch(&self, bus: &mut Bus) -> Option<Letter> {
        let mut mailbox = [0; MAILBOX_MAX as usize];
        let mailbox = &mut mailbox[..self.length.into()];
        bus.read(SYNC_MANAGERS[1].start, mailbox).then(|| Letter::parse(mailbox))
    }

    /// Reads until nothing is left.
    ///
    /// # Panics
    /// If there is no end of it.
    pub fn fetch_all(&self, bus: &mut Bus) -> Vec<Letter> {
        let letters: Vec<_> = std::iter::from_fn(|| self.fetch(bus)).take(MOST_MESSAGES + 1).collect();
        assert!(letters.len() <= MOST_MESSAGES, "there is no end of messages");
        letters
    }
}

/// Sees that a drive in PREOP answers a master that does nothing unusual: uploads 0x1000.
///
/// # Panics
/// If it does not.
pub fn assert_answers(bus: &mut Bus, length: u16) {
    let mut postbox = Postbox::new(length);
    assert!(postbox.send_coe(bus, Service::SdoRequest, &[0x40, 0x00, 0x10, 0, 0, 0, 0, 0]));
    let answers: Vec<_> = postbox
        .fetch_all(bus)
        .into_iter()
        .filter(|letter| letter.service() != Some(Service::Emergency))
        .collect();
    let [answer] = answers.as_slice() else { panic!("{answers:?}") };
    let [t0, t1, t2, t3] = device::identity::DEVICE_TYPE.to_le_bytes();
    assert_eq!(answer.body, [0, 0x30, 0x43, 0x00, 0x10, 0, t0, t1, t2, t3]);
}
