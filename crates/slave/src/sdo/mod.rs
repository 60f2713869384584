//! The SDO server: one transfer at a time (ETG.1000.6, SDO services).
//!
//! | module | holds |
//! |---|---|
//! | `upload` | a value on its way to the master |
//! | `download` | a value on its way from the master |

mod download;
mod upload;

use dictionary::AbortCode;
use wire::coe::{Address, SdoRequest, SdoResponse};

use crate::application::Application;
use crate::device_objects::DeviceObjects;
use download::Download;
use upload::Upload;

/// The transfer under way, if there is one.
#[derive(Clone, Debug, Default)]
enum Transfer {
    #[default]
    None,
    Upload(Upload),
    Download(Download),
}

/// The server of SDO uploads and downloads.
#[derive(Clone, Debug, Default)]
pub(crate) struct SdoServer {
    transfer: Transfer,
}

impl SdoServer {
    /// Forgets the transfer under way.
    pub(crate) fn reset(&mut self) {
        self.transfer = Transfer::None;
    }

    /// Serves a request; `capacity` is the length of the mailbox the answer goes to. An abort of the master has no answer.
    pub(crate) fn serve(
        &mut self,
        request: SdoRequest<'_>,
        objects: &mut DeviceObjects<'_, impl Application>,
        capacity: usize,
    ) -> Option<SdoResponse<'_>> {
        let address = match request {
            SdoRequest::Abort => {
                self.reset();
                return None;
            }
            SdoRequest::Download { address, .. } | SdoRequest::Upload { address, .. } | SdoRequest::Unknown(address) => address,
            SdoRequest::DownloadSegment { .. } | SdoRequest::UploadSegment { .. } => self.address(),
        };
        let outcome = match request {
            SdoRequest::Download { complete: true, .. } | SdoRequest::Upload { complete: true, .. } => {
                Err(AbortCode::CompleteAccessUnsupported)
            }
            SdoRequest::Download { size, data, .. } => self.download(address, size, data, objects),
            SdoRequest::DownloadSegment { toggle, last, data } => self.download_segment(toggle, last, data, objects),
            SdoRequest::Upload { .. } => self.upload(address, objects),
            SdoRequest::UploadSegment { toggle } => self.check_upload_segment(toggle),
            SdoRequest::Abort | SdoRequest::Unknown(_) => Err(AbortCode::UnknownCommand),
        };
        match outcome {
            Ok(Reply::Downloaded) => Some(SdoResponse::Downloaded(address)),
            Ok(Reply::SegmentTaken { toggle }) => Some(SdoResponse::SegmentTaken { toggle }),
            Ok(Reply::Uploading) => self.next_of_upload(capacity),
            Err(code) => {
                self.reset();
                Some(SdoResponse::Abort {
                    address,
                    code: code.code(),
                })
            }
        }
    }

    /// What the transfer under way is about.
    fn address(&self) -> Address {
        match &self.transfer {
            Transfer::None => Address::default(),
            Transfer::Upload(upload) => upload.address(),
            Transfer::Download(download) => download.address(),
        }
    }

    fn upload(&mut self, address: Address, objects: &DeviceObjects<'_, impl Application>) -> Result<Reply, AbortCode> {
        self.transfer = Transfer::Upload(Upload::new(address, objects.upload(address)?));
        Ok(Reply::Uploading)
    }

    fn check_upload_segment(&self, toggle: bool) -> Result<Reply, AbortCode> {
        match &self.transfer {
            Transfer::Upload(upload) => upload.check_segment(toggle).map(|()| Reply::Uploading),
            Transfer::None | Transfer::Download(_) => Err(AbortCode::UnknownCommand),
        }
    }

    fn next_of_upload(&mut self, capacity: usize) -> Option<SdoResponse<'_>> {
        match &mut self.transfer {
            Transfer::Upload(upload) => Some(upload.next(capacity)),
            Transfer::None | Transfer::Download(_) => None,
        }
    }

    /// Begins a download, and ends it too when all data came with the request.
    fn download(
        &mut self,
        address: Address,
        size: u32,
        data: &[u8],
        objects: &mut DeviceObjects<'_, impl Application>,
    ) -> Result<Reply, AbortCode> {
        self.reset();
        let size = usize::try_from(size).map_err(|_| AbortCode::LengthMismatch)?;
        objects.check_download(address, size)?;
        let download = Download::new(address, size, data)?;
        if download.is_complete() {
            objects.download(address, download.data())?;
        } else {
            self.transfer = Transfer::Download(download);
        }
        Ok(Reply::Downloaded)
    }

    fn download_segment(
        &mut self,
        toggle: bool,
        last: bool,
        data: &[u8],
        objects: &mut DeviceObjects<'_, impl Application>,
    ) -> Result<Reply, AbortCode> {
        let Transfer::Download(download) = &mut self.transfer else {
            return Err(AbortCode::UnknownCommand);
        };
        download.segment(toggle, data)?;
        if last {
            if !download.is_complete() {
                return Err(AbortCode::LengthMismatch);
            }
            objects.download(download.address(), download.data())?;
            self.reset();
        }
        Ok(Reply::SegmentTaken { toggle })
    }
}

/// What a request is answered with when nothing went wrong.
enum Reply {
    Downloaded,
    SegmentTaken { toggle: bool },
    Uploading,
}
