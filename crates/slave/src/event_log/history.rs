//! The log as object 0x10F3, diagnosis history, in overwrite mode (ETG.1020).

use dictionary::AbortCode;

use super::{CAPACITY, EventLog, Record, Severity, event};
use crate::device_objects::Bytes;

/// The sub-index of the first message.
pub(crate) const FIRST_MESSAGE: u8 = 6;
/// Bytes of the code, flags, text number and time of a message.
const HEAD_SIZE: usize = 16;
/// Bytes of a parameter: its type and a 16-bit value.
const PARAMETER_SIZE: usize = 4;
/// Bytes of a message; behind the last of its parameters are zeros.
pub(crate) const MESSAGE_SIZE: usize = HEAD_SIZE + event::MAX_PARAMETERS * PARAMETER_SIZE;

/// Bit of a message's flags: its time is the device's own, not that of the distributed clock.
const LOCAL_TIME: u16 = 1 << 4;
/// The type of a parameter: UNSIGNED16.
const UNSIGNED_16: u16 = 0x0006;

/// Bits of 0x10F3:05 that can be written, one for each severity in the order of their codes: messages of that kind are left out.
const LEAVE_OUT: [u16; 3] = [1 << 1, 1 << 2, 1 << 3];
/// Bit of 0x10F3:05: a message that was not acknowledged has made way for a newer one.
const OVERWRITTEN: u16 = 1 << 5;

const NAME_SIZE: usize = 21;
const NAME_BYTES: [[u8; NAME_SIZE]; CAPACITY] = {
    let mut names = [*b"Diagnosis Message 000"; CAPACITY];
    let mut i = 0;
    while i < CAPACITY {
        let number = i as u8 + 1;
        names[i][NAME_SIZE - 2] = b'0' + number / 10;
        names[i][NAME_SIZE - 1] = b'0' + number % 10;
        i += 1;
    }
    names
};

/// The names of the messages.
pub(crate) const NAMES: [&str; CAPACITY] = {
    static BYTES: [[u8; NAME_SIZE]; CAPACITY] = NAME_BYTES;
    let mut names = [""; CAPACITY];
    let mut i = 0;
    while i < CAPACITY {
        names[i] = match core::str::from_utf8(&BYTES[i]) {
            Ok(name) => name,
            Err(_) => panic!("digits are text"),
        };
        i += 1;
    }
    names
};

/// What a client of 0x10F3 has seen, and what it wants to see.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Acknowledgement {
    /// 0x10F3:03; 0 for none.
    newest: u8,
    /// 0x10F3:04.
    news: bool,
    /// 0x10F3:05.
    flags: u16,
}

impl Acknowledgement {
    pub(super) const fn leaves_out(self, severity: Severity) -> bool {
        self.flags & LEAVE_OUT[severity as usize] != 0
    }

    pub(super) const fn added(&mut self) {
        self.news = true;
    }

    /// The message at `place` has made way for a newer one.
    pub(super) fn overwritten(&mut self, place: usize) {
        if self.newest == 0 {
            self.flags |= OVERWRITTEN;
        } else if self.newest == sub_index(place) {
            self.newest = 0;
        }
    }

    pub(super) const fn cleared(&mut self) {
        self.newest = 0;
        self.news = false;
        self.flags &= !OVERWRITTEN;
    }
}

/// The sub-index of the message at a place of the log, which is less than [`CAPACITY`].
const fn sub_index(place: usize) -> u8 {
    FIRST_MESSAGE + place as u8
}

impl EventLog {
    /// 0x10F3:00: the sub-index of the last message.
    pub(crate) fn highest(&self) -> u8 {
        FIRST_MESSAGE - 1 + self.records.len() as u8
    }

    /// 0x10F3:02: the sub-index of the newest message; 0 for none.
    pub(crate) fn newest_message(&self) -> u8 {
        if self.records.is_empty() { 0 } else { sub_index(self.newest) }
    }

    /// 0x10F3:03: the sub-index of the newest message that was acknowledged; 0 for none.
    pub(crate) const fn acknowledged_message(&self) -> u8 {
        self.acknowledgement.newest
    }

    /// 0x10F3:04: whether the newest message was neither read nor acknowledged.
    pub(crate) const fn has_news(&self) -> bool {
        self.acknowledgement.news
    }

    /// 0x10F3:05.
    pub(crate) const fn flags(&self) -> u16 {
        self.acknowledgement.flags
    }

    /// The message at a sub-index.
    ///
    /// # Errors
    /// 0x06090011 if there is none.
    pub(crate) fn message(&self, sub: u8) -> Result<Bytes, AbortCode> {
        let place = usize::from(sub).checked_sub(FIRST_MESSAGE.into());
        let record = place.and_then(|place| self.records.get(place)).ok_or(AbortCode::SubIndexNotFound)?;
        message(record).ok_or(AbortCode::ObjectTooLong)
    }

    /// A client has read a message: the newest is no news then.
    pub(crate) fn was_read(&mut self, sub: u8) {
        if sub == self.newest_message() {
            self.acknowledgement.news = false;
        }
    }

    /// Acknowledges all messages up to the one at a sub-index; 0 forgets all.
    ///
    /// # Errors
    /// 0x06090030 for a sub-index without a message.
    pub(crate) fn acknowledge(&mut self, sub: u8) -> Result<(), AbortCode> {
        match sub {
            0 => self.clear(),
            _ if (FIRST_MESSAGE..=self.highest()).contains(&sub) => {
                self.acknowledgement.newest = sub;
                self.acknowledgement.flags &= !OVERWRITTEN;
                self.was_read(sub);
            }
            _ => return Err(AbortCode::ValueRange),
        }
        Ok(())
    }

    /// Chooses which kinds of messages are left out from now on. The bit that tells of lost messages is not the client's and may have any
    /// value.
    ///
    /// # Errors
    /// 0x06090030 for other bits: faults are sent as emergencies in any case, and there is no acknowledge mode.
    pub(crate) fn set_flags(&mut self, flags: u16) -> Result<(), AbortCode> {
        let writable = LEAVE_OUT[0] | LEAVE_OUT[1] | LEAVE_OUT[2];
        if flags & !(writable | OVERWRITTEN) != 0 {
            return Err(AbortCode::ValueRange);
        }
        self.acknowledgement.flags = flags & writable | self.acknowledgement.flags & OVERWRITTEN;
        Ok(())
    }
}

/// A diagnosis message, all values little-endian. It fits, so `None` is never seen.
fn message(record: &Record) -> Option<Bytes> {
    let parameters = record.event.parameters();
    let flags = record.event.severity() as u16 | LOCAL_TIME | (parameters.len() as u16) << 8;
    let mut bytes = Bytes::new();
    let mut put = |part: &[u8]| bytes.extend_from_slice(part).ok();
    put(&record.event.diagnosis_code().to_le_bytes())?;
    put(&flags.to_le_bytes())?;
    put(&record.event.text_id().to_le_bytes())?;
    put(&record.time.to_le_bytes())?;
    for parameter in parameters {
        put(&UNSIGNED_16.to_le_bytes())?;
        put(&parameter.to_le_bytes())?;
    }
    bytes.resize(MESSAGE_SIZE, 0).ok()?;
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::super::Event;
    use super::*;

    #[test]
    fn a_message_is_laid_out_as_etg_1020_has_it() {
        let record = Record {
            number: 7,
            time: 0x0102_0304_0506_0708,
            event: Event::Fault { code: 0x3110, register: 5 },
        };
        let expected = [
            0x00, 0xE8, 0x10, 0x31, 0x12, 0x02, 0x04, 0x00, 8, 7, 6, 5, 4, 3, 2, 1, 6, 0, 0x10, 0x31, 6, 0, 5, 0, 0, 0, 0, 0,
        ];
        assert_eq!(message(&record).unwrap()[..], expected);
    }

    #[test]
    fn messages_are_named_by_number() {
        assert_eq!((NAMES[0], NAMES[CAPACITY - 1]), ("Diagnosis Message 001", "Diagnosis Message 032"));
    }
}
