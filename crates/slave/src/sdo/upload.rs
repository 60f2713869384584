//! A value on its way to the master.

use dictionary::AbortCode;
use wire::coe::{self, SdoResponse};
use wire::mailbox;

use super::subject::Subject;
use crate::device_objects::Bytes;

/// The longest value that is uploaded expedited.
const EXPEDITED: usize = 4;
/// Bytes before the data of the first response of a normal upload.
const FIRST_OVERHEAD: usize = mailbox::HEADER_SIZE + coe::HEADER_SIZE + coe::SDO_SIZE;
/// Bytes before the data of a segment.
const SEGMENT_OVERHEAD: usize = mailbox::HEADER_SIZE + coe::HEADER_SIZE + 1;

/// An upload: the value as it was when the upload began, and how much of it is on its way.
#[derive(Clone, Debug)]
pub(crate) struct Upload {
    subject: Subject,
    data: Bytes,
    sent: usize,
    /// `None` until the first response is out, then the toggle of the next segment.
    toggle: Option<bool>,
}

impl Upload {
    /// Begins the upload of a value.
    pub(super) fn new(subject: Subject, data: Bytes) -> Self {
        Self {
            subject,
            data,
            sent: 0,
            toggle: None,
        }
    }

    /// What is uploaded.
    pub(super) fn subject(&self) -> Subject {
        self.subject
    }

    /// Whether a segment with this toggle may be asked for.
    ///
    /// # Errors
    /// 0x05040001 when nothing is left, 0x05030000 for the wrong toggle.
    pub(crate) fn check_segment(&self, toggle: bool) -> Result<(), AbortCode> {
        if self.sent == self.data.len() {
            return Err(AbortCode::UnknownCommand);
        }
        if self.toggle == Some(toggle) {
            Ok(())
        } else {
            Err(AbortCode::ToggleNotAlternated)
        }
    }

    /// The next response: the first, or a segment; `capacity` is the length of the mailbox.
    pub(crate) fn next(&mut self, capacity: usize) -> SdoResponse<'_> {
        let Some(toggle) = self.toggle else { return self.first(capacity) };
        self.toggle = Some(!toggle);
        let data = take(&self.data, &mut self.sent, capacity.saturating_sub(SEGMENT_OVERHEAD));
        SdoResponse::Segment {
            toggle,
            last: self.sent == self.data.len(),
            data,
        }
    }

    fn first(&mut self, capacity: usize) -> SdoResponse<'_> {
        self.toggle = Some(false);
        let Subject { address, complete } = self.subject;
        let size = self.data.len();
        if (1..=EXPEDITED).contains(&size) {
            return SdoResponse::Expedited {
                address,
                complete,
                data: take(&self.data, &mut self.sent, size),
            };
        }
        let data = take(&self.data, &mut self.sent, capacity.saturating_sub(FIRST_OVERHEAD));
        SdoResponse::Normal {
            address,
            complete,
            size: size as u32,
            data,
        }
    }
}

/// The next bytes of `data`, at most `room`.
fn take<'a>(data: &'a Bytes, sent: &mut usize, room: usize) -> &'a [u8] {
    let start = *sent;
    *sent = data.len().min(start + room);
    &data[start..*sent]
}
