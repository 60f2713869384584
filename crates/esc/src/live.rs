//! Registers whose value is computed when somebody reads them, and what reading them acknowledges.

use wire::Nanos;
use wire::register::*;

use crate::chip::{Chip, Pass};
use crate::clock::LoopSettings;
use crate::registers::SYNC_MANAGERS;
use crate::sync_manager::Side;
use crate::sync_signal::Cycles;

/// Bits of the ECAT event request (0x0210).
pub(crate) mod ecat_event {
    pub(crate) const DC_LATCH: u16 = 1 << 0;
    pub(crate) const DL_STATUS: u16 = 1 << 2;
    pub(crate) const AL_STATUS: u16 = 1 << 3;
    /// Sync manager 0; the others follow.
    pub(crate) const SYNC_MANAGER: u16 = 1 << 4;
}

/// A watchdog tick is (divider + 2) of these, in ns.
const WATCHDOG_CLOCK: u64 = 40;

/// Whether `count` bytes from `first` on and `size` bytes from `register` on have one in common.
pub(crate) const fn touches(first: u16, count: u16, register: u16, size: u16) -> bool {
    first < register + size && register < first + count
}

impl Chip {
    /// Brings the registers among `count` bytes from `first` on up to date, as `side` sees them.
    pub(crate) fn refresh(&mut self, side: Side, pass: Pass, first: u16, count: u16) {
        if touches(first, count, DL_STATUS, 2) {
            self.registers.set(DL_STATUS, &self.dl_status().to_le_bytes());
        }
        if touches(first, count, ECAT_EVENT_REQUEST, 2) {
            self.registers.set(ECAT_EVENT_REQUEST, &self.ecat_events().to_le_bytes());
        }
        if touches(first, count, AL_EVENT_REQUEST, 4) {
            self.registers.set(AL_EVENT_REQUEST, &self.events.visible().to_le_bytes());
        }
        if touches(first, count, PROCESS_WATCHDOG_STATUS, 1) {
            let content = self
                .process_watchdog
                .is_content(pass.entered, self.watchdog_timeout(PROCESS_WATCHDOG_TIME));
            self.registers.set(PROCESS_WATCHDOG_STATUS, &[u8::from(content)]);
        }
        if touches(first, count, SM, SM_SIZE * SYNC_MANAGERS as u16) {
            self.refresh_sync_managers();
        }
        if touches(first, count, DC_SYSTEM_TIME, DC_SYNC1_CYCLE - DC_SYSTEM_TIME) {
            self.refresh_clock(side, pass.arrival);
        }
    }

    fn refresh_sync_managers(&mut self) {
        for index in 0..SYNC_MANAGERS {
            let status = self.sync_managers.get(index).status();
            self.registers.set(SM + SM_SIZE * index as u16 + sync_manager::STATUS, &[status]);
        }
    }

    fn refresh_clock(&mut self, side: Side, at: Nanos) {
        let time = self.system_time(at);
        let shown = match side {
            Side::Ecat => time.wrapping_sub(u64::from(self.registers.u32(DC_SYSTEM_TIME_DELAY))),
            Side::Pdi => time,
        };
        self.registers.set(DC_SYSTEM_TIME, &shown.to_le_bytes());
        let settings = self.loop_settings();
        self.registers
            .set(DC_SYSTEM_TIME_DIFFERENCE, &self.clock.difference().to_le_bytes());
        self.registers
            .set(DC_SPEED_DIFFERENCE, &self.clock.speed_difference(settings).to_le_bytes());
        // The slave's time lags, so pulses that the bus must take for past may not have been made yet.
        let mut signals = self.sync_signals;
        signals.run(time, self.cycles());
        self.registers.set(DC_ACTIVATION_STATUS, &[signals.status()]);
        let (sync0, sync1) = if signals.is_active() {
            signals.next()
        } else {
            (self.start_time, 0)
        };
        self.registers.set(DC_START_TIME, &sync0.to_le_bytes());
        self.registers.set(DC_NEXT_SYNC1, &sync1.to_le_bytes());
        let high = signals.high(time, self.cycles(), self.registers.u16(DC_PULSE_LENGTH));
        let activation = self.registers.u8(DC_ACTIVATION);
        let status = [
            high.sync0 && activation & dc_activation::SYNC0 != 0,
            high.sync1 && activation & dc_activation::SYNC1 != 0,
        ];
        self.registers.set(DC_SYNC0_STATUS, &status.map(u8::from));
    }

    /// The ECAT event request.
    pub(crate) fn ecat_events(&self) -> u16 {
        let mut events = self.ecat_events;
        if self.has_latch_event(false) {
            events |= ecat_event::DC_LATCH;
        }
        for index in 0..SYNC_MANAGERS {
            if self.sync_managers.get(index).has_ecat_event() {
                events |= ecat_event::SYNC_MANAGER << index;
            }
        }
        events
    }

    /// Takes back the ECAT events that the bus's reading of registers acknowledges, at the frame's end.
    pub(crate) fn acknowledge_ecat_events(&mut self, first: u16, count: u16) {
        if touches(first, count, DL_STATUS, 2) {
            self.acknowledged |= ecat_event::DL_STATUS;
        }
        if touches(first, count, AL_STATUS, 2) {
            self.acknowledged |= ecat_event::AL_STATUS;
        }
        self.note_latch_read(first, count);
    }

    /// The chip's copy of the system time.
    pub(crate) fn system_time(&self, at: Nanos) -> u64 {
        self.clock.local(at).wrapping_add(self.registers.u64(DC_SYSTEM_TIME_OFFSET))
    }

    /// The time-out in ns of the watchdog whose time is in `register`.
    pub(crate) fn watchdog_timeout(&self, register: u16) -> u64 {
        let tick = (u64::from(self.registers.u16(WATCHDOG_DIVIDER)) + 2) * WATCHDOG_CLOCK;
        tick * u64::from(self.registers.u16(register))
    }

    /// The control loop's settings.
    pub(crate) fn loop_settings(&self) -> LoopSettings {
        LoopSettings {
            speed_start: self.registers.u16(DC_SPEED_START),
            filter_depth: self.registers.u8(DC_FILTER_DEPTH),
            speed_depth: self.registers.u8(DC_SPEED_FILTER_DEPTH),
        }
    }

    /// The SYNC signals' cycle times.
    pub(crate) fn cycles(&self) -> Cycles {
        Cycles {
            sync0: self.registers.u32(DC_SYNC0_CYCLE),
            sync1: self.registers.u32(DC_SYNC1_CYCLE),
        }
    }
}
