//! Which part of the chip an address belongs to.

use wire::register::USER_RAM;

use crate::chip::Chip;
use crate::registers::REGISTER_BYTES;

/// First address behind the process memory.
pub(crate) const MEMORY_END: u32 = 0x3000;
/// Bytes of user memory and process memory together.
pub(crate) const MEMORY_BYTES: usize = MEMORY_END as usize - USER_RAM as usize;

/// What answers at an address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// The register file.
    Register,
    /// Nothing, but within the register space: reads as zero.
    Reserved,
    /// Memory without a guard.
    Plain,
    /// Memory behind sync manager `index`, `offset` bytes from its start.
    Buffer {
        /// Number of the sync manager.
        index: usize,
        /// Distance from its start address.
        offset: u16,
    },
    /// Memory that a sync manager keeps for itself.
    Denied,
    /// Nothing.
    Nowhere,
}

impl Chip {
    /// What answers at `address`, and for how many bytes on, at most `count`.
    pub(crate) fn locate(&self, address: u32, count: usize) -> (Place, usize) {
        let (place, end) = if address < REGISTER_BYTES as u32 {
            (Place::Register, REGISTER_BYTES as u32)
        } else if address < u32::from(USER_RAM) {
            (Place::Reserved, u32::from(USER_RAM))
        } else if address < MEMORY_END {
            self.sync_managers.locate(address)
        } else {
            return (Place::Nowhere, count);
        };
        (place, count.min((end - address) as usize))
    }

    /// The memory from `address` on, which must lie in it.
    pub(crate) fn memory_at(&mut self, address: u32, count: usize) -> &mut [u8] {
        let start = (address - u32::from(USER_RAM)) as usize;
        &mut self.memory[start..start + count]
    }
}
