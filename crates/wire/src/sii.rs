//! The slave information interface (SII): the image in the slave controller's EEPROM (ETG.1000.6, ETG.2010).

use crc::{CRC_8_SMBUS, Crc};

/// Word addresses of the fixed area.
pub mod word {
    /// PDI control and ESC configuration.
    pub const PDI_CONTROL: usize = 0x00;
    /// PDI configuration.
    pub const PDI_CONFIGURATION: usize = 0x01;
    /// Pulse length of SYNC signals in 10 ns.
    pub const SYNC_PULSE_LENGTH: usize = 0x02;
    /// Extended PDI configuration.
    pub const EXTENDED_PDI_CONFIGURATION: usize = 0x03;
    /// Station alias.
    pub const STATION_ALIAS: usize = 0x04;
    /// Checksum over the words before it.
    pub const CHECKSUM: usize = 0x07;
    /// Vendor, product, revision and serial number, two words each.
    pub const IDENTITY: usize = 0x08;
    /// Offset and size of the receive mailbox, then of the send mailbox.
    pub const MAILBOXES: usize = 0x18;
    /// Mailbox protocols.
    pub const MAILBOX_PROTOCOLS: usize = 0x1C;
    /// Size of the EEPROM in kbit, less one.
    pub const SIZE: usize = 0x3E;
    /// Version of the layout.
    pub const VERSION: usize = 0x3F;
    /// First category.
    pub const CATEGORIES: usize = 0x40;
}

/// Types of categories.
pub mod category {
    /// Strings.
    pub const STRINGS: u16 = 10;
    /// General information.
    pub const GENERAL: u16 = 30;
    /// Use of FMMUs.
    pub const FMMU: u16 = 40;
    /// Sync managers.
    pub const SYNC_MANAGERS: u16 = 41;
    /// TxPDOs.
    pub const TX_PDO: u16 = 50;
    /// RxPDOs.
    pub const RX_PDO: u16 = 51;
    /// Distributed clocks.
    pub const DC: u16 = 60;
    /// End of the list.
    pub const END: u16 = 0xFFFF;
}

/// Bit of [`word::MAILBOX_PROTOCOLS`] for CAN application protocol over EtherCAT.
pub const PROTOCOL_COE: u16 = 0x0004;
/// Bit of [`word::MAILBOX_PROTOCOLS`] for file access over EtherCAT.
pub const PROTOCOL_FOE: u16 = 0x0008;

/// The checksum algorithm of the configuration area: polynomial x^8 + x^2 + x + 1, start value 0xFF.
const CHECKSUM: Crc<u8> = {
    static ALGORITHM: crc::Algorithm<u8> = crc::Algorithm {
        init: 0xFF,
        check: 0xFB,
        ..CRC_8_SMBUS
    };
    Crc::<u8>::new(&ALGORITHM)
};

/// The checksum over the configuration area (words 0 to 6) of an image.
///
/// Images shorter than that are taken as they are.
pub fn checksum(image: &[u8]) -> u8 {
    CHECKSUM.checksum(&image[..image.len().min(2 * word::CHECKSUM)])
}

/// Whether the checksum that an image carries is that of its configuration area.
pub fn is_intact(image: &[u8]) -> bool {
    image.get(2 * word::CHECKSUM).is_some_and(|&stored| stored == checksum(image))
}

/// Writes an image from front to back.
///
/// Untouched bytes stay 0xFF, as in an erased EEPROM. What does not fit is dropped and makes [`Writer::finish`] fail.
pub struct Writer<'a> {
    image: &'a mut [u8],
    at: usize,
}

/// The contents did not fit into the EEPROM.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageFull;

impl<'a> Writer<'a> {
    /// Starts an image: the fixed area all zero but for size and version, everything behind it erased.
    ///
    /// # Errors
    /// [`ImageFull`] when `image` cannot even hold the fixed area.
    pub fn new(image: &'a mut [u8]) -> Result<Self, ImageFull> {
        image.fill(0xFF);
        image.get_mut(..2 * word::CATEGORIES).ok_or(ImageFull)?.fill(0);
        let kilobits = image.len() / 128;
        let mut writer = Self {
            image,
            at: 2 * word::CATEGORIES,
        };
        writer.set_word(word::SIZE, kilobits.saturating_sub(1) as u16);
        writer.set_word(word::VERSION, 1);
        Ok(writer)
    }

    /// Sets one word of the fixed area.
    pub fn set_word(&mut self, word: usize, value: u16) {
        debug_assert!(word < word::CATEGORIES);
        self.image[2 * word..2 * word + 2].copy_from_slice(&value.to_le_bytes());
    }

    /// Sets two words of the fixed area to a 32-bit value.
    pub fn set_double_word(&mut self, word: usize, value: u32) {
        self.set_word(word, value as u16);
        self.set_word(word + 1, (value >> 16) as u16);
    }

    /// Appends a category with what `body` writes into it, padded to whole words.
    pub fn category(&mut self, kind: u16, body: impl FnOnce(&mut Self)) {
        self.u16(kind);
        let length_at = self.at;
        self.u16(0);
        body(self);
        if !(self.at - length_at).is_multiple_of(2) {
            self.u8(0);
        }
        let words = ((self.at - length_at) / 2 - 1) as u16;
        if let Some(length) = self.image.get_mut(length_at..length_at + 2) {
            length.copy_from_slice(&words.to_le_bytes());
        }
    }

    /// Appends bytes.
    pub fn bytes(&mut self, bytes: &[u8]) {
        if let Some(place) = self.image.get_mut(self.at..self.at + bytes.len()) {
            place.copy_from_slice(bytes);
        }
        self.at += bytes.len();
    }

    /// Appends one byte.
    pub fn u8(&mut self, value: u8) {
        self.bytes(&[value]);
    }

    /// Appends a 16-bit value.
    pub fn u16(&mut self, value: u16) {
        self.bytes(&value.to_le_bytes());
    }

    /// Appends a 32-bit value.
    pub fn u32(&mut self, value: u32) {
        self.bytes(&value.to_le_bytes());
    }

    /// Ends the list of categories and sets the checksum.
    ///
    /// # Errors
    /// [`ImageFull`] when more was written than the EEPROM holds.
    pub fn finish(mut self) -> Result<(), ImageFull> {
        self.u16(category::END);
        if self.at > self.image.len() {
            return Err(ImageFull);
        }
        let checksum = checksum(self.image);
        self.set_word(word::CHECKSUM, checksum.into());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checksum_follows_the_polynomial_bit_by_bit() {
        let area = [0x05, 0x06, 0x03, 0x44, 0x64, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        let by_hand = area.iter().fold(0xFF_u8, |crc, byte| {
            (0..8).fold(crc ^ byte, |crc, _| if crc & 0x80 == 0 { crc << 1 } else { crc << 1 ^ 0x07 })
        });
        assert_eq!(checksum(&area), by_hand);
    }

    #[test]
    fn an_image_that_does_not_fit_is_an_error() {
        let mut image = [0; 256];
        let mut writer = Writer::new(&mut image).unwrap();
        writer.category(category::STRINGS, |w| w.bytes(&[0; 200]));
        assert_eq!(writer.finish(), Err(ImageFull));
        assert_eq!(Writer::new(&mut [0; 64]).err(), Some(ImageFull));
    }

    #[test]
    fn categories_are_counted_in_words_and_padded() {
        let mut image = [0; 256];
        let mut writer = Writer::new(&mut image).unwrap();
        writer.category(category::FMMU, |w| w.bytes(&[3, 1, 2]));
        writer.finish().unwrap();
        assert_eq!(image[128..138], [40, 0, 2, 0, 3, 1, 2, 0, 0xFF, 0xFF]);
        assert!(is_intact(&image) && image[138..].iter().all(|&byte| byte == 0xFF));
        image[8] ^= 1;
        assert!(!is_intact(&image));
    }
}
