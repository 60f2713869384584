//! The shadow that holds register writes until the end of their frame (ESC data sheet, section I, 6.5).

use crate::registers::REGISTER_BYTES;

const PAGE: usize = 64;
const PAGES: usize = REGISTER_BYTES / PAGE;

/// Register writes that have been accepted but wait for the end of their frame.
#[derive(Clone)]
pub(crate) struct Shadow {
    bytes: [u8; REGISTER_BYTES],
    written: [u64; PAGES],
    pages: u64,
}

impl Shadow {
    /// Nothing written.
    pub(crate) const fn new() -> Self {
        Self {
            bytes: [0; REGISTER_BYTES],
            written: [0; PAGES],
            pages: 0,
        }
    }

    pub(crate) const fn is_empty(&self) -> bool {
        self.pages == 0
    }

    pub(crate) fn set(&mut self, address: usize, value: u8) {
        self.bytes[address] = value;
        self.written[address / PAGE] |= 1 << (address % PAGE);
        self.pages |= 1 << (address / PAGE);
    }

    /// The byte written to `address`, if one was.
    pub(crate) fn get(&self, address: u16) -> Option<u8> {
        let address = usize::from(address);
        (self.written[address / PAGE] >> (address % PAGE) & 1 != 0).then(|| self.bytes[address])
    }

    /// Whether any of `count` bytes from `first` on was written.
    pub(crate) fn any(&self, first: u16, count: u16) -> bool {
        let (first, last) = (usize::from(first), usize::from(first + count - 1));
        ones(self.pages & bits(first / PAGE, last / PAGE)).any(|page| {
            let start = page * PAGE;
            self.written[page] & bits(first.max(start) - start, last.min(start + PAGE - 1) - start) != 0
        })
    }

    /// The written bytes in the order of their addresses.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (usize, u8)> {
        ones(self.pages)
            .flat_map(move |page| ones(self.written[page]).map(move |bit| page * PAGE + bit))
            .map(|address| (address, self.bytes[address]))
    }

    /// Forgets all writes.
    pub(crate) fn clear(&mut self) {
        for page in ones(self.pages) {
            self.written[page] = 0;
        }
        self.pages = 0;
    }
}

/// A word with the bits from `first` to `last` set, both less than 64.
const fn bits(first: usize, last: usize) -> u64 {
    u64::MAX << first & u64::MAX >> (63 - last)
}

/// The positions of the bits that are set in a word.
fn ones(mut word: u64) -> impl Iterator<Item = usize> {
    core::iter::from_fn(move || {
        let bit = (word != 0).then(|| word.trailing_zeros() as usize);
        word &= word.wrapping_sub(1);
        bit
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use std::vec::Vec;

    #[test]
    fn shadow_tells_what_was_written() {
        let mut shadow = Shadow::new();
        assert!(shadow.is_empty() && !shadow.any(0, REGISTER_BYTES as u16));
        shadow.set(0x0010, 1);
        shadow.set(0x09A7, 2);
        assert!(shadow.any(0x0010, 2) && !shadow.any(0x0011, 0x0900) && shadow.any(0x0011, 0x09EF));
        assert_eq!(shadow.iter().collect::<Vec<_>>(), [(0x0010, 1), (0x09A7, 2)]);
        assert_eq!((shadow.get(0x09A7), shadow.get(0x09A6)), (Some(2), None));
        shadow.clear();
        assert!(shadow.is_empty() && shadow.get(0x0010).is_none());
    }
}
