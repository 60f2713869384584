//! What the stack asks of the device.

use dictionary::{AbortCode, Objects};
use wire::coe::Emergency;
use wire::foe::ErrorCode;

use crate::files::{File, FileError, Line};

/// A device's objects from 0x2000 on, and what the stack's own objects need from the device.
pub trait Application: Objects {
    /// The error register, 0x1001 (CiA 301).
    fn error_register(&self) -> u8;

    /// The fault that is present, as an emergency message would tell it; code 0 while there is none. When the code changes, the master is
    /// told.
    fn emergency(&self) -> Emergency;

    /// Saves all parameters: 1 was written to 0x1010:01.
    ///
    /// # Errors
    /// The abort code with which the download ends.
    fn store_parameters(&mut self) -> Result<(), AbortCode>;

    /// Restores the parameters of delivery: 1 was written to 0x1011:01.
    ///
    /// # Errors
    /// The abort code with which the download ends.
    fn restore_defaults(&mut self) -> Result<(), AbortCode>;

    /// Whether the device's present state allows to write the object in `slot`, by SDO or by PDO.
    ///
    /// # Errors
    /// The abort code with which a download ends; a PDO leaves the object as it is.
    fn may_write(&self, slot: usize) -> Result<(), AbortCode> {
        let _ = slot;
        Ok(())
    }

    /// The device's files, beside the stack's own `eventlog.txt`. A file's position here is how the other functions name it.
    fn files(&self) -> &'static [File] {
        &[]
    }

    /// Appends line number `line`, counted from 0, of a file to the empty `out`, with its end; false if the file has no such line.
    fn file_line(&self, file: usize, line: usize, out: &mut Line) -> bool {
        let _ = (file, line, out);
        false
    }

    /// A writable file is going to be written. What was written of a file before, and not finished, is to be forgotten.
    ///
    /// # Errors
    /// Why it cannot be written now.
    fn begin_file(&mut self, file: usize) -> Result<(), FileError> {
        self.finish_file(file)
    }

    /// Takes the next bytes of the file; nothing shall come of them before it is finished.
    ///
    /// # Errors
    /// What is wrong with them; the transfer ends then.
    fn write_file(&mut self, file: usize, data: &[u8]) -> Result<(), FileError> {
        let _ = data;
        self.finish_file(file)
    }

    /// The file is there as a whole, and takes effect.
    ///
    /// # Errors
    /// Why it does not.
    fn finish_file(&mut self, file: usize) -> Result<(), FileError> {
        let _ = file;
        Err(FileError::new(ErrorCode::AccessDenied, format_args!("this file cannot be written")))
    }
}
