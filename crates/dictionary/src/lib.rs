//! Object dictionaries as tables: one row an object, everything else derived from it.
//!
//! | module | holds |
//! |---|---|
//! | [`entry`] | [`Entry`], [`DataType`], [`Access`]: what is known of an object before anybody reads it |
//! | [`abort`] | [`AbortCode`]: why an access was refused |
//! | [`mod@unit`] | units as numbers |
//! | [`value`] | [`Value`]: Rust types that an object can have, and their bytes |
//! | [`mod@lookup`] | finding an entry by index and sub-index, walking a dictionary object by object |
//! | [`check`] | what is verified of a table at compile time |
//! | `table` | [`object_dictionary!`], which turns rows into a struct of typed fields and its entries |
//!
//! Control code reads plain typed fields; the SDO server, the PDO mapper and every export work on [`Objects`].
#![no_std]
#![forbid(unsafe_code)]

pub mod abort;
pub mod check;
pub mod entry;
pub mod lookup;
mod table;
pub mod unit;
pub mod value;

pub use abort::AbortCode;
pub use entry::{Access, DataType, Entry};
pub use lookup::{Lookup, lookup};
pub use value::Value;

/// The longest value an entry of a table can have, in bytes.
pub const MAX_VALUE_SIZE: usize = 8;

/// An application's objects, as a slave stack sees them.
///
/// A slot is the position of an entry in [`Objects::entries`]; whoever maps a PDO resolves index and sub-index to slots once.
pub trait Objects {
    /// All entries, sorted by index and sub-index.
    fn entries(&self) -> &'static [Entry];

    /// Copies the value in `slot` to the front of `out`, little-endian, and returns its size in bytes; 0 for a slot that does not exist.
    fn load(&self, slot: usize, out: &mut [u8; MAX_VALUE_SIZE]) -> usize;

    /// Replaces the value in `slot`.
    ///
    /// # Errors
    /// The abort code with which an SDO download of these bytes ends: wrong length, value out of range, or the application's own
    /// reasons. The old value stays then. Access rights are the caller's to check.
    fn store(&mut self, slot: usize, data: &[u8]) -> Result<(), AbortCode>;
}
