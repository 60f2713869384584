//! Sync managers: memory that bus and slave exchange as a whole, through three buffers or through a mailbox (ESC data sheet, section I, 8).
//!
//! Touching a buffer's first byte opens it for that side, touching its last byte completes it. What the slave completes takes effect at
//! once, what the bus completes at the end of the frame.

use wire::register::{PROCESS_RAM, sync_manager as bits};

use crate::memory::{MEMORY_END, Place};
use crate::registers::SYNC_MANAGERS;

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

/// How far one side's access to a buffer has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Stroke {
    open: bool,
    complete: bool,
}

/// The three buffers: which one is written, which one waits, which one is read; always a permutation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Buffers {
    producer: u8,
    waiting: u8,
    consumer: u8,
    fresh: bool,
    latest: Option<u8>,
}

impl Buffers {
    const EMPTY: Self = Self {
        producer: 0,
        waiting: 1,
        consumer: 2,
        fresh: false,
        latest: None,
    };

    fn publish(&mut self) {
        self.latest = Some(self.producer);
        core::mem::swap(&mut self.producer, &mut self.waiting);
        self.fresh = true;
    }

    fn take(&mut self) {
        if self.fresh {
            core::mem::swap(&mut self.consumer, &mut self.waiting);
            self.fresh = false;
        }
    }
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
    const OFF: Self = Self {
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
    fn end(&self) -> u32 {
        let buffers = if self.mailbox || self.is_transparent() { 1 } else { 3 };
        u32::from(self.start) + buffers * u32::from(self.length)
    }

    /// A single byte is not buffered, only watched.
    const fn is_transparent(&self) -> bool {
        self.length == 1
    }

    fn place(&self, index: usize, address: u32) -> (Place, u32) {
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
            (false, true) => self.buffers.producer,
            (false, false) => self.buffers.consumer,
        };
        Some(u32::from(self.start) + u32::from(buffer) * u32::from(self.length) + u32::from(offset))
    }

    fn open(&mut self, side: Side, producing: bool) -> Option<()> {
        let ready = match (self.mailbox, producing) {
            (true, true) => !self.full && !self.stroke(side).complete,
            (true, false) => self.full && !self.stroke(side).complete,
            (false, true) => true,
            (false, false) => self.buffers.latest.is_some(),
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
            false => self.buffers.latest.unwrap_or(3) << 4,
        };
        u8::from(self.written) | u8::from(self.read) << 1 | state | u8::from(consumer.open) << 6 | u8::from(producer.open) << 7
    }

    /// Whether the buffers are three different ones.
    #[cfg(test)]
    pub(crate) fn is_consistent(&self) -> bool {
        let mut buffers = [self.buffers.producer, self.buffers.waiting, self.buffers.consumer];
        buffers.sort_unstable();
        buffers == [0, 1, 2] && self.buffers.latest != Some(self.buffers.producer)
    }
}

/// All sync managers of a chip.
#[derive(Clone, Debug)]
pub(crate) struct SyncManagers {
    all: [SyncManager; SYNC_MANAGERS],
    enabled: u8,
}

impl SyncManagers {
    /// All off.
    pub(crate) const fn new() -> Self {
        Self {
            all: [SyncManager::OFF; SYNC_MANAGERS],
            enabled: 0,
        }
    }

    /// Takes over the registers of one sync manager; whether its buffers were reset.
    pub(crate) fn configure(&mut self, index: usize, registers: [u8; 8]) -> bool {
        let reset = self.all[index].configure(registers);
        let enabled = u8::from(self.all[index].enabled) << index;
        self.enabled = self.enabled & !(1 << index) | enabled;
        reset
    }

    /// One sync manager.
    pub(crate) const fn get(&self, index: usize) -> &SyncManager {
        &self.all[index]
    }

    /// One sync manager, to use.
    pub(crate) const fn get_mut(&mut self, index: usize) -> &mut SyncManager {
        &mut self.all[index]
    }

    /// Who guards the memory at `address`, and the first address where that may change.
    ///
    /// Where two sync managers claim the same memory, the one with the lower number has it.
    pub(crate) fn locate(&self, address: u32) -> (Place, u32) {
        let mut end = MEMORY_END;
        let mut rest = self.enabled;
        while rest != 0 {
            let index = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            let sm = &self.all[index];
            let start = u32::from(sm.start);
            if address < start {
                end = end.min(start);
            } else if address < sm.end() {
                let (place, until) = sm.place(index, address);
                return (place, end.min(until));
            }
        }
        (Place::Plain, end)
    }
}
