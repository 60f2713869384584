//! SDO information: which objects there are, and what is known of them (ETG.1000.6, SDO information services).
//!
//! | module | holds |
//! |---|---|
//! | here | requests and their answers |
//! | `list` | lists of objects, message by message |
//! | `description` | what an object or an entry is |

mod description;
mod list;

use dictionary::{AbortCode, Entry};
use heapless::Vec;
use wire::coe::information::{HEADER_SIZE as INFORMATION_HEADER_SIZE, Header, ListType, Opcode, Request};
use wire::{coe, mailbox};

use crate::application::Application;
use crate::configuration::{Configuration, MAX_MAILBOX};
use crate::device_objects::DeviceObjects;
use list::Listing;

/// Bytes of a message before the data.
const OVERHEAD: usize = mailbox::HEADER_SIZE + coe::HEADER_SIZE + INFORMATION_HEADER_SIZE;

/// A message of SDO information.
pub(crate) struct Information {
    pub(crate) header: Header,
    pub(crate) data: Data,
}

type Data = Vec<u8, MAX_MAILBOX>;

/// The server of SDO information.
#[derive(Clone, Debug, Default)]
pub(crate) struct InformationServer {
    /// The list of which messages are still to be sent, and the mailbox header of the request for it.
    listing: Option<(mailbox::Header, Listing)>,
}

impl InformationServer {
    /// Forgets the list under way.
    pub(crate) fn reset(&mut self) {
        self.listing = None;
    }

    /// Whether a list is not finished.
    pub(crate) const fn has_more(&self) -> bool {
        self.listing.is_some()
    }

    /// Serves a request that came with the mailbox header `from`; `capacity` is the length of the mailbox the answer goes to.
    pub(crate) fn serve(
        &mut self,
        request: Request,
        from: &mailbox::Header,
        objects: &DeviceObjects<'_, impl Application>,
        configuration: &Configuration,
        capacity: usize,
    ) -> Information {
        let room = room(capacity);
        let answer = match request {
            Request::List { list } => return self.begin_list(list, from, objects.application.entries(), room),
            Request::Object { index } => {
                description::object(index, objects.application.entries(), room).map(|data| (Opcode::ObjectResponse, data))
            }
            Request::Entry { index, sub, values } => {
                description::entry(index, sub, values, objects, configuration, room).map(|data| (Opcode::EntryResponse, data))
            }
            Request::Unknown => Err(AbortCode::UnknownCommand),
        };
        match answer {
            Ok((opcode, data)) => Information {
                header: whole(opcode),
                data,
            },
            Err(code) => error(code),
        }
    }

    fn begin_list(&mut self, list: u16, from: &mailbox::Header, application: &'static [Entry], room: usize) -> Information {
        let Some(list) = ListType::from_code(list) else {
            return error(AbortCode::UnsupportedAccess);
        };
        let mut listing = Listing::new(list);
        let first = listing.next(application, room);
        self.listing = (first.header.fragments_left != 0).then_some((*from, listing));
        first
    }

    /// The next message of the list under way, and the mailbox header of the request for it.
    pub(crate) fn next(&mut self, application: &'static [Entry], capacity: usize) -> Option<(mailbox::Header, Information)> {
        let (from, listing) = self.listing.as_mut()?;
        let (from, message) = (*from, listing.next(application, room(capacity)));
        if message.header.fragments_left == 0 {
            self.listing = None;
        }
        Some((from, message))
    }
}

/// Bytes of data that a message in a mailbox of this length can carry.
fn room(capacity: usize) -> usize {
    capacity.min(MAX_MAILBOX).saturating_sub(OVERHEAD)
}

/// The header of an answer of one message.
const fn whole(opcode: Opcode) -> Header {
    Header { opcode, fragments_left: 0 }
}

fn error(code: AbortCode) -> Information {
    Information {
        header: whole(Opcode::Error),
        data: Data::from_slice(&code.code().to_le_bytes()).unwrap_or_default(),
    }
}
