//! The bus side's access to registers and memory, byte for byte (ESC data sheet, section I, 6.4).

use wire::register::*;

use crate::chip::{Chip, Pass};
use crate::memory::Place;
use crate::registers::Rights;
use crate::sync_manager::{Direction, Side};

/// What an access does with the data it carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operation {
    /// Data becomes memory.
    Read,
    /// Data becomes data or memory.
    ReadOr,
    /// Memory becomes data.
    Write,
    /// Data and memory change places.
    Exchange,
    /// Memory becomes data, data becomes data or memory.
    ExchangeOr,
}

impl Operation {
    const fn reads(self) -> bool {
        !matches!(self, Self::Write)
    }

    const fn writes(self) -> bool {
        matches!(self, Self::Write | Self::Exchange | Self::ExchangeOr)
    }

    const fn combine(self, data: u8, memory: u8) -> u8 {
        match self {
            Self::Read | Self::Exchange => memory,
            Self::ReadOr | Self::ExchangeOr => data | memory,
            Self::Write => data,
        }
    }

    /// Reads into `data` without writing.
    fn read(self, data: &mut [u8], memory: &[u8]) {
        if matches!(self, Self::Read | Self::Exchange) {
            data.copy_from_slice(memory);
        } else {
            for (data, memory) in data.iter_mut().zip(memory) {
                *data |= memory;
            }
        }
    }

    fn apply(self, data: &mut [u8], memory: &mut [u8]) {
        match self {
            Self::Read | Self::ReadOr => self.read(data, memory),
            Self::Write => memory.copy_from_slice(data),
            Self::Exchange | Self::ExchangeOr => {
                for (data, memory) in data.iter_mut().zip(memory) {
                    let new = *data;
                    *data = self.combine(new, *memory);
                    *memory = new;
                }
            }
        }
    }
}

/// Whether any byte could be read and whether any could be written: what the working counter counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Success {
    pub(crate) read: bool,
    pub(crate) write: bool,
}

impl core::ops::BitOrAssign for Success {
    fn bitor_assign(&mut self, other: Self) {
        self.read |= other.read;
        self.write |= other.write;
    }
}

impl Chip {
    /// Accesses registers and memory from `address` on. Addresses do not wrap; beyond the last there is nothing.
    pub(crate) fn ecat_access(&mut self, pass: Pass, address: u32, data: &mut [u8], operation: Operation) -> Success {
        let mut success = Success::default();
        let mut at = address;
        let mut rest = data;
        while !rest.is_empty() {
            let (place, count) = self.locate(at, rest.len());
            let (run, behind) = rest.split_at_mut(count);
            success |= self.ecat_run(pass, at, place, run, operation);
            at += count as u32;
            rest = behind;
        }
        success
    }

    fn ecat_run(&mut self, pass: Pass, at: u32, place: Place, data: &mut [u8], operation: Operation) -> Success {
        match place {
            Place::Register => self.ecat_registers(pass, at, data, operation),
            Place::Plain => {
                let write = operation.writes() && !self.protection.denies_memory();
                let memory = self.memory_at(at, data.len());
                if write {
                    operation.apply(data, memory);
                } else {
                    operation.read(data, memory);
                }
                Success {
                    read: operation.reads(),
                    write,
                }
            }
            Place::Buffer { index, offset } => self.ecat_buffer(index, offset, data, operation),
            Place::Reserved => {
                if operation == Operation::Read {
                    data.fill(0);
                }
                Success::default()
            }
            Place::Denied | Place::Nowhere => Success::default(),
        }
    }

    fn ecat_buffer(&mut self, index: usize, offset: u16, data: &mut [u8], operation: Operation) -> Success {
        let count = data.len() as u16;
        let writes = operation.writes() && !self.protection.denies_memory();
        let sm = self.sync_managers.get_mut(index);
        let mut grant = |direction, wanted: bool| {
            if wanted {
                sm.grant(Side::Ecat, direction, offset, count)
            } else {
                None
            }
        };
        let readable = grant(Direction::Read, operation.reads());
        let writable = grant(Direction::Write, writes);
        match (readable, writable) {
            (Some(at), Some(_)) => operation.apply(data, self.memory_at(at, data.len())),
            (Some(at), None) => operation.read(data, self.memory_at(at, data.len())),
            (None, Some(at)) => self.memory_at(at, data.len()).copy_from_slice(data),
            (None, None) => return Success::default(),
        }
        self.touched |= 1 << index;
        Success {
            read: readable.is_some(),
            write: writable.is_some(),
        }
    }

    fn ecat_registers(&mut self, pass: Pass, at: u32, data: &mut [u8], operation: Operation) -> Success {
        let first = at as usize;
        let mut success = Success::default();
        if operation.reads() {
            self.refresh(Side::Ecat, pass, first as u16, data.len() as u16);
        }
        for (address, byte) in (first..).zip(data.iter_mut()) {
            let rights = Rights::at(address);
            let written = *byte;
            if operation.reads() && rights.ecat_reads() {
                *byte = operation.combine(written, self.registers.0[address]);
                success.read = true;
            } else if operation == Operation::Read {
                *byte = 0;
            }
            if operation.writes() && self.ecat_may_write(address, rights) {
                self.protection.written(address as u16, written);
                self.shadow.set(address, written);
                success.write = true;
            }
        }
        if success.read {
            self.acknowledge_ecat_events(first as u16, data.len() as u16);
        }
        success
    }

    /// Whether the bus may write the register byte at `address` now.
    fn ecat_may_write(&self, address: usize, rights: Rights) -> bool {
        let address = address as u16;
        rights.ecat_writes()
            && !self.protection.denies_register(address)
            && (!rights.is_conditional() || self.condition_of_ecat_write(address))
    }

    fn condition_of_ecat_write(&self, address: u16) -> bool {
        match address {
            AL_CONTROL..AL_STATUS => !self.al_control_locked,
            EEPROM_CONTROL..FMMU => self.registers.u8(EEPROM_PDI_ACCESS) & 1 == 0,
            SM..DC_RECEIVE_TIMES => {
                let activate = address - address % SM_SIZE + sync_manager::ACTIVATE;
                self.registers.u8(activate) & sync_manager::ACTIVATE_ENABLE == 0
            }
            DC_LATCH_CONTROL..DC_LATCH_STATUS => !self.slave_owns_latch(usize::from(address - DC_LATCH_CONTROL)),
            _ => self.registers.u8(DC_CYCLIC_CONTROL) & 1 == 0,
        }
    }

    /// Writes the bits of `mask` of one byte and leaves the others as they are; whether that was possible.
    pub(crate) fn ecat_write_bits(&mut self, address: u32, value: u8, mask: u8) -> bool {
        match self.locate(address, 1).0 {
            Place::Register => {
                let register = address as usize;
                let may = self.ecat_may_write(register, Rights::at(register));
                if may {
                    let old = self.shadow.get(register as u16).unwrap_or(self.registers.0[register]);
                    self.protection.written(register as u16, value & mask);
                    self.shadow.set(register, old & !mask | value & mask);
                }
                may
            }
            Place::Plain | Place::Buffer { .. } if self.protection.denies_memory() => false,
            Place::Plain => {
                let byte = &mut self.memory_at(address, 1)[0];
                *byte = *byte & !mask | value & mask;
                true
            }
            Place::Buffer { index, offset } => {
                let Some(at) = self.sync_managers.get_mut(index).grant(Side::Ecat, Direction::Write, offset, 1) else {
                    return false;
                };
                self.touched |= 1 << index;
                let byte = &mut self.memory_at(at, 1)[0];
                *byte = *byte & !mask | value & mask;
                true
            }
            Place::Reserved | Place::Denied | Place::Nowhere => false,
        }
    }
}
