//! Files that a device offers by FoE.

use core::fmt::{Arguments, Write};

use heapless::String;
use wire::foe::ErrorCode;

/// The longest line of a file that is read, in bytes.
pub const MAX_LINE: usize = 128;
/// The longest text of a [`FileError`], in bytes.
pub const MAX_ERROR_TEXT: usize = 96;

/// A piece of a file that is read, usually a line of text with its end.
pub type Line = String<MAX_LINE>;

/// A file of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct File {
    /// Its name.
    pub name: &'static str,
    /// Whether it can be written.
    pub writable: bool,
}

/// Why a file is not read or written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileError {
    /// The reason's code.
    pub code: ErrorCode,
    /// What is wrong, for the person who wanted the file.
    pub text: String<MAX_ERROR_TEXT>,
}

impl FileError {
    /// An error; what does not fit of its text is cut off.
    pub fn new(code: ErrorCode, reason: Arguments<'_>) -> Self {
        let mut text = Text(String::new());
        // Nothing else can fail than the room, and the text says most of it first.
        _ = text.write_fmt(reason);
        Self { code, text: text.0 }
    }
}

/// Takes as much of a text as fits.
struct Text(String<MAX_ERROR_TEXT>);

impl Write for Text {
    fn write_str(&mut self, part: &str) -> core::fmt::Result {
        part.chars()
            .try_for_each(|character| self.0.push(character).map_err(|_| core::fmt::Error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_reason_is_cut_off() {
        let error = FileError::new(ErrorCode::NotDefined, format_args!("{}{:0100}", "why: ", 7));
        assert_eq!(error.text.len(), MAX_ERROR_TEXT);
        assert!(error.text.starts_with("why: 000"));
    }
}
