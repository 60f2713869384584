//! Which CoE service a message is for.

use wire::coe::{HEADER_SIZE, SdoRequest, SdoResponse, Service};
use wire::mailbox::MailboxError;

use crate::application::Application;
use crate::device_objects::DeviceObjects;
use crate::sdo::SdoServer;

/// Serves the CoE message in `body`, the bytes after the mailbox header; `capacity` is the length of the mailbox the answer goes to.
///
/// # Errors
/// The mailbox error the message is answered with.
pub(crate) fn serve<'s>(
    body: &[u8],
    sdo: &'s mut SdoServer,
    objects: &mut DeviceObjects<'_, impl Application>,
    capacity: usize,
) -> Result<Option<SdoResponse<'s>>, MailboxError> {
    let (&[_, service], body) = body.split_first_chunk::<HEADER_SIZE>().ok_or(MailboxError::SizeTooShort)?;
    match Service::from_code(service >> 4).ok_or(MailboxError::InvalidHeader)? {
        Service::SdoRequest => {
            let request = SdoRequest::parse(body).ok_or(MailboxError::SizeTooShort)?;
            Ok(sdo.serve(request, objects, capacity))
        }
        Service::Emergency
        | Service::SdoResponse
        | Service::TxPdo
        | Service::RxPdo
        | Service::TxPdoRequest
        | Service::RxPdoRequest
        | Service::SdoInformation => Err(MailboxError::ServiceNotSupported),
    }
}
