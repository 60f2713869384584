//! Sync managers: memory that bus and slave exchange as a whole, through three buffers or through a mailbox (ESC data sheet, section I, 8).
//!
//! Touching a buffer's first byte opens it for that side, touching its last byte completes it. What the slave completes takes effect at
//! once, what the bus completes at the end of the frame.

use wire::register::{PROCESS_RAM, sync_manager as bits};

use crate::buffers::Buffers;
use crate::memory::{MEMORY_END, Place};

/// Who accesses a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    /// The bus.
    Ecat,
    /// The slave.
    Pdi,
}

/// What an access does to a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    /// Takes data out.
    Read,
    /// Puts data in.
    Write,
}

/// How far one side's access to a buffer has come: first byte touched, last byte touched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Stroke {
    open: bool,
    complete: bool,
}

/// One sync manager: its registers, decoded, and the state of its buffers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SyncManager {
    start: u16,
    length: u16,
    mailbox: bool,
    bus_writes: bool,
    control: u8,
    enabled: bool,
    locked: bool,
    buffers: Buffers,
    full: bool,
    written: bool,
    read: bool,
    ecat: Stroke,
    pdi: Stroke,
}

impl SyncManager {
    /// Disabled, all settings zero.
    pub(crate) const OFF: Self = Self {
        start: 0,
        length: 0,
        mailbox: false,
        bus_writes: false,
        control: 0,
        enabled: false,
        locked: false,
        buffers: Buffers::EMPTY,
        full: false,
        written: false,
        read: false,
        ecat: Stroke {
            open: false,
            complete: false,
        },
        pdi: Stroke {
            open: false,
            complete: false,
        },
    };

    /// Takes over the eight register bytes; the buffers are reset when the sync manager goes on or off on either side.
    ///
    /// Returns whether they were.
    pub(crate) fn configure(&mut self, registers: [u8; 8]) -> bool {
        let [start_low, start_high, length_low, length_high, control, _, activate, pdi_control] = registers;
        let start = u16::from_le_bytes([start_low, start_high]);
        let length = u16::from_le_bytes([length_low, length_high]);
        let new = Self {
            start,
            length,
            mailbox: control & bits::CONTROL_MODE & bits::MODE_MAILBOX != 0,
            bus_writes: control & bits::CONTROL_DIRECTION == bits::DIRECTION_WRITE,
            control,
            enabled: activate & bits::ACTIVATE_ENABLE != 0 && length != 0,
            locked: pdi_control & bits::PDI_DEACTIVATE != 0,
            ..Self::OFF
        };
        let reset = new.enabled != self.enabled || new.locked != self.locked || !self.enabled;
        if reset {
            *self = new;
        }
        reset
    }

    /// First byte behind the memory the sync manager guards.
    pub(crate) fn end(&self) -> u32 {
        let buffers = if self.mailbox || self.is_transparent() { 1 } else { 3 };
        u32::from(self.start) + buffers * u32::from(self.length)
    }

    /// A single byte is not buffered, only watched.
    const fn is_transparent(&self) -> bool {
        self.length == 1
    }

    /// What answers at `address`, which is in this sync manager's memory, and the first address where that changes.
    pub(crate) fn place(&self, index: usize, address: u32) -> (Place, u32) {
        let window = u32::from(self.start) + u32::from(self.length);
        let fits = self.start >= PROCESS_RAM && self.end() <= MEMORY_END;
        if !fits || self.locked {
            (Place::Denied, self.end())
        } else if address < window {
            let offset = (address - u32::from(self.start)) as u16;
            (Place::Buffer { index, offset }, window)
        } else {
            (Place::Denied, self.end())
        }
    }

    const fn stroke(&mut self, side: Side) -> &mut Stroke {
        match side {
            Side::Ecat => &mut self.ecat,
            Side::Pdi => &mut self.pdi,
        }
    }

    const fn produces(&self, side: Side) -> bool {
        matches!(side, Side::Ecat) == self.bus_writes
    }

    /// Asks for access to `count` bytes from `offset` on: the address in memory where they are now, or `None` if it is not to be had.
    pub(crate) fn grant(&mut self, side: Side, direction: Direction, offset: u16, count: u16) -> Option<u32> {
        let producing = self.produces(side);
        let matching = (direction == Direction::Write) == producing;
        if self.is_transparent() {
            self.stroke(side).complete |= matching;
            return Some(u32::from(self.start));
        }
        if !matching {
            return None;
        }
        if offset == 0 {
            self.open(side, producing)?;
        } else if !self.stroke(side).open {
            return None;
        }
        if u32::from(offset) + u32::from(count) == u32::from(self.length) {
            self.stroke(side).complete = true;
        }
        let buffer = match (self.mailbox, producing) {
            (true, _) => 0,
            (false, true) => self.buffers.producer(),
            (false, false) => self.buffers.consumer(),
        };
        Some(u32::from(self.start) + u32::from(buffer) * u32::from(self.length) + u32::from(offset))
    }

    fn open(&mut self, side: Side, producing: bool) -> Option<()> {
        let ready = match (self.mailbox, producing) {
            (true, true) => !self.full && !self.stroke(side).complete,
            (true, false) => self.full && !self.stroke(side).complete,
            (false, true) => true,
            (false, false) => self.buffers.latest().is_some(),
        };
        if !ready {
            return None;
        }
        self.stroke(side).open = true;
        if producing {
            self.read = false;
        } else {
            self.written = false;
            if !self.mailbox {
                self.buffers.take();
            }
        }
        Some(())
    }

    /// Lets a completed access take effect; whether there was one.
    pub(crate) fn complete(&mut self, side: Side) -> bool {
        if !self.stroke(side).complete {
            return false;
        }
        *self.stroke(side) = Stroke::default();
        let producing = self.produces(side);
        if producing {
            self.written = true;
        } else {
            self.read = true;
        }
        match (self.is_transparent(), self.mailbox) {
            (false, true) => self.full = producing,
            (false, false) if producing => self.buffers.publish(),
            _ => {}
        }
        true
    }

    /// Forgets the bus's access in a frame that turned out to be broken.
    pub(crate) fn abandon(&mut self) {
        self.ecat = Stroke::default();
    }

    /// Whether the bus writes and the slave reads.
    pub(crate) const fn bus_writes(&self) -> bool {
        self.bus_writes
    }

    /// First byte of the memory the sync manager guards.
    pub(crate) const fn start(&self) -> u16 {
        self.start
    }

    /// Whether the sync manager guards its memory.
    pub(crate) const fn is_enabled(&self) -> bool {
        self.enabled
    }

    /// Whether it is a mailbox.
    pub(crate) const fn is_mailbox(&self) -> bool {
        self.mailbox
    }

    /// Whether a bit of the control register is set.
    pub(crate) const fn has_control(&self, bit: u8) -> bool {
        self.control & bit != 0
    }

    /// Whether the slave has done its part and the bus nothing since, if the control register asks for that (0x0210).
    pub(crate) const fn has_ecat_event(&self) -> bool {
        let done = if self.bus_writes { self.read } else { self.written };
        done && self.has_control(bits::CONTROL_ECAT_EVENT)
    }

    /// The status register.
    pub(crate) fn status(&self) -> u8 {
        let (producer, consumer) = if self.bus_writes {
            (self.ecat, self.pdi)
        } else {
            (self.pdi, self.ecat)
        };
        let state = match self.mailbox {
            true => u8::from(self.full) << 3,
            false => self.buffers.latest().unwrap_or(3) << 4,
        };
        u8::from(self.written) | u8::from(self.read) << 1 | state | u8::from(consumer.open) << 6 | u8::from(producer.open) << 7
    }

    /// Whether the three buffers are in order.
    #[cfg(test)]
    pub(crate) fn is_consistent(&self) -> bool {
        self.buffers.is_consistent()
    }
}
