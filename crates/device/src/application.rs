//! What the slave stack asks of the drive.

use dictionary::{AbortCode, Entry, MAX_VALUE_SIZE, Objects};
use drive::faults::Fault;
use drive::{Drive, DriveObjects};
use embedded_storage::nor_flash::NorFlash;
use slave::files::{File, FileError, Line};
use wire::coe::Emergency;

use crate::parameter_file::{self, ParameterFile};
use crate::{parameter_set, parameter_store};

/// The drive's objects, guarded by the drive's present state, and where they can be saved and backed up.
pub(crate) struct Application<'a, M> {
    pub(crate) drive: &'a Drive,
    pub(crate) objects: &'a mut DriveObjects,
    pub(crate) memory: &'a mut M,
    pub(crate) parameter_file: &'a mut ParameterFile,
}

impl<M> Objects for Application<'_, M> {
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

impl<M: NorFlash> slave::Application for Application<'_, M> {
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
        parameter_store::save(self.memory, &parameter_set::of(self.objects))
    }

    fn restore_defaults(&mut self) -> Result<(), AbortCode> {
        self.refuse_while_moving()?;
        parameter_store::save(self.memory, &parameter_set::delivery())
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

impl<M> Application<'_, M> {
    /// Parameters are saved and restored at standstill only (manual 2.1.5, 2.1.6).
    fn refuse_while_moving(&self) -> Result<(), AbortCode> {
        if self.drive.is_moving() {
            Err(AbortCode::DeviceState)
        } else {
            Ok(())
        }
    }
}
