//! The SDO server: one transfer at a time (ETG.1000.6, SDO services).
//!
//! | module | holds |
//! |---|---|
//! | `upload` | a value on its way to the master |
//! | `download` | a value on its way from the master |
//! | `subject` | what a transfer is about: one entry, or an object's entries by complete access |

mod download;
mod subject;
mod upload;

use dictionary::AbortCode;
use wire::coe::{SdoRequest, SdoResponse};

use crate::application::Application;
use crate::device_objects::DeviceObjects;
use download::Download;
use subject::Subject;
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
        let subject = match request {
            SdoRequest::Abort => {
                self.reset();
                return None;
            }
            SdoRequest::Download { address, complete, .. } | SdoRequest::Upload { address, complete } => Subject { address, complete },
            SdoRequest::Unknown(address) => Subject { address, complete: false },
            SdoRequest::DownloadSegment { .. } | SdoRequest::UploadSegment { .. } => self.subject(),
        };
        let outcome = match request {
            SdoRequest::Download { size, data, .. } => self.download(subject, size, data, objects),
            SdoRequest::DownloadSegment { toggle, last, data } => self.download_segment(toggle, last, data, objects),
            SdoRequest::Upload { .. } => self.upload(subject, objects),
            SdoRequest::UploadSegment { toggle } => self.check_upload_segment(toggle),
            SdoRequest::Abort | SdoRequest::Unknown(_) => Err(AbortCode::UnknownCommand),
        };
        let address = subject.address;
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
    fn subject(&self) -> Subject {
        match &self.transfer {
            Transfer::None => Subject::default(),
            Transfer::Upload(upload) => upload.subject(),
            Transfer::Download(download) => download.subject(),
        }
    }

    fn upload(&mut self, subject: Subject, objects: &mut DeviceObjects<'_, impl Application>) -> Result<Reply, AbortCode> {
        self.transfer = Transfer::Upload(Upload::new(subject, subject.upload(objects)?));
        objects.was_read(subject.address);
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
        subject: Subject,
        size: u32,
        data: &[u8],
        objects: &mut DeviceObjects<'_, impl Application>,
    ) -> Result<Reply, AbortCode> {
        self.reset();
        let size = usize::try_from(size).map_err(|_| AbortCode::LengthMismatch)?;
        subject.check_download(objects, size)?;
        let download = Download::new(subject, size, data)?;
        if download.is_complete() {
            subject.download(objects, download.data())?;
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
            download.subject().download(objects, download.data())?;
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
