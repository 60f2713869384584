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
        " From the event to data ready for the bus in ns.\n",
    ),
    row(
        0x08,
        "Get Cycle Time",
        DataType::Unsigned16,
        Access::RW,
        " Writing 1 starts a measurement of times.\n",
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
        " Events that came before the last was served.\n",
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
    /// Whether outputs and SYNC0 were out of step.
    pub(crate) error: bool,
    get_cycle: u16,
    minimum_cycle: u32,
    types: &'static [u16],
}

impl SyncParameters {
    /// 0x1C32 for a device with this shortest cycle.
    pub(crate) const fn outputs(minimum_cycle: u32) -> Self {
        Self::new(minimum_cycle, &[sync_type::FREE_RUN, sync_type::SYNC_MANAGER, sync_type::SYNC0])
    }

    /// 0x1C33 for a device with this shortest cycle.
    pub(crate) const fn inputs(minimum_cycle: u32) -> Self {
        use sync_type::{FREE_RUN, SYNC_MANAGER, SYNC_MANAGER_2, SYNC0, SYNC1};
        Self::new(minimum_cycle, &[FREE_RUN, SYNC_MANAGER, SYNC_MANAGER_2, SYNC0, SYNC1])
    }

    const fn new(minimum_cycle: u32, types: &'static [u16]) -> Self {
        Self {
            sync_type: sync_type::FREE_RUN,
            chosen: false,
            cycle: 0,
            sync0_cycle: 0,
            missed: 0,
            error: false,
            get_cycle: 0,
            minimum_cycle,
            types,
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
        self.types.iter().fold(0, |bits, kind| {
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
            // The stack copies within the event itself.
            0x06 | 0x09 => 0_u32.put(out),
            0x08 => self.get_cycle.put(out),
            0x0A => self.sync0_cycle.put(out),
            0x0B => self.missed.put(out),
            0x0C => 0_u16.put(out),
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
            0x08 => self.get_cycle = u16::take(data).ok_or(AbortCode::LengthMismatch)?,
            0x0A => self.sync0_cycle = u32::take(data).ok_or(AbortCode::LengthMismatch)?,
            _ => return Err(AbortCode::ReadOnly),
        }
        Ok(())
    }
}
