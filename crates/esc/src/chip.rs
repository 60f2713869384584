//! The chip: its parts together, power-on, passing of time, one frame through it.

use core::fmt;

use wire::frame::SOURCE_ADDRESS;
use wire::register::*;
use wire::{AlEvents, Nanos};

use crate::clock::Clock;
use crate::eeprom::{EEPROM_SIZE, Eeprom};
use crate::event::Events;
use crate::fmmu::Fmmus;
use crate::latch::Latches;
use crate::memory::MEMORY_BYTES;
use crate::ports::Ports;
use crate::protection::WriteProtection;
use crate::registers::{FMMUS, Registers, SYNC_MANAGERS};
use crate::reset::ResetSequence;
use crate::shadow::Shadow;
use crate::sync_managers::SyncManagers;
use crate::sync_signal::{Pulses, SyncSignals};
use crate::walk::Journey;
use crate::watchdog::Watchdog;

/// Set in the source address of every frame that a slave has processed: "locally administered". By it a master tells its own frames
/// from those that come back.
const PROCESSED_SOURCE: u8 = 0x02;

/// Ports of the ET1100 as most devices use it: one in, one out.
const USUAL_PORTS: usize = 2;

/// Register values after power-on that are not zero.
const RESET_VALUES: [(u16, &[u8]); 12] = [
    (TYPE, &[0x11, 0x00, 0x03, 0x00]), // ET1100-0003
    (FMMU_COUNT, &[FMMUS as u8, SYNC_MANAGERS as u8, 8]),
    (FEATURES, &[0xFC, 0x00]), // 64-bit distributed clocks, bitwise FMMUs, all commands
    (DL_CONTROL, &[0x01, 0x00, 0x07, 0x00]),
    (AL_CONTROL, &[0x01]),
    (AL_STATUS, &[0x01]),
    (AL_EVENT_MASK, &[0x0F, 0x0F, 0xFF, 0x00]),
    (WATCHDOG_DIVIDER, &[0xC2, 0x09]),      // 100 us
    (PDI_WATCHDOG_TIME, &[0xE8, 0x03]),     // 100 ms
    (PROCESS_WATCHDOG_TIME, &[0xE8, 0x03]), // 100 ms
    (DC_SPEED_START, &[0x00, 0x10]),
    (DC_FILTER_DEPTH, &[0x04, 0x0C]),
];

/// What distinguishes one chip from another.
#[derive(Clone, Copy)]
pub struct ChipConfig {
    /// Contents of the SII EEPROM.
    pub eeprom: [u8; EEPROM_SIZE],
    /// What the local clock shows at time 0, in ns.
    pub clock_offset_ns: u64,
    /// How much too fast the local clock runs, in parts per billion; crystals are within ±100 000.
    pub clock_ppb: i32,
}

/// When a frame passes a chip.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pass {
    /// It entered the segment: the instant that the slave's time and the watchdogs go by, the same for every chip of the line.
    pub(crate) entered: Nanos,
    /// Its start reaches the chip on the way to the processing unit.
    pub(crate) arrival: Nanos,
    /// Its number, by which it is known when it comes back; 0 for none.
    pub(crate) frame: u64,
}

impl Pass {
    /// An access of the slave, which is no frame.
    pub(crate) const fn of_slave(now: Nanos) -> Self {
        Self {
            entered: now,
            arrival: now,
            frame: 0,
        }
    }
}

/// An ET1100-class slave controller.
///
/// Frames reach it through [`crate::Segment::process`], its slave stack through [`wire::EscAccess`]. The two sides have their own
/// time: a frame is answered at once, the slave's time follows with [`Chip::advance`]. What a frame stores is in memory at once;
/// the events it raises become visible when the slave's time has reached the frame's arrival.
#[derive(Clone)]
pub struct Chip {
    pub(crate) registers: Registers,
    pub(crate) shadow: Shadow,
    pub(crate) memory: [u8; MEMORY_BYTES],
    pub(crate) fmmus: Fmmus,
    pub(crate) sync_managers: SyncManagers,
    /// Sync managers that the present frame has accessed, a bit each.
    pub(crate) touched: u8,
    pub(crate) eeprom: Eeprom,
    pub(crate) clock: Clock,
    pub(crate) sync_signals: SyncSignals,
    pub(crate) start_time: u64,
    pub(crate) short_start: bool,
    pub(crate) process_watchdog: Watchdog,
    pub(crate) pdi_watchdog: Watchdog,
    pub(crate) events: Events,
    pub(crate) ecat_events: u16,
    /// ECAT events that the present frame takes back.
    pub(crate) acknowledged: u16,
    pub(crate) al_control_locked: bool,
    pub(crate) protection: WriteProtection,
    pub(crate) ports: Ports,
    pub(crate) latches: Latches,
    /// Progress of the reset sequences at 0x0040 and 0x0041.
    pub(crate) reset: [ResetSequence; 2],
    pub(crate) resets: u32,
    /// The slave's time.
    pub(crate) now: Nanos,
    clock_offset_ns: u64,
    clock_ppb: i32,
}

impl Chip {
    /// A chip with two ports, 0 towards the master and 1 away from it, just powered on and without links.
    pub fn new(config: ChipConfig) -> Self {
        Self::with_ports(config, USUAL_PORTS)
    }

    /// A chip with the first `ports` of four ports, 1 to 4: three or four make a junction of it.
    pub fn with_ports(config: ChipConfig, ports: usize) -> Self {
        let mut chip = Self {
            registers: Registers::new(),
            shadow: Shadow::new(),
            memory: [0; MEMORY_BYTES],
            fmmus: Fmmus::new(),
            sync_managers: SyncManagers::new(),
            touched: 0,
            eeprom: Eeprom {
                image: config.eeprom,
                writes: 0,
            },
            clock: Clock::new(config.clock_offset_ns, config.clock_ppb),
            sync_signals: SyncSignals::default(),
            start_time: 0,
            short_start: false,
            process_watchdog: Watchdog::default(),
            pdi_watchdog: Watchdog::default(),
            events: Events::default(),
            ecat_events: 0,
            acknowledged: 0,
            al_control_locked: false,
            protection: WriteProtection::default(),
            ports: Ports::new(ports),
            latches: Latches::default(),
            reset: [ResetSequence::default(); 2],
            resets: 0,
            now: Nanos(0),
            clock_offset_ns: config.clock_offset_ns,
            clock_ppb: config.clock_ppb,
        };
        chip.load_registers();
        chip
    }

    /// Puts the chip into the state after power-on. The EEPROM keeps its contents and is loaded; cables and time stay as they are.
    pub fn power_cycle(&mut self) {
        self.restart();
        self.ports.control(0);
    }

    /// Everything as after power-on, but the loops.
    pub(crate) fn restart(&mut self) {
        let config = ChipConfig {
            eeprom: self.eeprom.image,
            clock_offset_ns: self.clock_offset_ns,
            clock_ppb: self.clock_ppb,
        };
        let restarted = Self::with_ports(config, self.ports.count());
        let before = core::mem::replace(self, restarted);
        self.ports = before.ports;
        self.ports.forget_temporary();
        self.now = before.now;
        self.eeprom.writes = before.eeprom.writes;
        self.resets = before.resets;
    }

    fn load_registers(&mut self) {
        for (address, bytes) in RESET_VALUES {
            self.registers.set(address, bytes);
        }
        self.registers.set(PORT_DESCRIPTOR, &[self.ports.descriptor()]);
        self.load_eeprom();
    }

    /// Lets the slave's time pass until `now`: events of frames become visible, watchdogs expire, SYNC signals fire.
    ///
    /// A time before that of an earlier call changes nothing; one before that of the last frame is usual.
    pub fn advance(&mut self, now: Nanos) {
        self.now = self.now.max(now);
        self.events.release(self.now);
        self.settle_ports(self.now);
        if self.process_watchdog.poll(self.now, self.watchdog_timeout(PROCESS_WATCHDOG_TIME)) {
            self.registers.count(PROCESS_WATCHDOG_COUNTER);
            self.events.raise(AlEvents::PROCESS_WATCHDOG);
        }
        if self.pdi_watchdog.poll(self.now, self.watchdog_timeout(PDI_WATCHDOG_TIME)) {
            self.registers.count(PDI_WATCHDOG_COUNTER);
        }
        if self.sync_signals.is_active() {
            self.run_sync_signals();
        }
    }

    fn run_sync_signals(&mut self) {
        let time = self.system_time(self.now);
        let pulses = self.sync_signals.run(time, self.cycles());
        let events = self.reported(pulses);
        self.events.raise(events);
    }

    /// The events that pulses raise: those of signals that the master has switched on and the EEPROM lets the chip report.
    pub(crate) fn reported(&self, pulses: Pulses) -> u32 {
        let activation = self.registers.u8(DC_ACTIVATION);
        let reported = self.registers.u8(SYNC_LATCH_CONFIGURATION);
        let event = |pulse, signal, report, event| {
            if pulse && activation & signal != 0 && reported & report != 0 {
                event
            } else {
                0
            }
        };
        event(pulses.sync0, dc_activation::SYNC0, 1 << 3, AlEvents::SYNC0)
            | event(pulses.sync1, dc_activation::SYNC1, 1 << 7, AlEvents::SYNC1)
    }

    /// The EEPROM's contents.
    pub fn eeprom(&self) -> &[u8; EEPROM_SIZE] {
        &self.eeprom.image
    }

    /// How many words have been written to the EEPROM since the chip was made; wraps. Tells the host when to save it.
    pub fn eeprom_writes(&self) -> u32 {
        self.eeprom.writes
    }

    /// Lets a frame pass through the processing unit.
    pub(crate) fn pass_frame(&mut self, journey: &mut Journey, pass: Pass) {
        self.ports.last_frame = Some(pass.entered);
        journey.frame[SOURCE_ADDRESS] |= PROCESSED_SOURCE;
        self.protection.begin_frame();
        let mut walk = journey.layout.walk();
        while let Some(mut datagram) = walk.next_mut(journey.frame) {
            self.execute(pass, &mut datagram);
        }
        if journey.intact {
            self.commit_frame(pass);
        } else {
            self.drop_frame();
        }
    }
}

impl AsMut<Self> for Chip {
    fn as_mut(&mut self) -> &mut Self {
        self
    }
}

impl fmt::Debug for Chip {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Chip")
            .field("station_address", &self.registers.u16(STATION_ADDRESS))
            .field("al_control", &self.registers.u16(AL_CONTROL))
            .field("al_status", &self.registers.u16(AL_STATUS))
            .field("ports", &self.ports)
            .field("now", &self.now)
            .finish_non_exhaustive()
    }
}
