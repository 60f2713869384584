//! The end of a frame: completed buffers change hands, accepted register writes take effect.

use wire::register::*;
use wire::{AlEvents, Nanos};

use crate::chip::{Chip, Pass};
use crate::live::ecat_event;
use crate::registers::{Rights, SYNC_MANAGERS};
use crate::sync_manager::Side;
use crate::sync_signal::{Pulses, StartRules};

/// Groups of counters that a write to any of them clears together.
const COUNTER_GROUPS: [(u16, u16); 5] = [
    (RX_ERROR_COUNTERS, 12),
    (PROCESSING_ERROR_COUNTER, 1),
    (PDI_ERROR_COUNTER, 2),
    (LOST_LINK_COUNTERS, 4),
    (PROCESS_WATCHDOG_COUNTER, 2),
];

impl Chip {
    /// Ends a frame that was whole.
    pub(crate) fn commit_frame(&mut self, pass: Pass) {
        while self.touched != 0 {
            let index = self.touched.trailing_zeros() as usize;
            self.touched &= self.touched - 1;
            self.complete_ecat_access(index, pass.entered);
        }
        self.ecat_events &= !self.acknowledged;
        self.acknowledged = 0;
        if self.has_read_latch() {
            self.finish_latch_read(true);
        }
        let mut letter = None;
        if !self.shadow.is_empty() {
            letter = self.shadow.get(RESET);
            self.commit_registers(pass);
        }
        if letter.is_some() || self.reset[0].is_under_way() {
            self.step_reset_by_bus(letter, pass.frame);
        }
    }

    /// Ends a frame of broken structure: nothing it wrote to registers counts.
    pub(crate) fn drop_frame(&mut self) {
        for index in 0..SYNC_MANAGERS {
            if self.touched >> index & 1 != 0 {
                self.sync_managers.get_mut(index).abandon();
            }
        }
        self.touched = 0;
        self.acknowledged = 0;
        self.finish_latch_read(false);
        self.shadow.clear();
        self.registers.count(PROCESSING_ERROR_COUNTER);
    }

    fn complete_ecat_access(&mut self, index: usize, at: Nanos) {
        let sm = self.sync_managers.get_mut(index);
        if !sm.complete(Side::Ecat) {
            return;
        }
        let triggers = sm.bus_writes() && sm.has_control(sync_manager::CONTROL_WATCHDOG);
        if sm.has_control(sync_manager::CONTROL_AL_EVENT) {
            self.events.raise_at(at, AlEvents::sync_manager(index));
        }
        if triggers {
            let timeout = self.watchdog_timeout(PROCESS_WATCHDOG_TIME);
            if let Some(expired) = self.process_watchdog.trigger(at, timeout) {
                self.registers.count(PROCESS_WATCHDOG_COUNTER);
                self.events.raise_at(expired, AlEvents::PROCESS_WATCHDOG);
            }
        }
    }

    /// Makes the shadowed writes of one frame, or of one access of the slave, take effect.
    pub(crate) fn commit_registers(&mut self, pass: Pass) {
        self.before_store(pass.arrival);
        for (address, value) in self.shadow.iter() {
            if !Rights::at(address).is_trigger() {
                self.registers.0[address] = value;
            }
        }
        self.after_store(pass);
        self.shadow.clear();
    }

    /// What needs the registers as they were before.
    fn before_store(&mut self, at: Nanos) {
        if self.shadow.any(DC_SYSTEM_TIME, 8) {
            self.follow_system_time(at);
        }
        let status = [self.registers.u8(AL_STATUS), self.registers.u8(AL_STATUS + 1)];
        let new = [AL_STATUS, AL_STATUS + 1].map(|address| self.shadow.get(address));
        if new.iter().zip(status).any(|(new, old)| new.is_some_and(|new| new != old)) {
            self.ecat_events |= ecat_event::AL_STATUS;
        }
    }

    fn after_store(&mut self, pass: Pass) {
        let at = pass.entered;
        self.commit_loop_control(at, pass.frame);
        if self
            .shadow
            .any(WRITE_REGISTER_ENABLE, ESC_WRITE_PROTECTION - WRITE_REGISTER_ENABLE + 1)
        {
            self.protection.configure(&self.registers);
        }
        if self.shadow.any(AL_CONTROL, 2) {
            self.al_control_locked = true;
            self.events.raise_at(at, AlEvents::AL_CONTROL);
        }
        for (first, count) in COUNTER_GROUPS {
            if self.shadow.any(first, count) {
                self.registers.0[usize::from(first)..usize::from(first + count)].fill(0);
            }
        }
        if self.shadow.any(WATCHDOG_DIVIDER, 2) || self.shadow.any(PROCESS_WATCHDOG_TIME, 2) {
            self.process_watchdog.restart(at);
        }
        if self.shadow.any(WATCHDOG_DIVIDER, 2) || self.shadow.any(PDI_WATCHDOG_TIME, 2) {
            self.pdi_watchdog.restart(at);
        }
        if self.shadow.any(EEPROM_CONFIGURATION, 4) {
            self.commit_eeprom();
        }
        if self.shadow.any(FMMU, FMMU_SIZE * 8) {
            self.fmmus.configure(&self.registers);
        }
        if self.shadow.any(SM, SM_SIZE * SYNC_MANAGERS as u16) {
            self.commit_sync_managers(at);
        }
        if self.shadow.any(DC_RECEIVE_TIMES, 0x100) {
            self.commit_clock(pass);
        }
    }

    fn commit_eeprom(&mut self) {
        let configuration = self.registers.u8(EEPROM_CONFIGURATION);
        let granted = configuration & 0b11 == 0b01 || self.shadow.get(EEPROM_PDI_ACCESS).is_none();
        let taken = self.registers.u8(EEPROM_PDI_ACCESS) & 1 != 0 && granted && configuration & 0b10 == 0;
        self.registers.set(EEPROM_PDI_ACCESS, &[u8::from(taken)]);
        self.eeprom_command(self.shadow.get(EEPROM_CONTROL), self.shadow.get(EEPROM_CONTROL + 1));
    }

    fn commit_sync_managers(&mut self, at: Nanos) {
        for index in 0..SYNC_MANAGERS {
            let base = SM + SM_SIZE * index as u16;
            if !self.shadow.any(base, SM_SIZE) {
                continue;
            }
            if self.sync_managers.configure(index, self.registers.bytes(base)) {
                self.events.cancel(AlEvents::sync_manager(index));
            }
            if self.shadow.get(base + sync_manager::ACTIVATE).is_some() {
                self.events.raise_at(at, AlEvents::SM_ACTIVATION);
            }
        }
    }

    fn commit_clock(&mut self, pass: Pass) {
        let at = pass.arrival;
        if self.shadow.get(DC_RECEIVE_TIMES).is_some() {
            self.latch_receive_times(pass.frame, at);
        }
        if self.shadow.any(DC_SPEED_START, 2) {
            self.clock.reset_loop(at);
        }
        if self.shadow.any(DC_LATCH_CONTROL, 2) {
            self.commit_latch_control();
        }
        let start_written = self.shadow.any(DC_START_TIME, 8);
        if start_written {
            self.start_time = self.registers.u64(DC_START_TIME);
            self.short_start = !self.shadow.any(DC_START_TIME + 4, 4);
        }
        let written = self.registers.u8(DC_ACTIVATION);
        let mut activation = written & !dc_activation::DEBUG_PULSE;
        if start_written && activation & dc_activation::AUTO != 0 {
            activation |= dc_activation::CYCLIC;
        }
        self.registers.set(DC_ACTIVATION, &[activation]);
        if written & dc_activation::DEBUG_PULSE != 0 {
            let events = self.reported(Pulses { sync0: true, sync1: true });
            self.events.raise_at(pass.entered, events);
        }
        match (activation & dc_activation::CYCLIC != 0, self.sync_signals.is_active()) {
            (true, false) => self.start_sync_signals(activation, at),
            (false, true) => self.sync_signals.stop(),
            _ => {}
        }
    }

    fn start_sync_signals(&mut self, activation: u8, at: Nanos) {
        let rules = StartRules {
            short: self.short_start || activation & dc_activation::EXTEND_START != 0,
            plausibility: activation & dc_activation::PLAUSIBILITY != 0,
            near: activation & dc_activation::NEAR_FUTURE != 0,
        };
        let now = self.system_time(at);
        self.sync_signals.start(self.start_time, now, rules, self.cycles());
    }

    /// Compares the system time that the frame brought with the chip's own at the frame's start; only 32 bits count.
    fn follow_system_time(&mut self, at: Nanos) {
        let delay = self.registers.u32(DC_SYSTEM_TIME_DELAY);
        let own = (self.system_time(at) as u32).wrapping_sub(delay);
        let mut received = own.to_le_bytes();
        for (offset, byte) in received.iter_mut().enumerate() {
            *byte = self.shadow.get(DC_SYSTEM_TIME + offset as u16).unwrap_or(*byte);
        }
        let difference = own.wrapping_sub(u32::from_le_bytes(received)) as i32;
        self.clock.follow(at, difference, self.loop_settings());
    }
}
