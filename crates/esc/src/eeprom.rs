//! The SII EEPROM and its interface in registers 0x0500 to 0x050F (ESC data sheet, section I, 11).
//!
//! Commands complete at once: a master never sees the busy bit.

use wire::register::*;
use wire::sii;

use crate::chip::Chip;

/// Bytes of the EEPROM: 16 kbit, addressed by 16-bit words.
pub const EEPROM_SIZE: usize = 2048;

/// Low byte of 0x0502 at rest: eight bytes a read, one address byte (as of parts up to 16 kbit).
const CONTROL_IDLE: u8 = 0x40;
const CONTROL_WRITE_ENABLE: u8 = 0x01;

/// High byte of 0x0502.
const COMMAND: u8 = 0x07;
const COMMAND_IDLE: u8 = 0x00;
const COMMAND_READ: u8 = 0x01;
const COMMAND_WRITE: u8 = 0x02;
const COMMAND_RELOAD: u8 = 0x04;
const CHECKSUM_ERROR: u8 = 0x08;
const NOT_LOADED: u8 = 0x10;
const COMMAND_ERROR: u8 = 0x20;
const WRITE_ENABLE_ERROR: u8 = 0x40;

/// A checksum word that switches the check off, for development.
const CHECKSUM_OFF: [u8; 2] = 0x88A4_u16.to_le_bytes();
/// Bits of the ESC configuration that only power-on loads: enhanced link detection.
const LOADED_ONCE: u8 = 0xF2;

/// The memory cells.
#[derive(Clone)]
pub(crate) struct Eeprom {
    pub(crate) image: [u8; EEPROM_SIZE],
    /// Words written since the chip was made.
    pub(crate) writes: u32,
}

impl Eeprom {
    /// The word at `address`; beyond the end everything is erased.
    fn word(&self, address: usize) -> [u8; 2] {
        match self.image.get(2 * address..2 * address + 2) {
            Some(bytes) => [bytes[0], bytes[1]],
            None => [0xFF; 2],
        }
    }

    /// Writes the word at `address`; false beyond the end.
    fn write(&mut self, address: usize, word: [u8; 2]) -> bool {
        let Some(bytes) = self.image.get_mut(2 * address..2 * address + 2) else {
            return false;
        };
        bytes.copy_from_slice(&word);
        self.writes = self.writes.wrapping_add(1);
        true
    }

    fn is_intact(&self) -> bool {
        sii::is_intact(&self.image) || self.word(sii::word::CHECKSUM) == CHECKSUM_OFF
    }
}

impl Chip {
    /// Loads the configuration area and the alias, as at power-on.
    pub(crate) fn load_eeprom(&mut self) {
        self.registers.set(EEPROM_CONTROL, &[CONTROL_IDLE, 0]);
        self.reload(0xFF);
        if self.is_eeprom_loaded() {
            self.registers.set(STATION_ALIAS, &self.eeprom.word(sii::word::STATION_ALIAS));
        }
    }

    /// Whether the configuration area was loaded and its checksum was right.
    pub(crate) const fn is_eeprom_loaded(&self) -> bool {
        self.registers.u8(EEPROM_CONTROL + 1) & NOT_LOADED == 0
    }

    fn reload(&mut self, configuration_mask: u8) {
        let status = self.registers.u8(EEPROM_CONTROL + 1) & !(CHECKSUM_ERROR | NOT_LOADED);
        if !self.eeprom.is_intact() {
            self.registers.set(EEPROM_CONTROL + 1, &[status | CHECKSUM_ERROR | NOT_LOADED]);
            return;
        }
        self.registers.set(EEPROM_CONTROL + 1, &[status]);
        let [control, configuration] = self.eeprom.word(sii::word::PDI_CONTROL);
        let kept = self.registers.u8(ESC_CONFIGURATION) & !configuration_mask;
        self.registers
            .set(PDI_CONTROL, &[control, kept | configuration & configuration_mask]);
        self.registers
            .set(PDI_CONFIGURATION, &self.eeprom.word(sii::word::PDI_CONFIGURATION));
        self.registers.set(DC_PULSE_LENGTH, &self.eeprom.word(sii::word::SYNC_PULSE_LENGTH));
        self.registers
            .set(EXTENDED_PDI_CONFIGURATION, &self.eeprom.word(sii::word::EXTENDED_PDI_CONFIGURATION));
    }

    /// Executes what was written to 0x0502 and 0x0503; address and data are in the registers already.
    pub(crate) fn eeprom_command(&mut self, control: Option<u8>, command: Option<u8>) {
        let Some(command) = command else { return };
        let enabled = control.is_some_and(|control| control & CONTROL_WRITE_ENABLE != 0);
        // The upper half of the address is ignored: IgH never writes it.
        let address = usize::from(self.registers.u16(EEPROM_ADDRESS));
        let error = match command & COMMAND {
            COMMAND_IDLE => 0,
            COMMAND_READ => {
                for word in 0..4 {
                    let bytes = self.eeprom.word(address + word);
                    self.registers.set(EEPROM_DATA + 2 * word as u16, &bytes);
                }
                0
            }
            COMMAND_WRITE if !enabled => WRITE_ENABLE_ERROR,
            COMMAND_WRITE => match self.eeprom.write(address, self.registers.bytes(EEPROM_DATA)) {
                true => 0,
                // As of a part that does not acknowledge the address.
                false => COMMAND_ERROR,
            },
            COMMAND_RELOAD => {
                self.reload(!LOADED_ONCE);
                0
            }
            _ => COMMAND_ERROR,
        };
        let status = self.registers.u8(EEPROM_CONTROL + 1) & (CHECKSUM_ERROR | NOT_LOADED);
        self.registers.set(EEPROM_CONTROL + 1, &[status | error]);
    }
}
