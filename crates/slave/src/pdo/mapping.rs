//! What an entry of a mapping object may name.

use dictionary::{AbortCode, Entry};

use crate::device_objects::{Located, locate};

/// The direction of process data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    /// From the master: RxPDOs.
    Rx,
    /// To the master: TxPDOs.
    Tx,
}

/// Where the bits of a mapping entry go to or come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Target {
    /// A slot of the application's objects.
    Application(u16),
    /// A slot of [`crate::objects::FixedObjects`].
    Fixed(u16),
    /// Nowhere: a gap.
    Gap,
}

/// Length of a mapping entry in bits.
pub(crate) const fn bits(mapping: u32) -> u8 {
    mapping as u8
}

/// Finds what a mapping entry names.
///
/// Index 0 is a gap of any length; indices 1 to 7 are the gaps of RxPDOs named by data type (CiA 301, dummy entries).
///
/// # Errors
/// 0x06020000 or 0x06090011 for an object that does not exist, 0x06040041 for one that cannot be mapped in this direction or has another
/// length.
pub(crate) fn resolve(mapping: u32, direction: Direction, application: &'static [Entry]) -> Result<Target, AbortCode> {
    let (index, sub, bits) = ((mapping >> 16) as u16, (mapping >> 8) as u8, bits(mapping));
    if index < 8 {
        let any_length = index == 0 && bits != 0;
        let dummy = direction == Direction::Rx && dummy_bits(index) == Some(bits);
        return if sub == 0 && (any_length || dummy) {
            Ok(Target::Gap)
        } else {
            Err(AbortCode::NotMappable)
        };
    }
    let (entry, target) = match locate(index, sub, application)? {
        Located::Application(slot, entry) => (entry, u16::try_from(slot).map(Target::Application)),
        Located::Fixed(slot, entry) => (entry, u16::try_from(slot).map(Target::Fixed)),
        Located::Own(_) | Located::Count(_) => return Err(AbortCode::NotMappable),
    };
    let mappable = match direction {
        Direction::Rx => entry.access.is_rx_mappable(),
        Direction::Tx => entry.access.is_tx_mappable(),
    };
    if !mappable || entry.bits != u16::from(bits) {
        return Err(AbortCode::NotMappable);
    }
    target.map_err(|_| AbortCode::NotMappable)
}

/// The length of the data type a dummy entry names.
const fn dummy_bits(index: u16) -> Option<u8> {
    match index {
        1 => Some(1),
        2 | 5 => Some(8),
        3 | 6 => Some(16),
        4 | 7 => Some(32),
        _ => None,
    }
}
