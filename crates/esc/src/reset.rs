//! Reset by writing "R", "E", "S", from the bus to 0x0040 or from the slave to 0x0041 (ESC data sheet, section II, 2.7).
//!
//! From the bus the letters come in three consecutive frames: one that passes the chip in between without the next letter breaks the
//! sequence off. The reset acts behind the third frame. It also pulls the chip's reset pin, which is what the slave stack's processor
//! notices; [`Chip::resets`] is that pin.

use wire::register::*;

use crate::chip::Chip;

const LETTERS: [u8; 3] = *b"RES";

/// How far a sequence has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct ResetSequence(u8);

impl ResetSequence {
    /// Takes what was written, if anything was; whether that completes the sequence.
    fn step(&mut self, letter: Option<u8>) -> bool {
        let progress = match letter {
            Some(letter) if LETTERS.get(usize::from(self.0)) == Some(&letter) => self.0 + 1,
            Some(letter) if letter == LETTERS[0] => 1,
            _ => 0,
        };
        let complete = usize::from(progress) == LETTERS.len();
        self.0 = if complete { 0 } else { progress };
        complete
    }

    /// Whether letters have come and more are due.
    pub(crate) const fn is_under_way(self) -> bool {
        self.0 != 0
    }
}

impl Chip {
    /// How often the chip has been reset by register since it was made; wraps. Each time it is as after power-on, and so should be what
    /// hangs on it.
    pub const fn resets(&self) -> u32 {
        self.resets
    }

    /// Ends a frame that wrote `letter`, if any, to 0x0040.
    pub(crate) fn step_reset_by_bus(&mut self, letter: Option<u8>, frame: u64) {
        if self.reset[0].step(letter) {
            self.restart();
            self.ports.request(0, frame);
            self.resets = self.resets.wrapping_add(1);
        }
        self.registers.set(RESET, &[self.reset[0].0]);
    }

    /// Ends an access of the slave that wrote `letter` to 0x0041.
    pub(crate) fn step_reset_by_slave(&mut self, letter: u8) {
        if self.reset[1].step(Some(letter)) {
            self.power_cycle();
            self.resets = self.resets.wrapping_add(1);
        }
        self.registers.set(RESET_PDI, &[self.reset[1].0]);
    }
}
