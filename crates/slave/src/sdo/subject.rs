//! What a transfer is about: one entry, or an object's entries by complete access.

use dictionary::AbortCode;
use wire::coe::Address;

use crate::application::Application;
use crate::device_objects::{Bytes, DeviceObjects};

/// What a transfer is about.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Subject {
    pub(super) address: Address,
    /// Whether all sub-indices from that of the address on are meant.
    pub(super) complete: bool,
}

impl Subject {
    /// The value.
    ///
    /// # Errors
    /// The abort code of the upload.
    pub(super) fn upload(self, objects: &DeviceObjects<'_, impl Application>) -> Result<Bytes, AbortCode> {
        if self.complete {
            objects.upload_complete(self.address)
        } else {
            objects.upload(self.address)
        }
    }

    /// Whether a download of `size` bytes can begin.
    ///
    /// # Errors
    /// The abort code of the download.
    pub(super) fn check_download(self, objects: &DeviceObjects<'_, impl Application>, size: usize) -> Result<(), AbortCode> {
        if self.complete {
            objects.check_complete_download(self.address, size)
        } else {
            objects.check_download(self.address, size)
        }
    }

    /// Replaces the value.
    ///
    /// # Errors
    /// The abort code of the download; all old values stay.
    pub(super) fn download(self, objects: &mut DeviceObjects<'_, impl Application>, data: &[u8]) -> Result<(), AbortCode> {
        if self.complete {
            objects.download_complete(self.address, data)
        } else {
            objects.download(self.address, data)
        }
    }
}
