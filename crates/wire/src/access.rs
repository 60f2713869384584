//! How a slave stack reaches its slave controller: the process data interface (PDI).

/// The PDI side of a slave controller.
///
/// The chip in software implements it directly; on a board it is an SPI or bus driver to the real chip. A driver whose bus fails reads
/// zeros, which the stack takes for "no event", and lets the chip's PDI watchdog tell the master.
///
/// Reading and writing have the chip's side effects: the first byte of a sync manager's buffer opens it, the last completes it;
/// reading AL control (0x0120) acknowledges the AL control event and lets the master write again.
pub trait EscAccess {
    /// Reads registers or memory from `address` on.
    fn read(&mut self, address: u16, data: &mut [u8]);

    /// Writes registers or memory from `address` on.
    fn write(&mut self, address: u16, data: &[u8]);

    /// The AL event request (0x0220): what has happened since it was last acknowledged.
    fn events(&mut self) -> AlEvents;

    /// Reads one little-endian 16-bit register.
    fn read_u16(&mut self, address: u16) -> u16 {
        let mut bytes = [0; 2];
        self.read(address, &mut bytes);
        u16::from_le_bytes(bytes)
    }

    /// Reads one little-endian 32-bit register.
    fn read_u32(&mut self, address: u16) -> u32 {
        let mut bytes = [0; 4];
        self.read(address, &mut bytes);
        u32::from_le_bytes(bytes)
    }

    /// Reads one 8-bit register.
    fn read_u8(&mut self, address: u16) -> u8 {
        let mut bytes = [0; 1];
        self.read(address, &mut bytes);
        bytes[0]
    }

    /// Writes one little-endian 16-bit register.
    fn write_u16(&mut self, address: u16, value: u16) {
        self.write(address, &value.to_le_bytes());
    }

    /// Writes one 8-bit register.
    fn write_u8(&mut self, address: u16, value: u8) {
        self.write(address, &[value]);
    }
}

/// The AL event request register (0x0220).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AlEvents(pub u32);

impl AlEvents {
    /// AL control was written by the master.
    pub const AL_CONTROL: u32 = 1 << 0;
    /// A latch unit took a time stamp.
    pub const DC_LATCH: u32 = 1 << 1;
    /// SYNC0 fired; cleared by reading 0x098E.
    pub const SYNC0: u32 = 1 << 2;
    /// SYNC1 fired; cleared by reading 0x098F.
    pub const SYNC1: u32 = 1 << 3;
    /// A sync manager's activate register was written; cleared by reading the activate registers.
    pub const SM_ACTIVATION: u32 = 1 << 4;
    /// The process data watchdog expired; cleared by reading 0x0440.
    pub const PROCESS_WATCHDOG: u32 = 1 << 6;

    /// Whether any event of `mask` is set.
    pub const fn has(self, mask: u32) -> bool {
        self.0 & mask != 0
    }

    /// The event bit of sync manager `index`: its buffer was written (outputs) or read (inputs) by the master.
    pub const fn sync_manager(index: usize) -> u32 {
        1 << (8 + index)
    }
}
