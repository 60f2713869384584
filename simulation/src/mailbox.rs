//! The master's mailbox: SDO and file transfers, each answer owed while there is a cable and a mailbox.

use drive::DriveObjects;
use wire::al::AlState;
use wire::foe;
use wire::mailbox::Protocol;
use wire::register as reg;

use crate::Simulation;
use crate::acts::parameters::slot;
use crate::invariants::must;
use crate::master::{MAILBOX, MAILBOX_IN, MAILBOX_OUT};

/// Bit of a sync manager's status: the mailbox is full.
const FULL: u8 = 1 << 3;
/// Messages that may lie before an answer: emergencies.
const MOST_MESSAGES: usize = 12;
/// Bytes of a mailbox header.
const HEADER: usize = 6;
/// Bytes of the CoE header.
const COE: usize = 2;
/// The CoE service of an SDO request.
const SDO_REQUEST: u8 = 2;
/// The command of an SDO abort.
const ABORT: u8 = 0x80;
/// The bit of complete access in an SDO command.
const COMPLETE: u8 = 0x10;
/// Bytes of file in a packet that is not the last.
pub(crate) const PACKET: usize = MAILBOX as usize - HEADER - foe::HEADER_SIZE;

/// An answer to an SDO request: the response from its command on, or the abort code; nothing if there is no cable or no mailbox.
type Answer = Option<Result<Vec<u8>, u32>>;

impl Simulation {
    /// What lies in the master's mailbox.
    fn receive(&mut self) -> Option<Vec<u8>> {
        let status = self.read(reg::SM + reg::SM_SIZE + 5, 1)?;
        if status[0] & FULL == 0 {
            return None;
        }
        self.read(MAILBOX_IN, MAILBOX.into())
    }

    /// Whether the drive owes answers.
    fn is_owed(&self) -> bool {
        self.bus.is_connected() && self.al_state() != AlState::Init
    }

    /// Puts a message into the drive's mailbox. Returns whether it was taken.
    fn send(&mut self, protocol: Protocol, body: &[u8]) -> Result<bool, String> {
        let mut drained = 0;
        while drained < MOST_MESSAGES && self.receive().is_some() {
            drained += 1;
        }
        self.master.counter = self.master.counter % 7 + 1;
        let mut message = vec![body.len() as u8, 0, 0, 0, 0, self.master.counter << 4 | protocol.0];
        message.extend_from_slice(body);
        message.resize(MAILBOX.into(), 0);
        let owed = self.is_owed();
        let sent = self.write(MAILBOX_OUT, &message);
        must(sent || !owed, || "the mailbox takes no request".into())?;
        Ok(sent)
    }

    /// The body of the next message of a protocol that is an answer.
    fn answer(&mut self, protocol: Protocol, is_answer: impl Fn(&[u8]) -> bool) -> Option<Vec<u8>> {
        for _ in 0..MOST_MESSAGES {
            let message = self.receive()?;
            let length = usize::from(message[0]).min(message.len() - HEADER);
            let body = &message[HEADER..HEADER + length];
            if message[5] & 0x0F == protocol.0 && is_answer(body) {
                return Some(body.to_vec());
            }
        }
        None
    }

    /// Sends an SDO request of eight bytes or more.
    pub(crate) fn sdo(&mut self, request: &[u8]) -> Result<Answer, String> {
        const SDO: [u8; 2] = [2, 3];
        let body = [&[0, SDO_REQUEST << 4], request].concat();
        let owed = self.is_owed();
        if !self.send(Protocol::COE, &body)? {
            return Ok(None);
        }
        let answer = self.answer(Protocol::COE, |body| SDO.contains(&(body[1] >> 4)));
        must(answer.is_some() || !owed, || format!("no answer to SDO request {request:02X?}"))?;
        Ok(answer.map(|body| {
            let response = body[COE..].to_vec();
            match response[0] {
                ABORT => Err(u32::from_le_bytes([response[4], response[5], response[6], response[7]])),
                _ => Ok(response),
            }
        }))
    }

    /// Writes bytes of any number up to eight to an object. Nothing if there is no cable or no mailbox.
    pub(crate) fn download_bytes(&mut self, index: u16, sub: u8, value: &[u8]) -> Result<Option<Result<(), u32>>, String> {
        let [low, high] = index.to_le_bytes();
        let mut request;
        if (1..=4).contains(&value.len()) {
            request = vec![0x23 | (4 - value.len() as u8) << 2, low, high, sub];
            request.extend_from_slice(value);
            request.resize(8, 0);
        } else {
            request = vec![0x21, low, high, sub, value.len() as u8, 0, 0, 0];
            request.extend_from_slice(value);
        }
        let writes = self.bus.drive().memory().writes();
        let answer = self.sdo(&request)?;
        self.follow_memory(index, sub, writes, answer.as_ref().map(Result::is_ok))?;
        self.count(&answer);
        Ok(answer.map(|answer| answer.map(|_| ())))
    }

    fn count(&mut self, answer: &Answer) {
        match answer {
            Some(Ok(_)) => self.coverage.count("SDO taken"),
            Some(Err(_)) => self.coverage.count("SDO refused"),
            None => {}
        }
    }

    /// Writes a value that fits the object, and returns whether it was taken.
    pub(crate) fn download(&mut self, index: u16, sub: u8, value: i64) -> Result<bool, String> {
        let size = size_of_object(index, sub);
        let answer = self.download_bytes(index, sub, &value.to_le_bytes()[..size])?;
        Ok(answer == Some(Ok(())))
    }

    /// Writes a value in segments of `step` bytes, behind a first message without any; 8 and more make long segments.
    pub(crate) fn download_in_segments(
        &mut self,
        (index, sub, complete): (u16, u8, bool),
        value: &[u8],
        step: usize,
    ) -> Result<Option<Result<(), u32>>, String> {
        let [low, high] = index.to_le_bytes();
        let command = 0x21 | if complete { COMPLETE } else { 0 };
        let mut answer = self.sdo(&[command, low, high, sub, value.len() as u8, 0, 0, 0])?;
        let mut toggle = 0;
        let count = value.chunks(step).len();
        for (number, data) in (1..).zip(value.chunks(step)) {
            if !matches!(answer, Some(Ok(_))) {
                break;
            }
            let unused = 7_u8.saturating_sub(data.len() as u8);
            let mut segment = vec![toggle | unused << 1 | u8::from(number == count)];
            segment.extend_from_slice(data);
            segment.resize(segment.len().max(8), 0);
            answer = self.sdo(&segment)?;
            toggle ^= 0x10;
        }
        self.count(&answer);
        Ok(answer.map(|answer| answer.map(|_| ())))
    }

    /// Reads an object, or all its entries.
    pub(crate) fn upload_of(&mut self, index: u16, sub: u8, complete: bool) -> Result<Option<Result<Vec<u8>, u32>>, String> {
        let [low, high] = index.to_le_bytes();
        let command = 0x40 | if complete { COMPLETE } else { 0 };
        let answer = self.sdo(&[command, low, high, sub, 0, 0, 0, 0])?;
        Ok(answer.map(|answer| {
            answer.map(|response| match response[0] & 2 {
                0 => response[8..].to_vec(),
                _ => response[4..8 - usize::from(response[0] >> 2 & 3)].to_vec(),
            })
        }))
    }

    /// Reads an object, if it can be read.
    pub(crate) fn upload(&mut self, index: u16, sub: u8) -> Result<Option<Vec<u8>>, String> {
        Ok(self.upload_of(index, sub, false)?.and_then(Result::ok))
    }

    /// Sends a message of a file transfer and returns the answer, from the operation code on. None is owed to the last acknowledgement.
    pub(crate) fn file_message(&mut self, message: foe::Message<'_>) -> Result<Option<Vec<u8>>, String> {
        let (header, rest) = message.parts();
        if !self.send(Protocol::FOE, &[&header[..], rest].concat())? {
            return Ok(None);
        }
        Ok(self.answer(Protocol::FOE, |body| body.len() >= foe::HEADER_SIZE))
    }
}

/// Bytes of an object: of the drive's by its table, of the slave stack's by what this master writes.
pub(crate) fn size_of_object(index: u16, sub: u8) -> usize {
    match (slot(index, sub), index, sub) {
        (Some(slot), ..) => DriveObjects::ENTRIES[slot].size(),
        (None, 0x1600..=0x1AFF, 1..) => 4,
        (None, 0x1600..=0x1AFF | 0x1C12 | 0x1C13, 0) => 1,
        _ => 2,
    }
}
