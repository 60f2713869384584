//! The flash memory in which a virtual drive keeps its parameters.

use device::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write};

/// Bytes of the memory: four pages.
pub const SIZE: usize = 4 * PAGE;

/// Bytes that are erased together, and that are written together: those of a usual microcontroller.
const PAGE: usize = 2048;
const WORD: usize = 8;
const ERASED: u8 = 0xFF;

/// NOR flash: erasing sets all bits of a page, writing clears bits.
#[derive(Clone)]
pub struct Flash {
    cells: Box<[u8; SIZE]>,
    writes: u32,
    broken: bool,
}

impl Flash {
    /// A memory with these contents.
    pub fn with(cells: [u8; SIZE]) -> Self {
        Self {
            cells: Box::new(cells),
            writes: 0,
            broken: false,
        }
    }

    /// An erased memory, as that of a new unit.
    pub fn erased() -> Self {
        Self::with([ERASED; SIZE])
    }

    /// The contents.
    pub fn cells(&self) -> &[u8; SIZE] {
        &self.cells
    }

    /// Breaks the memory: from now on it can be read, but neither written nor erased.
    pub fn break_down(&mut self) {
        self.broken = true;
    }

    /// Whether the memory takes orders.
    fn check_health(&self) -> Result<(), NorFlashErrorKind> {
        if self.broken { Err(NorFlashErrorKind::Other) } else { Ok(()) }
    }

    /// How often the memory has been written or erased since it was made; wraps. Tells the host when to save it.
    pub const fn writes(&self) -> u32 {
        self.writes
    }
}

impl ErrorType for Flash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        check_read(self, offset, bytes.len())?;
        bytes.copy_from_slice(&self.cells[offset as usize..][..bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        SIZE
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = PAGE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        check_erase(self, from, to)?;
        self.check_health()?;
        self.cells[from as usize..to as usize].fill(ERASED);
        self.writes = self.writes.wrapping_add(1);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        check_write(self, offset, bytes.len())?;
        self.check_health()?;
        for (cell, byte) in self.cells[offset as usize..].iter_mut().zip(bytes) {
            *cell &= byte;
        }
        self.writes = self.writes.wrapping_add(1);
        Ok(())
    }
}
