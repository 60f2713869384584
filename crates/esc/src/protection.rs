//! Write protection of the registers (0x0020, 0x0021) and of the whole chip (0x0030, 0x0031), against the bus only (ESC data sheet,
//! section I, 17.3).

use wire::register::{ESC_WRITE_ENABLE, ESC_WRITE_PROTECTION, WRITE_REGISTER_ENABLE, WRITE_REGISTER_PROTECTION};

use crate::registers::Registers;

/// One of the two protections.
#[derive(Clone, Copy, Debug, Default)]
struct Lock {
    on: bool,
    /// Released for the present frame.
    released: bool,
}

impl Lock {
    const fn is_shut(self) -> bool {
        self.on && !self.released
    }
}

/// Both protections. A master that uses both must release both.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct WriteProtection {
    registers: Lock,
    everything: Lock,
}

impl WriteProtection {
    /// A frame begins: what the last one released is shut again.
    pub(crate) const fn begin_frame(&mut self) {
        self.registers.released = false;
        self.everything.released = false;
    }

    /// Takes a byte that the bus writes to `address`: the enable registers act at once, for what comes behind them in the frame.
    pub(crate) const fn written(&mut self, address: u16, value: u8) {
        let lock = match address {
            WRITE_REGISTER_ENABLE => &mut self.registers,
            ESC_WRITE_ENABLE => &mut self.everything,
            _ => return,
        };
        lock.released = value & 1 != 0;
    }

    /// Takes over the protection registers.
    pub(crate) const fn configure(&mut self, registers: &Registers) {
        self.registers.on = registers.u8(WRITE_REGISTER_PROTECTION) & 1 != 0;
        self.everything.on = registers.u8(ESC_WRITE_PROTECTION) & 1 != 0;
    }

    /// Whether the bus may not write the register at `address` now; the enable registers are always open.
    pub(crate) const fn denies_register(self, address: u16) -> bool {
        (self.registers.is_shut() || self.everything.is_shut()) && !matches!(address, WRITE_REGISTER_ENABLE | ESC_WRITE_ENABLE)
    }

    /// Whether the bus may not write memory now.
    pub(crate) const fn denies_memory(self) -> bool {
        self.everything.is_shut()
    }
}
