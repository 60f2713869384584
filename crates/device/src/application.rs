//! What the slave stack asks of the drive.

use dictionary::{AbortCode, Entry, MAX_VALUE_SIZE, Objects};
use drive::faults::Fault;
use drive::{Drive, DriveObjects};
use slave::files::{File, FileError, Line};
use wire::coe::Emergency;

use crate::parameter_file::{self, ParameterFile};

/// The drive's objects, guarded by the drive's present state.
pub(crate) struct Application<'a> {
    pub(crate) drive: &'a Drive,
    pub(crate) objects: &'a mut DriveObjects,
    pub(crate) parameter_file: &'a mut ParameterFile,
}

impl Objects for Application<'_> {
    fn entries(&self) -> &'static [Entry] {
        DriveObjects::ENTRIES
    }

    fn load(&self, slot: usize, out: &mut [u8; MAX_VALUE_SIZE]) -> usize {
        self.objects.load(slot, out)
    }

    fn store(&mut self, slot: usize, data: &[u8]) -> Result<(), AbortCode> {
        self.drive.check_write(self.objects, slot, data)?;
        self.objects.store(slot, data)
    }
}

impl slave::Application for Application<'_> {
    fn error_register(&self) -> u8 {
        self.drive.fault().map_or(0, Fault::error_register)
    }

    fn emergency(&self) -> Emergency {
        let [low, high] = self.objects.alarm_code.to_le_bytes();
        Emergency {
            code: self.objects.error_code,
            register: self.error_register(),
            vendor: [low, high, 0, 0, 0],
        }
    }

    fn store_parameters(&mut self) -> Result<(), AbortCode> {
        self.refuse_while_moving()?;
        // There is no memory behind 0x1010 yet; a drive whose memory fails answers the same.
        Err(AbortCode::CannotStore)
    }

    fn restore_defaults(&mut self) -> Result<(), AbortCode> {
        self.refuse_while_moving()?;
        Err(AbortCode::CannotStore)
    }

    fn files(&self) -> &'static [File] {
        parameter_file::FILES
    }

    fn file_line(&self, _: usize, line: usize, out: &mut Line) -> bool {
        parameter_file::line(self.objects, line, out)
    }

    fn begin_file(&mut self, _: usize) -> Result<(), FileError> {
        self.parameter_file.begin(self.drive, self.objects)
    }

    fn write_file(&mut self, _: usize, data: &[u8]) -> Result<(), FileError> {
        self.parameter_file.take(data)
    }

    fn finish_file(&mut self, _: usize) -> Result<(), FileError> {
        self.parameter_file.finish(self.drive, self.objects)
    }
}

impl Application<'_> {
    /// Parameters are saved and restored at standstill only (manual 2.1.5, 2.1.6).
    fn refuse_while_moving(&self) -> Result<(), AbortCode> {
        if self.drive.is_moving() {
            Err(AbortCode::DeviceState)
        } else {
            Ok(())
        }
    }
}
