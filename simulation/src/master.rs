//! A master without mercy and without mistakes of its own: what it expects, the drive owes it.

use dictionary::MAX_VALUE_SIZE;
use drive::DriveObjects;
use raw_master::Datagram;
use wire::al::AlState;
use wire::frame::{self, Command};
use wire::register as reg;

use crate::Simulation;
use crate::invariants::{Verdict, must};

/// Where the mailboxes are, and their length.
pub(crate) const MAILBOX_OUT: u16 = 0x1000;
pub(crate) const MAILBOX_IN: u16 = 0x1080;
pub(crate) const MAILBOX: u16 = 0x80;
const OUTPUTS: u16 = 0x1100;
const INPUTS: u16 = 0x1400;
const ALIAS: u16 = 0x2150;

/// What the master keeps of its drive.
#[derive(Clone, Debug)]
pub struct Master {
    /// What it commands.
    pub commands: Commands,
    /// Objects in its outputs, as PDO mappings name them.
    pub outputs: Vec<u32>,
    /// Bytes of inputs.
    pub input_size: usize,
    /// Ticks from one frame to the next.
    pub cycle: u64,
    /// When in a tick the frame is sent, in ns.
    pub offset: u64,
    /// Frames lost in a hundred.
    pub loss: u64,
    /// Whether outputs take effect with SYNC0.
    pub clocks: bool,
    /// Whether the sync managers of the process data have been set up since power-on: without them their memory is open to everybody.
    pub set_up: bool,
    /// Of mailbox messages.
    pub(crate) counter: u8,
}

/// What the master commands, by process data if mapped, else by SDO.
#[derive(Clone, Copy, Debug, Default)]
pub struct Commands {
    /// 0x6040.
    pub controlword: u16,
    /// 0x6060.
    pub mode: i8,
    /// 0x607A.
    pub target: i32,
    /// 0x6081.
    pub speed: i32,
    /// 0x6083.
    pub acceleration: i32,
    /// 0x6084.
    pub deceleration: i32,
    /// 0x60FF.
    pub velocity: i32,
}

impl Default for Master {
    fn default() -> Self {
        Self {
            commands: Commands {
                speed: 10_000,
                acceleration: 100_000,
                deceleration: 100_000,
                ..Commands::default()
            },
            outputs: Vec::new(),
            input_size: 0,
            cycle: 20,
            offset: 0,
            loss: 0,
            clocks: false,
            set_up: false,
            counter: 0,
        }
    }
}

impl Commands {
    /// The value for an object, if it is one of these.
    pub const fn value(&self, index: u16) -> Option<i32> {
        Some(match index {
            0x6040 => self.controlword as i32,
            0x6060 => self.mode as i32,
            0x607A => self.target,
            0x6081 => self.speed,
            0x6083 => self.acceleration,
            0x6084 => self.deceleration,
            0x60FF => self.velocity,
            _ => return None,
        })
    }
}

impl Simulation {
    pub(crate) fn objects(&self) -> &DriveObjects {
        self.bus.drive().device().objects()
    }

    pub(crate) fn al_state(&self) -> AlState {
        self.bus.drive().device().slave().state()
    }

    fn datagram(&mut self, command: Command, register: u16, data: Vec<u8>) -> Option<Vec<u8>> {
        let address = frame::physical_address(0, register);
        let mut datagrams = [Datagram::new(command, address, data)];
        let returned = self.bus.exchange(&mut datagrams);
        let [datagram] = datagrams;
        (returned && datagram.counter == 1).then_some(datagram.data)
    }

    /// Reads registers; nothing if the frame does not come back or nothing can be read there.
    pub(crate) fn read(&mut self, register: u16, count: usize) -> Option<Vec<u8>> {
        self.datagram(Command::Aprd, register, vec![0; count])
    }

    /// Writes registers. Returns whether something there was written.
    pub(crate) fn write(&mut self, register: u16, data: &[u8]) -> bool {
        self.datagram(Command::Apwr, register, data.to_vec()).is_some()
    }

    /// Writes AL control and returns AL status and code right after; nothing without a cable.
    pub(crate) fn request(&mut self, control: u16) -> Option<(u16, u16)> {
        self.write(reg::AL_CONTROL, &control.to_le_bytes());
        let status = self.read(reg::AL_STATUS, 6)?;
        Some((
            u16::from_le_bytes([status[0], status[1]]),
            u16::from_le_bytes([status[4], status[5]]),
        ))
    }

    /// Sets a sync manager up, from off.
    pub(crate) fn set_sync_manager(&mut self, number: u16, start: u16, length: u16, control: u8) {
        let at = reg::SM + number * reg::SM_SIZE;
        self.write(at + 6, &[0]);
        let [start, length] = [start, length].map(u16::to_le_bytes);
        let active = u8::from(length != [0, 0]);
        self.write(at, &[start[0], start[1], length[0], length[1], control, 0, active, 0]);
    }

    pub(crate) fn set_mailboxes(&mut self) {
        self.set_sync_manager(0, MAILBOX_OUT, MAILBOX, 0x26);
        self.set_sync_manager(1, MAILBOX_IN, MAILBOX, 0x22);
    }

    pub(crate) fn set_process_data(&mut self) {
        let outputs = self.outputs().len() as u16;
        self.set_sync_manager(2, OUTPUTS, outputs, 0x64);
        self.set_sync_manager(3, INPUTS, self.master.input_size as u16, 0x20);
        self.master.set_up = true;
    }

    /// The outputs as bytes. What the master has no command for keeps its value.
    fn outputs(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        for mapping in &self.master.outputs {
            let (index, sub, size) = ((mapping >> 16) as u16, (mapping >> 8) as u8, (mapping & 0xFF) as usize / 8);
            match self.master.commands.value(index) {
                Some(value) => bytes.extend_from_slice(&value.to_le_bytes()[..size]),
                None => bytes.extend_from_slice(&self.present(index, sub)[..size]),
            }
        }
        bytes
    }

    /// One cycle of the bus: a frame, and the ticks up to the next.
    pub(crate) fn cycle(&mut self) -> Verdict {
        self.bus.wait_within_tick(self.master.offset);
        let lost = self.master.loss != 0 && self.random.chance(self.master.loss);
        if !lost {
            self.exchange_process_data()?;
        }
        self.ticks(self.master.cycle)
    }

    pub(crate) fn cycles(&mut self, count: u64) -> Verdict {
        (0..count).try_for_each(|_| self.cycle())
    }

    /// The cyclic frame. Its working counters are those of the state that it meets.
    pub(crate) fn exchange_process_data(&mut self) -> Verdict {
        let before = self.al_state();
        let old = self.mapped_values();
        let mut datagrams = vec![
            Datagram::new(Command::Brd, frame::physical_address(0, reg::AL_STATUS), vec![0; 2]),
            Datagram::new(Command::Apwr, frame::physical_address(0, OUTPUTS), self.outputs()),
            Datagram::new(Command::Aprd, frame::physical_address(0, INPUTS), vec![0; self.master.input_size]),
        ];
        datagrams.retain(|datagram| !datagram.data.is_empty());
        let returned = self.bus.exchange(&mut datagrams);
        must(returned == self.bus.is_connected(), || format!("frame came back: {returned}"))?;
        if returned {
            self.check_counters(before, &datagrams)?;
        }
        self.check_effect(before, &old, returned)
    }

    /// Every frame is answered, by what is open in the state.
    fn check_counters(&self, before: AlState, datagrams: &[Datagram]) -> Verdict {
        let status = &datagrams[0];
        must(status.counter == 1 && status.data[0] & 0x0F == before.code(), || {
            format!(
                "AL status {:02X?} with working counter {} in {}",
                status.data,
                status.counter,
                before.name()
            )
        })?;
        let expected = match before {
            AlState::Op => 1,
            // An error in SAFEOP closes the outputs.
            AlState::SafeOp => return Ok(()),
            _ if !self.master.set_up => return Ok(()),
            _ => 0,
        };
        let right = datagrams[1..].iter().all(|datagram| datagram.counter == expected);
        must(right, || {
            let counters: Vec<_> = datagrams.iter().map(|datagram| datagram.counter).collect();
            format!("working counters {counters:?} in {}", before.name())
        })
    }

    /// Outputs act in OP and nowhere else: with the frame, or with SYNC0.
    fn check_effect(&self, before: AlState, old: &[[u8; MAX_VALUE_SIZE]], returned: bool) -> Verdict {
        let after = self.al_state();
        if !returned || after != AlState::Op {
            return must(self.mapped_values() == old, || format!("outputs take effect in {}", after.name()));
        }
        let sent = self.master.commands.controlword;
        let acts = before == AlState::Op && !self.master.clocks;
        must(!acts || self.objects().controlword == sent, || {
            format!("controlword {:04X} after {sent:04X} was sent", self.objects().controlword)
        })
    }

    /// The values of the mapped outputs, but for the alias, which the drive itself takes from the EEPROM after power-on.
    fn mapped_values(&self) -> Vec<[u8; MAX_VALUE_SIZE]> {
        let places = self
            .master
            .outputs
            .iter()
            .map(|mapping| ((mapping >> 16) as u16, (mapping >> 8) as u8));
        let places = places.filter(|(index, _)| *index != ALIAS);
        places.map(|(index, sub)| self.present(index, sub)).collect()
    }
}
