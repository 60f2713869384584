//! What crosses an EtherCAT wire, as codecs without state, and the contract between slave controller and slave stack.
//!
//! | module | holds |
//! |---|---|
//! | [`access`] | [`EscAccess`]: how a slave stack reaches its slave controller |
//! | [`al`] | states, control, status and status codes of the application layer |
//! | [`coe`] | the CoE header, SDO services, SDO information and emergencies |
//! | [`foe`] | file access: requests, data, acknowledgements, errors |
//! | [`frame`] | Ethernet frames, the EtherCAT header, datagrams and their commands |
//! | [`indicator`] | patterns of RUN, ERR and link/activity LEDs as functions of time |
//! | [`mailbox`] | the mailbox header and mailbox errors |
//! | [`register`] | addresses and bits of the slave controller's registers |
//! | [`sii`] | layout and checksum of the EEPROM image, and a writer for it |
//!
//! Nothing here knows what kind of device is behind the wire.
#![no_std]
#![forbid(unsafe_code)]

pub mod access;
pub mod al;
pub mod coe;
pub mod foe;
pub mod frame;
pub mod indicator;
pub mod mailbox;
pub mod register;
pub mod sii;

use core::time::Duration;

pub use access::{AlEvents, EscAccess};

/// An instant of bus time in nanoseconds since an arbitrary start; only differences matter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Nanos(pub u64);

impl Nanos {
    /// The instant a span of time after this one; the last there is, if that is later than all.
    pub const fn after(self, span: Duration) -> Self {
        // 584 years pass before 64 bits of nanoseconds are full.
        Self(self.0.saturating_add(span.as_nanos() as u64))
    }

    /// The time from `earlier` to this instant; zero when `earlier` is later.
    pub const fn since(self, earlier: Self) -> u64 {
        self.0.saturating_sub(earlier.0)
    }
}
