//! A slave controller of memory, sync managers and events, with the master's side of it.

use wire::register::{self as reg, sync_manager as sm};
use wire::{AlEvents, EscAccess};

/// The chip: what the stack sees of it, and what a master does to it.
pub struct Chip {
    pub memory: Vec<u8>,
    pub events: u32,
    full: [bool; 4],
    written: [bool; 4],
    /// Every value of AL status the stack has written.
    pub history: Vec<u16>,
}

impl Chip {
    pub fn new() -> Self {
        let mut memory = vec![0; 0x2_0000];
        memory[usize::from(reg::AL_STATUS)] = 1;
        memory[usize::from(reg::PROCESS_WATCHDOG_TIME)..][..2].copy_from_slice(&1000_u16.to_le_bytes());
        Self {
            memory,
            events: 0,
            full: [false; 4],
            written: [false; 4],
            history: vec![],
        }
    }

    fn u16_at(&self, address: u16) -> u16 {
        let at = usize::from(address);
        u16::from_le_bytes([self.memory[at], self.memory[at + 1]])
    }

    fn sm(&self, index: usize, offset: u16) -> u8 {
        self.memory[usize::from(reg::SM + index as u16 * reg::SM_SIZE + offset)]
    }

    fn area(&self, index: usize) -> (usize, usize) {
        let base = reg::SM + index as u16 * reg::SM_SIZE;
        (usize::from(self.u16_at(base)), usize::from(self.u16_at(base + sm::LENGTH)))
    }

    fn is_mailbox(&self, index: usize) -> bool {
        self.sm(index, sm::CONTROL) & sm::CONTROL_MODE == sm::MODE_MAILBOX
    }

    /// Whether the master gets at the buffer; sync managers have no effect on registers.
    fn accessible(&self, index: usize) -> bool {
        self.area(index).0 >= usize::from(reg::PROCESS_RAM)
            && self.sm(index, sm::ACTIVATE) & 1 != 0
            && self.sm(index, sm::PDI_CONTROL) & sm::PDI_DEACTIVATE == 0
    }

    fn reset_buffer(&mut self, index: usize) {
        (self.full[index], self.written[index]) = (false, false);
        self.events &= !AlEvents::sync_manager(index);
    }

    /// The length of a sync manager's area.
    pub fn length(&self, index: usize) -> u16 {
        self.area(index).1 as u16
    }

    pub fn byte(&self, address: u16) -> u8 {
        self.memory[usize::from(address)]
    }

    pub fn status(&self) -> u16 {
        self.u16_at(reg::AL_STATUS)
    }

    pub fn code(&self) -> u16 {
        self.u16_at(reg::AL_STATUS_CODE)
    }

    pub fn set(&mut self, address: u16, data: &[u8]) {
        self.memory[usize::from(address)..][..data.len()].copy_from_slice(data);
    }

    pub fn request(&mut self, control: u16) {
        self.set(reg::AL_CONTROL, &control.to_le_bytes());
        self.events |= AlEvents::AL_CONTROL;
    }

    pub fn set_sm(&mut self, index: usize, start: u16, length: u16, control: u8, activate: u8) {
        let base = reg::SM + index as u16 * reg::SM_SIZE;
        let toggled = (self.sm(index, sm::ACTIVATE) ^ activate) & 1 != 0;
        self.set(base, &start.to_le_bytes());
        self.set(base + sm::LENGTH, &length.to_le_bytes());
        self.set(base + sm::CONTROL, &[control]);
        self.set(base + sm::ACTIVATE, &[activate]);
        if toggled {
            self.reset_buffer(index);
        }
        self.events |= AlEvents::SM_ACTIVATION;
    }

    pub fn clear_sms(&mut self) {
        for index in 0..4 {
            self.set_sm(index, 0, 0, 0, 0);
        }
    }

    pub fn toggle_repeat(&mut self) {
        let address = reg::SM + reg::SM_SIZE + sm::ACTIVATE;
        self.memory[usize::from(address)] ^= sm::ACTIVATE_REPEAT;
        self.events |= AlEvents::SM_ACTIVATION;
    }

    pub fn repeat_is_answered(&self) -> bool {
        self.sm(1, sm::ACTIVATE) & sm::ACTIVATE_REPEAT == self.sm(1, sm::PDI_CONTROL) & sm::PDI_REPEAT_ACK
    }

    /// Writes a whole mailbox; whether the chip took it.
    pub fn send(&mut self, message: &[u8]) -> bool {
        let (start, length) = self.area(0);
        if !self.accessible(0) || self.full[0] {
            return false;
        }
        self.memory[start..start + length].fill(0);
        let used = message.len().min(length);
        self.memory[start..start + used].copy_from_slice(&message[..used]);
        self.full[0] = true;
        self.events |= AlEvents::sync_manager(0);
        true
    }

    /// Reads a whole mailbox if it is full.
    pub fn receive(&mut self) -> Option<Vec<u8>> {
        if !self.accessible(1) || !self.full[1] {
            return None;
        }
        self.full[1] = false;
        self.events |= AlEvents::sync_manager(1);
        let (start, length) = self.area(1);
        Some(self.memory[start..start + length].to_vec())
    }

    /// Writes the outputs; whether the chip took them.
    pub fn outputs(&mut self, data: &[u8]) -> bool {
        let (start, length) = self.area(2);
        if !self.accessible(2) || data.len() != length {
            return false;
        }
        self.set(start as u16, data);
        self.written[2] = true;
        self.events |= AlEvents::sync_manager(2);
        self.memory[usize::from(reg::PROCESS_WATCHDOG_STATUS)] = 1;
        true
    }

    /// Reads the inputs; `None` if they were never written or the sync manager is off.
    pub fn inputs(&mut self) -> Option<Vec<u8>> {
        let (start, length) = self.area(3);
        self.events |= AlEvents::sync_manager(3);
        (self.accessible(3) && self.written[3]).then(|| self.memory[start..start + length].to_vec())
    }

    pub fn expire_watchdog(&mut self) {
        self.memory[usize::from(reg::PROCESS_WATCHDOG_STATUS)] = 0;
        self.events |= AlEvents::PROCESS_WATCHDOG;
    }

    pub fn set_sync_unit(&mut self, activation: u8, cycle0: u32, cycle1: u32) {
        self.set(reg::DC_ACTIVATION, &[activation]);
        self.set(reg::DC_SYNC0_CYCLE, &cycle0.to_le_bytes());
        self.set(reg::DC_SYNC1_CYCLE, &cycle1.to_le_bytes());
    }

    /// SYNC0 that came `waited` ns ago, on a clock that wraps just then.
    pub fn sync0_ago(&mut self, waited: u64, cycle: u64) {
        self.set(reg::DC_SYSTEM_TIME, &waited.wrapping_sub(7).to_le_bytes());
        self.set(reg::DC_START_TIME, &cycle.wrapping_sub(7).to_le_bytes());
        self.sync0();
    }

    pub fn sync0(&mut self) {
        self.events |= AlEvents::SYNC0;
    }
}

fn covers(address: u16, length: usize, register: u16) -> bool {
    (usize::from(address)..usize::from(address) + length).contains(&usize::from(register))
}

impl EscAccess for Chip {
    fn read(&mut self, address: u16, data: &mut [u8]) {
        let from = usize::from(address);
        for (offset, byte) in data.iter_mut().enumerate() {
            *byte = self.memory.get(from + offset).copied().unwrap_or(0);
        }
        for (register, event) in [
            (reg::AL_CONTROL, AlEvents::AL_CONTROL),
            (reg::SM + sm::ACTIVATE, AlEvents::SM_ACTIVATION),
            (reg::DC_SYNC0_STATUS, AlEvents::SYNC0),
            (reg::DC_SYNC1_STATUS, AlEvents::SYNC1),
            (reg::PROCESS_WATCHDOG_STATUS, AlEvents::PROCESS_WATCHDOG),
        ] {
            if covers(address, data.len(), register) {
                self.events &= !event;
            }
        }
        for index in [0, 2] {
            let (start, length) = self.area(index);
            if self.sm(index, sm::ACTIVATE) & 1 != 0 && from == start && data.len() >= length {
                self.full[index] = false;
                self.events &= !AlEvents::sync_manager(index);
            }
        }
        let status = reg::SM + reg::SM_SIZE + sm::STATUS;
        if covers(address, data.len(), status) {
            data[usize::from(status - address)] = if self.full[1] { sm::STATUS_FULL } else { 0 };
        }
    }

    fn write(&mut self, address: u16, data: &[u8]) {
        let from = usize::from(address);
        for index in [1, 3] {
            let (start, length) = self.area(index);
            if self.sm(index, sm::ACTIVATE) & 1 != 0 && from == start && from >= usize::from(reg::PROCESS_RAM) {
                if !self.accessible(index) || (self.is_mailbox(index) && self.full[index]) {
                    return;
                }
                self.full[index] = data.len() >= length;
                self.written[index] = data.len() >= length;
                self.events &= !AlEvents::sync_manager(index);
            }
        }
        for (offset, &byte) in data.iter().enumerate() {
            if let Some(cell) = self.memory.get_mut(from + offset) {
                *cell = byte;
            }
        }
        for index in 0..4 {
            let control = reg::SM + index as u16 * reg::SM_SIZE + sm::PDI_CONTROL;
            if covers(address, data.len(), control) && self.sm(index, sm::PDI_CONTROL) & sm::PDI_DEACTIVATE != 0 {
                self.reset_buffer(index);
            }
        }
        if covers(address, data.len(), reg::AL_STATUS) {
            self.history.push(self.status());
        }
    }

    fn events(&mut self) -> AlEvents {
        AlEvents(self.events)
    }
}
