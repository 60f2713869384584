//! Lists of objects, message by message.

use dictionary::lookup::objects;
use dictionary::{Access, Entry};
use wire::coe::information::{Header, ListType, Opcode};

use super::{Data, Information};
use crate::objects::ENTRIES;

/// A list of which so many 16-bit words are sent: first its type, then indices or counts.
#[derive(Clone, Debug)]
pub(super) struct Listing {
    list: ListType,
    sent: usize,
}

impl Listing {
    pub(super) const fn new(list: ListType) -> Self {
        Self { list, sent: 0 }
    }

    /// The next message, with at most `room` bytes of data; the fixed mailbox limits leave room for a word at least.
    pub(super) fn next(&mut self, application: &'static [Entry], room: usize) -> Information {
        let words = (room / 2).max(1);
        let total = 1 + match self.list {
            ListType::Counts => ListType::COUNTED.len(),
            list => indices(list, application).count(),
        };
        let mut data = Data::new();
        let mut push = |word: u16| {
            // The mailbox bounds `words`.
            let _ = data.extend_from_slice(&word.to_le_bytes());
        };
        let kind = core::iter::once(self.list.code());
        match self.list {
            ListType::Counts => {
                let counts = ListType::COUNTED.map(|list| indices(list, application).count() as u16);
                kind.chain(counts).skip(self.sent).take(words).for_each(&mut push);
            }
            list => kind
                .chain(indices(list, application))
                .skip(self.sent)
                .take(words)
                .for_each(&mut push),
        }
        self.sent = (self.sent + words).min(total);
        Information {
            header: Header {
                opcode: Opcode::ListResponse,
                fragments_left: (total - self.sent).div_ceil(words) as u16,
            },
            data,
        }
    }
}

/// The indices of a list, ascending.
fn indices(list: ListType, application: &'static [Entry]) -> impl Iterator<Item = u16> {
    objects(ENTRIES)
        .chain(objects(application))
        .filter(move |entries| entries.iter().any(|entry| belongs(entry.access, list)))
        .map(|entries| entries[0].index)
}

/// Whether an entry with this access word puts its object on a list.
const fn belongs(access: Access, list: ListType) -> bool {
    match list {
        ListType::Counts | ListType::All => true,
        ListType::RxMappable => access.is_rx_mappable(),
        ListType::TxMappable => access.is_tx_mappable(),
        ListType::Backup => access.is_saved(),
        ListType::Settings => access.is_setting(),
    }
}
