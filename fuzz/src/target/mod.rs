//! The targets.
//!
//! | module | fuzzes |
//! |---|---|
//! | [`frame`] | three drives, by whole frames and cables |
//! | [`mailbox`] | one drive, by mailbox messages |
//! | [`sdo`] | one drive, by SDO services |
//! | [`eeprom`] | one drive, by the contents of its EEPROM and its interface |

pub mod eeprom;
pub mod frame;
pub mod mailbox;
pub mod sdo;

/// A target: what `cargo fuzz` calls it, and what it does with an input.
pub type Target = (&'static str, fn(&[u8]));

/// All targets.
pub const ALL: [Target; 4] = [
    ("frame", frame::run),
    ("mailbox", mailbox::run),
    ("sdo", sdo::run),
    ("eeprom", eeprom::run),
];
