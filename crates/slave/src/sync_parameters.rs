//! 0x1C32 and 0x1C33: how the process data are synchronised (ETG.1020, synchronisation parameters).

use dictionary::{AbortCode, Access, DataType, MAX_VALUE_SIZE, Value};

/// One sub-index of 0x1C32 and 0x1C33.
pub(crate) struct Row {
    pub(crate) sub: u8,
    pub(crate) name: &'static str,
    pub(crate) data_type: DataType,
    pub(crate) access: Access,
    pub(crate) doc: &'static str,
}

const fn row(sub: u8, name: &'static str, data_type: DataType, access: Access, doc: &'static str) -> Row {
    Row {
        sub,
        name,
        data_type,
        access,
        doc,
    }
}

/// The sub-indices that exist; the others answer 0x06090011.
pub(crate) const ROWS: [Row; 11] = [
    row(
        0x01,
        "Synchronization Type",
        DataType::Unsigned16,
        Access::RW_PREOP,
        " What the process data follow.\n",
    ),
    row(
        0x02,
        "Cycle Time",
        DataType::Unsigned32,
        Access::RO,
        " Time between two events of synchronisation in ns.\n",
    ),
    row(
        0x04,
        "Synchronization Types supported",
        DataType::Unsigned16,
        Access::RO,
        " A bit for every type there is.\n",
    ),
    row(
        0x05,
        "Minimum Cycle Time",
        DataType::Unsigned32,
        Access::RO,
        " The shortest cycle in ns.\n",
    ),
    row(
        0x06,
        "Calc and Copy Time",
        DataType::Unsigned32,
        Access::RO,
        " How long before SYNC0 outputs must come to take effect with it, or from the event to inputs ready for the bus, in ns.\n",
    ),
    row(
        0x08,
        "Get Cycle Time",
        DataType::Unsigned16,
        Access::RW,
        " Writing 1 starts to measure the longest delay, or calc and copy time; 0 ends it.\n",
    ),
    row(
        0x09,
        "Delay Time",
        DataType::Unsigned32,
        Access::RO,
        " From the event to outputs in effect in ns.\n",
    ),
    row(
        0x0A,
        "Sync0 Cycle Time",
        DataType::Unsigned32,
        Access::RW,
        " Time between two SYNC0 in ns.\n",
    ),
    row(
        0x0B,
        "SM-Event Missed",
        DataType::Unsigned16,
        Access::RO,
        " SYNC0 without new outputs, since OP began.\n",
    ),
    row(
        0x0C,
        "Cycle Time Too Small",
        DataType::Unsigned16,
        Access::RO,
        " Events that came before the inputs of the last were ready, or that were not served at all, since OP began.\n",
    ),
    row(
        0x20,
        "Sync Error",
        DataType::Boolean,
        Access::RO,
        " Outputs and SYNC0 were out of step.\n",
    ),
];

/// What process data can follow: values of sub-index 1.
pub(crate) mod sync_type {
    /// Nothing: a local timer.
    pub(crate) const FREE_RUN: u16 = 0x00;
    /// The event of the own sync manager.
    pub(crate) const SYNC_MANAGER: u16 = 0x01;
    /// SYNC0.
    pub(crate) const SYNC0: u16 = 0x02;
    /// SYNC1.
    pub(crate) const SYNC1: u16 = 0x03;
    /// The event of sync manager 2, for inputs.
    pub(crate) const SYNC_MANAGER_2: u16 = 0x22;
}

/// Bit of sub-index 4: times are measured on request.
const DYNAMIC_TIMES: u16 = 1 << 14;

/// Which of the two objects it is.
#[derive(Clone, Copy, Debug)]
enum Direction {
    Outputs,
    Inputs,
}

/// The values of 0x1C32 or of 0x1C33.
#[derive(Clone, Debug)]
pub(crate) struct SyncParameters {
    /// What the process data follow, from [`sync_type`].
    pub(crate) sync_type: u16,
    /// Whether the master wrote the type itself since the mailbox was started.
    pub(crate) chosen: bool,
    /// Time between two events in ns.
    pub(crate) cycle: u32,
    /// Time between two SYNC0 in ns.
    pub(crate) sync0_cycle: u32,
    /// SYNC0 without new outputs.
    pub(crate) missed: u16,
    /// Events that came too early for the one before.
    pub(crate) too_small: u16,
    /// Whether outputs and SYNC0 were out of step.
    pub(crate) error: bool,
    direction: Direction,
    get_cycle: u16,
    minimum_cycle: u32,
    /// What the device states as its longest reaction to an event, in ns.
    stated: u32,
    /// The longest reaction: measured if the master has asked for it, as stated if not.
    longest: u32,
    types: &'static [u16],
}

impl SyncParameters {
    /// 0x1C32 for a device with this shortest cycle, which reacts to an event within so many ns.
    pub(crate) const fn outputs(minimum_cycle: u32, reaction: u32) -> Self {
        use sync_type::{FREE_RUN, SYNC_MANAGER, SYNC0};
        Self::new(Direction::Outputs, minimum_cycle, reaction, &[FREE_RUN, SYNC_MANAGER, SYNC0])
    }

    /// 0x1C33 for the same device.
    pub(crate) const fn inputs(minimum_cycle: u32, reaction: u32) -> Self {
        use sync_type::{FREE_RUN, SYNC_MANAGER, SYNC_MANAGER_2, SYNC0, SYNC1};
        let types = &[FREE_RUN, SYNC_MANAGER, SYNC_MANAGER_2, SYNC0, SYNC1];
        Self::new(Direction::Inputs, minimum_cycle, reaction, types)
    }

    const fn new(direction: Direction, minimum_cycle: u32, reaction: u32, types: &'static [u16]) -> Self {
        Self {
            sync_type: sync_type::FREE_RUN,
            chosen: false,
            cycle: 0,
            sync0_cycle: 0,
            missed: 0,
            too_small: 0,
            error: false,
            direction,
            get_cycle: 0,
            minimum_cycle,
            stated: reaction,
            longest: reaction,
            types,
        }
    }

    /// OP begins: its counters start anew.
    pub(crate) fn start_counting(&mut self) {
        (self.missed, self.too_small) = (0, 0);
    }

    /// Whether the master has asked for measured times.
    pub(crate) const fn is_measuring(&self) -> bool {
        self.get_cycle != 0
    }

    /// Outputs took effect, or inputs were ready, so many ns after their event.
    pub(crate) fn reacted(&mut self, nanoseconds: u32) {
        if self.is_measuring() {
            self.longest = self.longest.max(nanoseconds);
        }
    }

    /// Calc and copy time: outputs must be there by the poll before SYNC0; inputs are ready when their event has been served.
    const fn calc_and_copy(&self) -> u32 {
        match self.direction {
            Direction::Outputs => self.stated,
            Direction::Inputs => self.longest,
        }
    }

    /// Delay time: inputs are taken while their calc and copy time runs, not before it.
    const fn delay(&self) -> u32 {
        match self.direction {
            Direction::Outputs => self.longest,
            Direction::Inputs => 0,
        }
    }

    /// Sets the type that follows from the chip's set-up, unless the master has chosen one.
    pub(crate) fn derive_type(&mut self, derived: u16) {
        if !self.chosen {
            self.sync_type = derived;
        }
    }

    /// The bits of sub-index 4: types 0 and 1 have bits of their own, 0x22 shares that of type 1, SYNC0 and SYNC1 make up a field.
    fn supported(&self) -> u16 {
        self.types.iter().fold(DYNAMIC_TIMES, |bits, kind| {
            bits | if *kind == sync_type::SYNC_MANAGER_2 { 1 << 1 } else { 1 << kind }
        })
    }

    /// Copies the value of a sub-index to `out` and returns its size in bytes; 0 for one that does not exist.
    pub(crate) fn load(&self, sub: u8, out: &mut [u8; MAX_VALUE_SIZE]) -> usize {
        match sub {
            0x01 => self.sync_type.put(out),
            0x02 => self.cycle.put(out),
            0x04 => self.supported().put(out),
            0x05 => self.minimum_cycle.put(out),
            0x06 => self.calc_and_copy().put(out),
            0x08 => self.get_cycle.put(out),
            0x09 => self.delay().put(out),
            0x0A => self.sync0_cycle.put(out),
            0x0B => self.missed.put(out),
            0x0C => self.too_small.put(out),
            0x20 => self.error.put(out),
            _ => 0,
        }
    }

    /// Replaces the value of a sub-index that can be written.
    pub(crate) fn store(&mut self, sub: u8, data: &[u8]) -> Result<(), AbortCode> {
        match sub {
            0x01 => {
                let kind = u16::take(data).ok_or(AbortCode::LengthMismatch)?;
                if !self.types.contains(&kind) {
                    return Err(AbortCode::ValueRange);
                }
                (self.sync_type, self.chosen) = (kind, true);
            }
            0x08 => match u16::take(data).ok_or(AbortCode::LengthMismatch)? {
                0 => self.get_cycle = 0,
                1 => (self.get_cycle, self.longest) = (1, 0),
                _ => return Err(AbortCode::ValueRange),
            },
            0x0A => self.sync0_cycle = u32::take(data).ok_or(AbortCode::LengthMismatch)?,
            _ => return Err(AbortCode::ReadOnly),
        }
        Ok(())
    }
}
