//! A small device: a few objects of every width, and commands it can refuse.

use dictionary::{AbortCode, Entry, MAX_VALUE_SIZE, Objects, object_dictionary};
use slave::Application;

object_dictionary! {
    /// Objects of every width and right.
    pub struct LampObjects in slots {
        /// Writable everywhere.
        0x2000:0 brightness: u16 = 50, RW | RX_PDO | TX_PDO | SAVED, in 0..=100, "Brightness";
        /// Writable in PREOP.
        0x2001:0 address: u16 = 1, RW_PREOP, "Address";
        /// Vetoed while locked.
        0x2002:0 guarded: u8 = 7, RW | RX_PDO, "Guarded";
        /// Part.
        0x2005:1 red: u8 = 1, RW | RX_PDO | TX_PDO, "Red" of "Colour";
        /// Part.
        0x2005:2 green: i32 = -2, RW | RX_PDO | TX_PDO, "Green" of "Colour";
        /// One bit.
        0x2006:0 on: bool = false, RW | RX_PDO | TX_PDO, "On";
        /// Eight bytes.
        0x2007:0 wide: u64 = 0x1122_3344_5566_7788, RW | RX_PDO | TX_PDO, "Wide";
        /// Read only.
        0x6041:0 status: u16 = 0x1234, RO | TX_PDO, "Statusword";
        /// Read only, not mappable.
        0x6502:0 modes: u32 = 0x55, RO, "Modes";
    }
}

/// The device.
pub struct Lamp {
    pub objects: LampObjects,
    pub locked: bool,
    pub stored: u32,
    pub restored: u32,
    pub refusal: Option<AbortCode>,
}

impl Lamp {
    pub fn new() -> Self {
        Self {
            objects: LampObjects::new(),
            locked: false,
            stored: 0,
            restored: 0,
            refusal: None,
        }
    }
}

impl Objects for Lamp {
    fn entries(&self) -> &'static [Entry] {
        LampObjects::ENTRIES
    }

    fn load(&self, slot: usize, out: &mut [u8; MAX_VALUE_SIZE]) -> usize {
        self.objects.load(slot, out)
    }

    fn store(&mut self, slot: usize, data: &[u8]) -> Result<(), AbortCode> {
        self.objects.store(slot, data)
    }
}

impl Application for Lamp {
    fn error_register(&self) -> u8 {
        0x21
    }

    fn store_parameters(&mut self) -> Result<(), AbortCode> {
        self.stored += 1;
        self.refusal.map_or(Ok(()), Err)
    }

    fn restore_defaults(&mut self) -> Result<(), AbortCode> {
        self.restored += 1;
        self.refusal.map_or(Ok(()), Err)
    }

    fn may_write(&self, slot: usize) -> Result<(), AbortCode> {
        if self.locked && slot == slots::guarded {
            Err(AbortCode::DeviceState)
        } else {
            Ok(())
        }
    }
}
