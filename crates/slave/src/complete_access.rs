//! Complete access: all entries of an object in one transfer (ETG.1000.6, SDO services; ETG.1020, complete access).
//!
//! Sub-index 0 comes first, padded to 16 bits, unless the transfer begins at sub-index 1; the other entries follow packed, in the layout of
//! the data types that an ESI file lists. Sub-indices that do not exist take up no room.

use dictionary::lookup::object;
use dictionary::{AbortCode, Entry};
use wire::coe::Address;

use crate::application::Application;
use crate::bits;
use crate::configuration::MAX_OBJECT_SIZE;
use crate::device_objects::{APPLICATION, Bytes, DeviceObjects, load};
use crate::objects::ENTRIES;

/// Bits of sub-index 0 with its padding.
const COUNT_BITS: usize = 16;

/// An object as a transfer from sub-index 0 or 1 on carries it.
#[derive(Clone, Copy)]
struct Layout {
    index: u16,
    entries: &'static [Entry],
    /// Bits before sub-index 1.
    start: usize,
}

/// An entry behind sub-index 0 and its place.
struct Member {
    entry: &'static Entry,
    offset: usize,
}

impl Layout {
    /// The layout of the transfer that begins at `address`.
    ///
    /// # Errors
    /// 0x06020000 for an object that does not exist, 0x06010000 for an object of one value and for a transfer from sub-index 2 on,
    /// 0x06010004 for an object with entries that are no numbers.
    fn new(address: Address, application: &'static [Entry]) -> Result<Self, AbortCode> {
        let entries = entries(address.index, application);
        let Some(last) = entries.last() else {
            return Err(AbortCode::ObjectNotFound);
        };
        if !last.in_record() || address.sub > 1 {
            return Err(AbortCode::UnsupportedAccess);
        }
        if entries.iter().any(|entry| entry.data_type.bits().is_none()) {
            return Err(AbortCode::CompleteAccessUnsupported);
        }
        Ok(Self {
            index: address.index,
            entries,
            start: if address.sub == 0 { COUNT_BITS } else { 0 },
        })
    }

    /// The entries behind sub-index 0 up to the sub-index `count`.
    fn members(self, count: u8) -> impl Iterator<Item = Member> {
        let behind = self.entries.iter().filter(move |entry| entry.in_record() && entry.sub <= count);
        behind.scan(self.start, |end, entry| {
            let offset = *end;
            *end += usize::from(entry.bits);
            Some(Member { entry, offset })
        })
    }

    /// Bytes of the entries up to the sub-index `count`.
    fn size(self, count: u8) -> usize {
        let last = self.members(count).last();
        last.map_or(self.start, |member| member.offset + usize::from(member.entry.bits))
            .div_ceil(8)
    }

    /// Whether sub-index 0 can be written: a list of PDOs or of mapped objects.
    fn is_list(self) -> bool {
        self.index < APPLICATION && self.entries[0].sub == 0
    }

    /// The highest sub-index of the object's description.
    fn highest(self) -> u8 {
        self.entries.last().map_or(0, |entry| entry.sub)
    }

    fn address(self, sub: u8) -> Address {
        Address { index: self.index, sub }
    }
}

/// All entries of the object at `index`; empty if there is none.
pub(crate) fn entries(index: u16, application: &'static [Entry]) -> &'static [Entry] {
    object(if index < APPLICATION { ENTRIES } else { application }, index)
}

impl<A: Application> DeviceObjects<'_, A> {
    /// The values of an object's entries. Entries that cannot be read are zero, as long as one can be.
    ///
    /// # Errors
    /// Those of the object, see `Layout`; 0x06010004 for an object too long; those of an entry if none can be read.
    pub(crate) fn upload_complete(&self, address: Address) -> Result<Bytes, AbortCode> {
        let layout = Layout::new(address, self.application.entries())?;
        let count = load(self.area, self.application, layout.address(0), self.now)?;
        let count = count.first().copied().unwrap_or(0);
        let mut image = Bytes::new();
        image
            .resize(layout.size(count), 0)
            .map_err(|_| AbortCode::CompleteAccessUnsupported)?;
        if layout.start != 0 {
            image[0] = count;
        }
        let mut refusal = None;
        let mut readable = count == 0;
        for member in layout.members(count) {
            match self.upload(layout.address(member.entry.sub)) {
                Ok(value) => {
                    let mut number = [0; dictionary::MAX_VALUE_SIZE];
                    number[..value.len()].copy_from_slice(&value);
                    bits::insert(&mut image, member.offset, member.entry.bits as u8, number);
                    readable = true;
                }
                Err(code) => refusal = refusal.or(Some(code)),
            }
        }
        match refusal {
            Some(code) if !readable => Err(code),
            _ => Ok(image),
        }
    }

    /// Whether a download of `size` bytes to an object's entries can begin. Read-only entries take part in the layout and are ignored, as
    /// long as one can be written.
    ///
    /// # Errors
    /// Those of the object, see `Layout`; 0x06010002 if no entry can be written, 0x08000022 if one that can cannot in this state,
    /// 0x06070010 for another length than the layout's.
    pub(crate) fn check_complete_download(&self, address: Address, size: usize) -> Result<(), AbortCode> {
        let layout = Layout::new(address, self.application.entries())?;
        if layout.size(layout.highest()) > MAX_OBJECT_SIZE {
            return Err(AbortCode::CompleteAccessUnsupported);
        }
        if layout.is_list() {
            self.check_download(layout.address(0), 1)?;
            return (0..=layout.highest())
                .any(|count| layout.size(count) == size)
                .then_some(())
                .ok_or(AbortCode::LengthMismatch);
        }
        let mut writable = layout.members(layout.highest()).filter(is_writable).peekable();
        writable.peek().ok_or(AbortCode::ReadOnly)?;
        for member in writable {
            self.check_download(layout.address(member.entry.sub), member.entry.size())?;
        }
        if size == layout.size(layout.highest()) {
            Ok(())
        } else {
            Err(AbortCode::LengthMismatch)
        }
    }

    /// Replaces the values of all entries of an object that can be written, or none.
    ///
    /// # Errors
    /// Those of [`Self::check_complete_download`], and those of the first entry whose value is refused.
    pub(crate) fn download_complete(&mut self, address: Address, data: &[u8]) -> Result<(), AbortCode> {
        self.check_complete_download(address, data.len())?;
        let layout = Layout::new(address, self.application.entries())?;
        if layout.index >= APPLICATION {
            return self.replace_record(layout, address, data);
        }
        let before = self.area.clone();
        let outcome = if layout.is_list() {
            self.replace_list(layout, data)
        } else {
            self.store_members(layout, data).map_err(|(_, code)| code)
        };
        if outcome.is_err() {
            *self.area = before;
        }
        outcome
    }

    /// Count to 0, entries, count: the order in which single accesses have to come. From sub-index 1 on the count has to be 0 already.
    fn replace_list(&mut self, layout: Layout, data: &[u8]) -> Result<(), AbortCode> {
        let Some(&count) = data.first().filter(|_| layout.start != 0) else {
            let count = (0..=layout.highest()).find(|count| layout.size(*count) == data.len());
            return self.store_list(layout, data, count.ok_or(AbortCode::LengthMismatch)?);
        };
        if count > layout.highest() {
            return Err(AbortCode::ValueTooHigh);
        }
        if layout.size(count) != data.len() {
            return Err(AbortCode::LengthMismatch);
        }
        self.download(layout.address(0), &[0])?;
        self.store_list(layout, data, count)?;
        self.download(layout.address(0), &[count])
    }

    fn store_list(&mut self, layout: Layout, data: &[u8], count: u8) -> Result<(), AbortCode> {
        for member in layout.members(count) {
            let (value, size) = bits::extract(data, member.offset, member.entry.bits as u8);
            self.download(layout.address(member.entry.sub), &value[..size])?;
        }
        Ok(())
    }

    /// Writes the application's entries; if one is refused, those before it get their old values back, the last one first.
    fn replace_record(&mut self, layout: Layout, address: Address, data: &[u8]) -> Result<(), AbortCode> {
        let before = self.upload_complete(address)?;
        let Err((written, code)) = self.store_members(layout, data) else {
            return Ok(());
        };
        for position in (0..written).rev() {
            if let Some(member) = layout.members(layout.highest()).filter(is_writable).nth(position) {
                let (value, size) = bits::extract(&before, member.offset, member.entry.bits as u8);
                // What was the value before is one the object takes.
                let _ = self.download(layout.address(member.entry.sub), &value[..size]);
            }
        }
        Err(code)
    }

    /// Writes entry by entry; how many were written before the one that was refused, and why it was.
    fn store_members(&mut self, layout: Layout, data: &[u8]) -> Result<(), (usize, AbortCode)> {
        let writable = layout.members(layout.highest()).filter(is_writable);
        for (position, member) in writable.enumerate() {
            let (value, size) = bits::extract(data, member.offset, member.entry.bits as u8);
            self.download(layout.address(member.entry.sub), &value[..size])
                .map_err(|code| (position, code))?;
        }
        Ok(())
    }
}

fn is_writable(member: &Member) -> bool {
    member.entry.access.is_writable()
}
