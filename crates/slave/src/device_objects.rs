//! The stack's dictionary and the application's as one, with access rights by AL state.

use dictionary::{AbortCode, Entry, Lookup, MAX_VALUE_SIZE, lookup};
use heapless::Vec;
use wire::Nanos;
use wire::al::AlState;
use wire::coe::Address;

use crate::application::Application;
use crate::communication_area::CommunicationArea;
use crate::configuration::MAX_OBJECT_SIZE;
use crate::objects::{DIAGNOSIS_HISTORY, ENTRIES, FixedObjects};

/// The value of one object.
pub(crate) type Bytes = Vec<u8, MAX_OBJECT_SIZE>;

/// The first index that is the application's.
pub(crate) const APPLICATION: u16 = 0x2000;

/// What stands at an index and sub-index.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Located {
    /// A slot of the application's table.
    Application(usize, &'static Entry),
    /// A slot of [`FixedObjects`].
    Fixed(usize, &'static Entry),
    /// Another of the stack's entries.
    Own(&'static Entry),
    /// The highest sub-index of an object.
    Count(u8),
}

/// Finds what stands at an index and sub-index of the device.
///
/// # Errors
/// No such object answers 0x06020000, no such sub-index 0x06090011.
pub(crate) fn locate(index: u16, sub: u8, application: &'static [Entry]) -> Result<Located, AbortCode> {
    if index >= APPLICATION {
        return Ok(match lookup(application, index, sub)? {
            Lookup::Slot(slot) => Located::Application(slot, &application[slot]),
            Lookup::Count(count) => Located::Count(count),
        });
    }
    if let Ok(Lookup::Slot(slot)) = lookup(FixedObjects::ENTRIES, index, sub) {
        return Ok(Located::Fixed(slot, &FixedObjects::ENTRIES[slot]));
    }
    Ok(match lookup(ENTRIES, index, sub)? {
        Lookup::Slot(slot) => Located::Own(&ENTRIES[slot]),
        Lookup::Count(count) => Located::Count(count),
    })
}

/// The value at an address, without regard to access rights.
///
/// # Errors
/// The abort code of an upload.
pub(crate) fn load(area: &CommunicationArea, application: &impl Application, address: Address, now: Nanos) -> Result<Bytes, AbortCode> {
    let mut out = [0; MAX_VALUE_SIZE];
    let size = match locate(address.index, address.sub, application.entries())? {
        Located::Application(slot, _) => application.load(slot, &mut out),
        Located::Fixed(slot, _) => area.load_fixed(slot, application.error_register(), now, &mut out),
        Located::Own(entry) => return area.load(entry),
        Located::Count(count) => {
            out[0] = count;
            1
        }
    };
    Bytes::from_slice(out.get(..size).unwrap_or_default()).map_err(|_| AbortCode::ObjectTooLong)
}

/// Both dictionaries at one instant, as an SDO server sees them.
pub(crate) struct DeviceObjects<'a, A> {
    pub(crate) area: &'a mut CommunicationArea,
    pub(crate) application: &'a mut A,
    pub(crate) state: AlState,
    pub(crate) now: Nanos,
}

impl<A: Application> DeviceObjects<'_, A> {
    /// The value of an object.
    ///
    /// # Errors
    /// The abort code of the upload.
    pub(crate) fn upload(&self, address: Address) -> Result<Bytes, AbortCode> {
        if let Some(entry) = self.entry(address)? {
            if !entry.access.is_readable() {
                return Err(AbortCode::WriteOnly);
            }
            self.check_state(entry.access.bits())?;
        }
        load(self.area, self.application, address, self.now)
    }

    /// The master has read an object: it knows a diagnosis message then.
    pub(crate) fn was_read(&mut self, address: Address) {
        if address.index == DIAGNOSIS_HISTORY {
            self.area.log.was_read(address.sub);
        }
    }

    /// Whether a download of `size` bytes can begin.
    ///
    /// # Errors
    /// The abort code of the download.
    pub(crate) fn check_download(&self, address: Address, size: usize) -> Result<(), AbortCode> {
        let located = locate(address.index, address.sub, self.application.entries())?;
        let entry = match located {
            Located::Application(_, entry) | Located::Fixed(_, entry) | Located::Own(entry) => entry,
            Located::Count(_) => return Err(AbortCode::ReadOnly),
        };
        if !entry.access.is_writable() {
            return Err(AbortCode::ReadOnly);
        }
        self.check_state(entry.access.bits() >> 3)?;
        if size != entry.size() {
            return Err(AbortCode::LengthMismatch);
        }
        if let Located::Application(slot, _) = located {
            self.application.may_write(slot)
        } else {
            Ok(())
        }
    }

    /// Replaces the value of an object.
    ///
    /// # Errors
    /// The abort code of the download; the old value stays.
    pub(crate) fn download(&mut self, address: Address, data: &[u8]) -> Result<(), AbortCode> {
        self.check_download(address, data.len())?;
        let application = self.application.entries();
        match locate(address.index, address.sub, application)? {
            Located::Application(slot, _) => self.application.store(slot, data),
            Located::Fixed(slot, _) => self.area.store_fixed(slot, data, self.application, self.now),
            Located::Own(entry) => self.area.store(entry, data, application),
            Located::Count(_) => Err(AbortCode::ReadOnly),
        }
    }

    /// The entry at an address; `None` for a derived sub-index 0, which everybody may read.
    fn entry(&self, address: Address) -> Result<Option<&'static Entry>, AbortCode> {
        Ok(match locate(address.index, address.sub, self.application.entries())? {
            Located::Application(_, entry) | Located::Fixed(_, entry) | Located::Own(entry) => Some(entry),
            Located::Count(_) => None,
        })
    }

    /// Whether the bit of the present state is set in bits 2:0, PREOP, SAFEOP and OP, of an access word.
    fn check_state(&self, rights: u16) -> Result<(), AbortCode> {
        let bit = match self.state {
            AlState::SafeOp => 1 << 1,
            AlState::Op => 1 << 2,
            AlState::Init | AlState::PreOp | AlState::Boot => 1 << 0,
        };
        if rights & bit != 0 { Ok(()) } else { Err(AbortCode::DeviceState) }
    }
}
