//! A value on its way from the master.

use dictionary::AbortCode;

use super::subject::Subject;
use crate::device_objects::Bytes;

/// A download whose size was announced: what has come of it.
#[derive(Clone, Debug)]
pub(crate) struct Download {
    subject: Subject,
    size: usize,
    data: Bytes,
    /// The toggle of the next segment.
    toggle: bool,
}

impl Download {
    /// Begins a download of `size` bytes with the first of them, which may be none.
    ///
    /// # Errors
    /// 0x06070010 if more came than announced, or more than any object has.
    pub(super) fn new(subject: Subject, size: usize, first: &[u8]) -> Result<Self, AbortCode> {
        let mut download = Self {
            subject,
            size,
            data: Bytes::new(),
            toggle: false,
        };
        download.append(first)?;
        Ok(download)
    }

    /// What is downloaded.
    pub(super) fn subject(&self) -> Subject {
        self.subject
    }

    /// What has come.
    pub(crate) fn data(&self) -> &[u8] {
        &self.data
    }

    /// Whether everything announced has come.
    pub(crate) fn is_complete(&self) -> bool {
        self.data.len() == self.size
    }

    /// Takes a segment.
    ///
    /// # Errors
    /// 0x05030000 for the wrong toggle, 0x06070010 if more came than announced.
    pub(crate) fn segment(&mut self, toggle: bool, data: &[u8]) -> Result<(), AbortCode> {
        if toggle != self.toggle {
            return Err(AbortCode::ToggleNotAlternated);
        }
        self.toggle = !toggle;
        self.append(data)
    }

    fn append(&mut self, data: &[u8]) -> Result<(), AbortCode> {
        if data.len() > self.size - self.data.len() {
            return Err(AbortCode::LengthMismatch);
        }
        self.data.extend_from_slice(data).map_err(|_| AbortCode::LengthMismatch)
    }
}
