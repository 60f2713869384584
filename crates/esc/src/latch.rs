//! The latch units: at which system time an input changed (ESC data sheet, section I, 9.2.4).

use wire::register::*;
use wire::{AlEvents, Nanos};

use crate::chip::Chip;
use crate::live::touches;

/// Units, each with an input.
const UNITS: usize = 2;
/// Bytes of one latch time.
const TIME: u16 = 8;
/// Bit of the cyclic unit control (0x0980) that gives unit 0 to the slave; that of unit 1 follows.
const OWNER: u8 = 4;
const EDGES: u8 = dc_latch::POSITIVE | dc_latch::NEGATIVE;

/// What the latch units keep beyond their registers.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Latches {
    /// Edges of each unit whose times the present frame has read.
    read: [u8; UNITS],
}

const fn status_of(unit: usize) -> u16 {
    DC_LATCH_STATUS + unit as u16
}

/// The edges of `unit` whose times are among `count` bytes from `first` on.
const fn edges_read(unit: usize, first: u16, count: u16) -> u8 {
    let times = DC_LATCH_TIMES + 2 * TIME * unit as u16;
    let positive = if touches(first, count, times, 1) { dc_latch::POSITIVE } else { 0 };
    let negative = if touches(first, count, times + TIME, 1) {
        dc_latch::NEGATIVE
    } else {
        0
    };
    positive | negative
}

impl Chip {
    /// The input of latch unit 0 or 1 has this level from `now` on; other units do not exist.
    ///
    /// An edge is latched with the chip's system time. Of edges set to "single" (0x09A8) only the first is, until the unit's owner has
    /// read its time; it raises the DC latch event at the owner's side.
    pub fn latch(&mut self, unit: usize, level: bool, now: Nanos) {
        if unit >= UNITS {
            return;
        }
        let status = self.registers.u8(status_of(unit));
        if (status & dc_latch::LEVEL != 0) == level {
            return;
        }
        let (edge, offset) = if level {
            (dc_latch::POSITIVE, 0)
        } else {
            (dc_latch::NEGATIVE, TIME)
        };
        let mut new = status & EDGES | if level { dc_latch::LEVEL } else { 0 };
        if status & edge == 0 {
            let time = self.system_time(now);
            self.registers
                .set(DC_LATCH_TIMES + 2 * TIME * unit as u16 + offset, &time.to_le_bytes());
            let single = self.registers.u8(DC_LATCH_CONTROL + unit as u16) & edge;
            new |= single;
            if single != 0 && self.slave_owns_latch(unit) {
                self.events.raise_at(now, AlEvents::DC_LATCH);
            }
        }
        self.registers.set(status_of(unit), &[new]);
    }

    pub(crate) fn slave_owns_latch(&self, unit: usize) -> bool {
        self.registers.u8(DC_CYCLIC_CONTROL) >> (usize::from(OWNER) + unit) & 1 != 0
    }

    /// Whether a unit of the bus, or of the slave, has latched a single edge whose time has not been read.
    pub(crate) fn has_latch_event(&self, of_slave: bool) -> bool {
        (0..UNITS).any(|unit| self.slave_owns_latch(unit) == of_slave && self.registers.u8(status_of(unit)) & EDGES != 0)
    }

    /// The bus reads registers, which counts at the frame's end.
    pub(crate) fn note_latch_read(&mut self, first: u16, count: u16) {
        if touches(first, count, DC_LATCH_TIMES, 2 * TIME * UNITS as u16) {
            for unit in 0..UNITS {
                self.latches.read[unit] |= edges_read(unit, first, count);
            }
        }
    }

    /// Whether the present frame has read a time.
    pub(crate) fn has_read_latch(&self) -> bool {
        self.latches.read != [0; UNITS]
    }

    /// Ends a frame; what it has read counts if it was whole.
    pub(crate) fn finish_latch_read(&mut self, intact: bool) {
        for unit in 0..UNITS {
            if intact && !self.slave_owns_latch(unit) {
                self.arm_latch(unit, self.latches.read[unit]);
            }
        }
        self.latches = Latches::default();
    }

    /// The slave reads registers.
    pub(crate) fn acknowledge_latch(&mut self, first: u16, count: u16) {
        if !touches(first, count, DC_LATCH_TIMES, 2 * TIME * UNITS as u16) {
            return;
        }
        for unit in 0..UNITS {
            if self.slave_owns_latch(unit) {
                self.arm_latch(unit, edges_read(unit, first, count));
            }
        }
        if !self.has_latch_event(true) {
            self.events.cancel(AlEvents::DC_LATCH);
        }
    }

    /// Takes over written latch control: continuous edges are never reported.
    pub(crate) fn commit_latch_control(&mut self) {
        for unit in 0..UNITS {
            self.arm_latch(unit, !self.registers.u8(DC_LATCH_CONTROL + unit as u16));
        }
        if !self.has_latch_event(true) {
            self.events.cancel(AlEvents::DC_LATCH);
        }
    }

    /// Lets a unit latch these edges again.
    fn arm_latch(&mut self, unit: usize, edges: u8) {
        let status = self.registers.u8(status_of(unit)) & !(edges & EDGES);
        self.registers.set(status_of(unit), &[status]);
    }
}
