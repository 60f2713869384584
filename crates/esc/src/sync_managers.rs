//! The sync managers of a chip together: which of them guards an address.

use crate::memory::{MEMORY_END, Place};
use crate::registers::SYNC_MANAGERS;
use crate::sync_manager::SyncManager;

/// All sync managers of a chip.
#[derive(Clone, Debug)]
pub(crate) struct SyncManagers {
    all: [SyncManager; SYNC_MANAGERS],
    enabled: u8,
}

impl SyncManagers {
    /// All off.
    pub(crate) const fn new() -> Self {
        Self {
            all: [SyncManager::OFF; SYNC_MANAGERS],
            enabled: 0,
        }
    }

    /// Takes over the registers of one sync manager; whether its buffers were reset.
    pub(crate) fn configure(&mut self, index: usize, registers: [u8; 8]) -> bool {
        let reset = self.all[index].configure(registers);
        let enabled = u8::from(self.all[index].is_enabled()) << index;
        self.enabled = self.enabled & !(1 << index) | enabled;
        reset
    }

    /// One sync manager.
    pub(crate) const fn get(&self, index: usize) -> &SyncManager {
        &self.all[index]
    }

    /// One sync manager, to use.
    pub(crate) const fn get_mut(&mut self, index: usize) -> &mut SyncManager {
        &mut self.all[index]
    }

    /// Who guards the memory at `address`, and the first address where that may change.
    ///
    /// Where two sync managers claim the same memory, the one with the lower number has it.
    pub(crate) fn locate(&self, address: u32) -> (Place, u32) {
        let mut end = MEMORY_END;
        let mut rest = self.enabled;
        while rest != 0 {
            let index = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            let sm = &self.all[index];
            let start = u32::from(sm.start());
            if address < start {
                end = end.min(start);
            } else if address < sm.end() {
                let (place, until) = sm.place(index, address);
                return (place, end.min(until));
            }
        }
        (Place::Plain, end)
    }
}
