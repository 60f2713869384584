//! Finding entries by index and sub-index.

use crate::{AbortCode, Entry};

/// What stands at an index and sub-index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lookup {
    /// The entry at this position of the table.
    Slot(usize),
    /// Sub-index 0 of an object with sub-indices: the highest sub-index.
    Count(u8),
}

/// Finds what stands at `index` and `sub` in a table sorted by index and sub-index.
///
/// # Errors
/// No such object answers 0x06020000, no such sub-index 0x06090011.
pub fn lookup(entries: &[Entry], index: u16, sub: u8) -> Result<Lookup, AbortCode> {
    if let Ok(slot) = entries.binary_search_by_key(&(index, sub), |entry| (entry.index, entry.sub)) {
        return Ok(Lookup::Slot(slot));
    }
    let object = object(entries, index);
    match object.last() {
        None => Err(AbortCode::ObjectNotFound),
        Some(last) if sub == 0 => Ok(Lookup::Count(last.sub)),
        Some(_) => Err(AbortCode::SubIndexNotFound),
    }
}

/// All entries of the object at `index`; empty if there is none.
pub fn object(entries: &[Entry], index: u16) -> &[Entry] {
    let start = entries.partition_point(|entry| entry.index < index);
    let length = entries[start..].partition_point(|entry| entry.index == index);
    &entries[start..start + length]
}

/// The objects of a sorted table, one slice of entries each.
pub fn objects(entries: &[Entry]) -> impl Iterator<Item = &[Entry]> {
    entries.chunk_by(|a, b| a.index == b.index)
}
