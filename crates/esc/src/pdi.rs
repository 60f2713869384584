//! The slave stack's access to registers and memory: the process data interface.
//!
//! It happens on the slave's time, that of the last [`Chip::advance`], and takes effect at once.

use wire::register::*;
use wire::{AlEvents, EscAccess};

use crate::chip::{Chip, Pass};
use crate::live::touches;
use crate::memory::Place;
use crate::registers::{Rights, SYNC_MANAGERS};
use crate::sync_manager::{Direction, Side};

impl EscAccess for Chip {
    fn read(&mut self, address: u16, data: &mut [u8]) {
        self.trigger_pdi_watchdog();
        let mut at = u32::from(address);
        let mut rest = data;
        while !rest.is_empty() {
            let (place, count) = self.locate(at, rest.len());
            let (run, behind) = rest.split_at_mut(count);
            self.pdi_read_run(at, place, run);
            at += count as u32;
            rest = behind;
        }
    }

    fn write(&mut self, address: u16, data: &[u8]) {
        self.trigger_pdi_watchdog();
        let mut at = u32::from(address);
        let mut rest = data;
        while !rest.is_empty() {
            let (place, count) = self.locate(at, rest.len());
            let (run, behind) = rest.split_at(count);
            self.pdi_write_run(at, place, run);
            at += count as u32;
            rest = behind;
        }
    }

    fn events(&mut self) -> AlEvents {
        self.trigger_pdi_watchdog();
        AlEvents(self.events.visible())
    }
}

impl Chip {
    fn pdi_read_run(&mut self, at: u32, place: Place, data: &mut [u8]) {
        match place {
            Place::Register => self.pdi_read_registers(at as u16, data),
            Place::Plain => data.copy_from_slice(self.memory_at(at, data.len())),
            Place::Buffer { index, offset } => match self.pdi_grant(index, Direction::Read, offset, data.len()) {
                Some(at) => {
                    data.copy_from_slice(self.memory_at(at, data.len()));
                    self.sync_managers.get_mut(index).complete(Side::Pdi);
                }
                None => data.fill(0),
            },
            Place::Reserved | Place::Denied | Place::Nowhere => data.fill(0),
        }
    }

    fn pdi_write_run(&mut self, at: u32, place: Place, data: &[u8]) {
        match place {
            Place::Register => self.pdi_write_registers(at as u16, data),
            Place::Plain => self.memory_at(at, data.len()).copy_from_slice(data),
            Place::Buffer { index, offset } => {
                if let Some(at) = self.pdi_grant(index, Direction::Write, offset, data.len()) {
                    self.memory_at(at, data.len()).copy_from_slice(data);
                    self.sync_managers.get_mut(index).complete(Side::Pdi);
                }
            }
            Place::Reserved | Place::Denied | Place::Nowhere => {}
        }
    }

    /// Access to a buffer; touching its first byte acknowledges the sync manager's event.
    fn pdi_grant(&mut self, index: usize, direction: Direction, offset: u16, count: usize) -> Option<u32> {
        let sm = self.sync_managers.get_mut(index);
        let granted = sm.grant(Side::Pdi, direction, offset, count as u16)?;
        let event = AlEvents::sync_manager(index);
        if offset == 0 && sm.is_mailbox() {
            // Mail that has been taken leaves nothing to tell later.
            self.events.cancel(event);
        } else if offset == 0 {
            self.events.acknowledge(event);
        }
        Some(granted)
    }

    fn pdi_read_registers(&mut self, first: u16, data: &mut [u8]) {
        self.refresh(Side::Pdi, Pass::of_slave(self.now), first, data.len() as u16);
        for (address, byte) in (usize::from(first)..).zip(data.iter_mut()) {
            *byte = if Rights::at(address).pdi_reads() {
                self.registers.0[address]
            } else {
                0
            };
        }
        self.acknowledge_al_events(first, data.len() as u16);
    }

    fn acknowledge_al_events(&mut self, first: u16, count: u16) {
        if touches(first, count, AL_CONTROL, 2) {
            self.al_control_locked = false;
            self.events.cancel(AlEvents::AL_CONTROL);
        }
        let activate = |index: u16| SM + SM_SIZE * index + sync_manager::ACTIVATE;
        if (0..SYNC_MANAGERS as u16).any(|index| touches(first, count, activate(index), 1)) {
            self.events.cancel(AlEvents::SM_ACTIVATION);
        }
        self.acknowledge_latch(first, count);
        for (register, event) in [
            (PROCESS_WATCHDOG_STATUS, AlEvents::PROCESS_WATCHDOG),
            (DC_SYNC0_STATUS, AlEvents::SYNC0),
            (DC_SYNC1_STATUS, AlEvents::SYNC1),
        ] {
            if touches(first, count, register, 1) {
                self.events.acknowledge(event);
            }
        }
        for (index, register) in [DC_SYNC0_STATUS, DC_SYNC1_STATUS].into_iter().enumerate() {
            if touches(first, count, register, 1) {
                self.sync_signals.acknowledge(index);
            }
        }
    }

    fn pdi_write_registers(&mut self, first: u16, data: &[u8]) {
        for (address, value) in (usize::from(first)..).zip(data) {
            let rights = Rights::at(address);
            if rights.pdi_writes() && (!rights.is_conditional() || self.condition_of_pdi_write(address as u16)) {
                self.shadow.set(address, *value);
            }
        }
        if !self.shadow.is_empty() {
            let letter = self.shadow.get(RESET_PDI);
            self.commit_registers(Pass::of_slave(self.now));
            if let Some(letter) = letter {
                self.step_reset_by_slave(letter);
            }
        }
    }

    fn condition_of_pdi_write(&self, address: u16) -> bool {
        match address {
            EEPROM_CONTROL..FMMU => self.registers.u8(EEPROM_PDI_ACCESS) & 1 != 0,
            DC_LATCH_CONTROL..DC_LATCH_STATUS => self.slave_owns_latch(usize::from(address - DC_LATCH_CONTROL)),
            _ => self.registers.u8(DC_CYCLIC_CONTROL) & 1 != 0,
        }
    }

    fn trigger_pdi_watchdog(&mut self) {
        let timeout = self.watchdog_timeout(PDI_WATCHDOG_TIME);
        if self.pdi_watchdog.trigger(self.now, timeout).is_some() {
            self.registers.count(PDI_WATCHDOG_COUNTER);
        }
    }
}
