//! Which CoE service a message is for.

use wire::coe::{HEADER_SIZE, SdoRequest, SdoResponse, Service, information};
use wire::mailbox::{Header, MailboxError};

use crate::application::Application;
use crate::configuration::Configuration;
use crate::device_objects::DeviceObjects;
use crate::information::{Information, InformationServer};
use crate::sdo::SdoServer;

/// The servers of CoE.
#[derive(Clone, Debug, Default)]
pub(crate) struct Servers {
    pub(crate) sdo: SdoServer,
    pub(crate) information: InformationServer,
}

/// What a message is answered with.
#[expect(
    clippy::large_enum_variant,
    reason = "it lives on the stack until it is queued, and there is no allocator to box it"
)]
pub(crate) enum Answer<'s> {
    /// Nothing: it was an abort.
    None,
    Sdo(SdoResponse<'s>),
    Information(Information),
}

impl Servers {
    /// Forgets all transfers under way.
    pub(crate) fn reset(&mut self) {
        self.sdo.reset();
        self.information.reset();
    }

    /// Serves the CoE message in `body`, the bytes after the mailbox header `from`; `capacity` is the length of the mailbox the answer
    /// goes to.
    ///
    /// # Errors
    /// The mailbox error the message is answered with.
    pub(crate) fn serve(
        &mut self,
        body: &[u8],
        from: &Header,
        objects: &mut DeviceObjects<'_, impl Application>,
        configuration: &Configuration,
        capacity: usize,
    ) -> Result<Answer<'_>, MailboxError> {
        let (&[_, service], body) = body.split_first_chunk::<HEADER_SIZE>().ok_or(MailboxError::SizeTooShort)?;
        match Service::from_code(service >> 4).ok_or(MailboxError::InvalidHeader)? {
            Service::SdoRequest => {
                let request = SdoRequest::parse(body).ok_or(MailboxError::SizeTooShort)?;
                Ok(self.sdo.serve(request, objects, capacity).map_or(Answer::None, Answer::Sdo))
            }
            Service::SdoInformation => {
                let request = information::Request::parse(body).ok_or(MailboxError::SizeTooShort)?;
                let answer = self.information.serve(request, from, objects, configuration, capacity);
                Ok(Answer::Information(answer))
            }
            Service::Emergency | Service::SdoResponse | Service::TxPdo | Service::RxPdo | Service::TxPdoRequest | Service::RxPdoRequest => {
                Err(MailboxError::ServiceNotSupported)
            }
        }
    }
}
