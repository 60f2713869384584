//! The register file, and who may read and write which byte (ESC data sheet, section II).

use wire::register::*;

/// Bytes of the register file; what lies between it and the memory is reserved.
pub(crate) const REGISTER_BYTES: usize = 0x0A00;
/// FMMUs of the chip.
pub(crate) const FMMUS: usize = 8;
/// Sync managers of the chip.
pub(crate) const SYNC_MANAGERS: usize = 8;

/// The access rights of one register byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Rights(u8);

impl Rights {
    const ECAT_READ: u8 = 1 << 0;
    const ECAT_WRITE: u8 = 1 << 1;
    const PDI_READ: u8 = 1 << 2;
    const PDI_WRITE: u8 = 1 << 3;
    const CONDITIONAL: u8 = 1 << 4;
    const TRIGGER: u8 = 1 << 5;

    /// The rights at `address`, which may be any.
    pub(crate) fn at(address: usize) -> Self {
        Self(RIGHTS.get(address).copied().unwrap_or(0))
    }

    pub(crate) const fn ecat_reads(self) -> bool {
        self.0 & Self::ECAT_READ != 0
    }

    pub(crate) const fn ecat_writes(self) -> bool {
        self.0 & Self::ECAT_WRITE != 0
    }

    pub(crate) const fn pdi_reads(self) -> bool {
        self.0 & Self::PDI_READ != 0
    }

    pub(crate) const fn pdi_writes(self) -> bool {
        self.0 & Self::PDI_WRITE != 0
    }

    /// Whether writing depends on the chip's state as well.
    pub(crate) const fn is_conditional(self) -> bool {
        self.0 & Self::CONDITIONAL != 0
    }

    /// Whether a write acts but is not stored.
    pub(crate) const fn is_trigger(self) -> bool {
        self.0 & Self::TRIGGER != 0
    }
}

/// Both sides read.
const R: u8 = Rights::ECAT_READ | Rights::PDI_READ;
/// The bus writes, both read.
const BUS: u8 = R | Rights::ECAT_WRITE;
/// The bus writes if the chip's state lets it, both read.
const BUS_IF: u8 = BUS | Rights::CONDITIONAL;
/// The slave writes, both read.
const SLAVE: u8 = R | Rights::PDI_WRITE;
/// Whoever owns the unit writes, both read.
const OWNER: u8 = R | Rights::ECAT_WRITE | Rights::PDI_WRITE | Rights::CONDITIONAL;
/// The bus writes to make something happen, both read.
const BUS_ACT: u8 = BUS | Rights::TRIGGER;

/// First byte, number of bytes, rights. What is not listed is reserved.
const RANGES: [(u16, u16, u8); 57] = [
    (TYPE, 10, R),
    (STATION_ADDRESS, 2, BUS),
    (STATION_ALIAS, 2, SLAVE),
    (WRITE_REGISTER_ENABLE, 1, BUS_ACT),
    (WRITE_REGISTER_PROTECTION, 1, BUS),
    (ESC_WRITE_ENABLE, 1, BUS_ACT),
    (ESC_WRITE_PROTECTION, 1, BUS),
    (RESET, 1, BUS_ACT),
    (RESET_PDI, 1, SLAVE | Rights::TRIGGER),
    (DL_CONTROL, 4, BUS),
    (PHYSICAL_OFFSET, 2, BUS),
    (DL_STATUS, 2, R),
    (AL_CONTROL, 2, BUS_IF),
    (AL_STATUS, 2, SLAVE),
    (AL_STATUS_CODE, 2, SLAVE),
    (RUN_LED, 2, BUS | SLAVE),
    (PDI_CONTROL, 2, R),
    (PDI_CONFIGURATION, 2, R),
    (EXTENDED_PDI_CONFIGURATION, 2, R),
    (ECAT_EVENT_MASK, 2, BUS),
    (AL_EVENT_MASK, 4, SLAVE),
    (ECAT_EVENT_REQUEST, 2, R),
    (AL_EVENT_REQUEST, 4, R),
    (RX_ERROR_COUNTERS, 8, BUS_ACT),
    (FORWARDED_ERROR_COUNTERS, 4, BUS_ACT),
    (PROCESSING_ERROR_COUNTER, 2, BUS_ACT),
    (PDI_ERROR_CODE, 1, R),
    (LOST_LINK_COUNTERS, 4, BUS_ACT),
    (WATCHDOG_DIVIDER, 2, BUS),
    (PDI_WATCHDOG_TIME, 2, BUS),
    (PROCESS_WATCHDOG_TIME, 2, BUS),
    (PROCESS_WATCHDOG_STATUS, 2, R),
    (PROCESS_WATCHDOG_COUNTER, 2, BUS_ACT),
    (EEPROM_CONFIGURATION, 1, BUS),
    (EEPROM_PDI_ACCESS, 1, SLAVE),
    (EEPROM_CONTROL, 2, OWNER | Rights::TRIGGER),
    (EEPROM_ADDRESS, 12, OWNER),
    (DC_RECEIVE_TIMES, 1, BUS_ACT),
    (DC_RECEIVE_TIMES + 1, 15, R),
    (DC_SYSTEM_TIME, 8, BUS_ACT),
    (DC_PROCESSING_TIME, 8, R),
    (DC_SYSTEM_TIME_OFFSET, 8, BUS),
    (DC_SYSTEM_TIME_DELAY, 4, BUS),
    (DC_SYSTEM_TIME_DIFFERENCE, 4, R),
    (DC_SPEED_START, 2, BUS),
    (DC_SPEED_DIFFERENCE, 2, R),
    (DC_FILTER_DEPTH, 2, BUS),
    (DC_CYCLIC_CONTROL, 1, BUS),
    (DC_ACTIVATION, 1, OWNER),
    (DC_PULSE_LENGTH, 3, R),
    (DC_SYNC0_STATUS, 2, R),
    (DC_START_TIME, 8, OWNER),
    (DC_NEXT_SYNC1, 8, R),
    (DC_SYNC0_CYCLE, 8, OWNER),
    (DC_LATCH_CONTROL, 2, OWNER),
    (DC_LATCH_STATUS, 2, R),
    (DC_LATCH_TIMES, 32, R),
];

/// The rights of every register byte: [`RANGES`], and the FMMUs and sync managers, which repeat.
static RIGHTS: [u8; REGISTER_BYTES] = {
    let mut table = [0; REGISTER_BYTES];
    let mut row = 0;
    while row < RANGES.len() {
        let (first, count, rights) = RANGES[row];
        fill(&mut table, first, count, rights);
        row += 1;
    }
    let mut index = 0;
    while index < FMMUS as u16 {
        fill(&mut table, FMMU + index * FMMU_SIZE, 13, BUS);
        index += 1;
    }
    let mut index = 0;
    while index < SYNC_MANAGERS as u16 {
        let base = SM + index * SM_SIZE;
        fill(&mut table, base, 5, BUS_IF);
        fill(&mut table, base + sync_manager::STATUS, 1, R);
        fill(&mut table, base + sync_manager::ACTIVATE, 1, BUS);
        fill(&mut table, base + sync_manager::PDI_CONTROL, 1, SLAVE);
        index += 1;
    }
    table
};

const fn fill(table: &mut [u8; REGISTER_BYTES], first: u16, count: u16, rights: u8) {
    let mut at = first;
    while at < first + count {
        table[at as usize] = rights;
        at += 1;
    }
}

/// The bytes of the register file.
#[derive(Clone)]
pub(crate) struct Registers(pub(crate) [u8; REGISTER_BYTES]);

impl Registers {
    /// All registers zero.
    pub(crate) const fn new() -> Self {
        Self([0; REGISTER_BYTES])
    }

    pub(crate) const fn u8(&self, address: u16) -> u8 {
        self.0[address as usize]
    }

    pub(crate) fn bytes<const N: usize>(&self, address: u16) -> [u8; N] {
        core::array::from_fn(|i| self.0[usize::from(address) + i])
    }

    pub(crate) fn u16(&self, address: u16) -> u16 {
        u16::from_le_bytes(self.bytes(address))
    }

    pub(crate) fn u32(&self, address: u16) -> u32 {
        u32::from_le_bytes(self.bytes(address))
    }

    pub(crate) fn u64(&self, address: u16) -> u64 {
        u64::from_le_bytes(self.bytes(address))
    }

    pub(crate) fn set(&mut self, address: u16, bytes: &[u8]) {
        let start = usize::from(address);
        self.0[start..start + bytes.len()].copy_from_slice(bytes);
    }

    /// Counts an 8-bit counter up to its end.
    pub(crate) fn count(&mut self, address: u16) {
        let counter = &mut self.0[usize::from(address)];
        *counter = counter.saturating_add(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_the_table_do_not_overlap() {
        let mut rows = RANGES;
        rows.sort();
        for pair in rows.windows(2) {
            assert!(
                pair[0].0 + pair[0].1 <= pair[1].0,
                "{:#06x} runs into {:#06x}",
                pair[0].0,
                pair[1].0
            );
        }
    }

    #[test]
    fn reserved_bytes_have_no_rights() {
        for address in [
            0x000A,
            0x0022,
            0x0032,
            0x0042,
            0x0132,
            0x0440 + 2 + 2,
            0x060D,
            0x0680,
            0x0840,
            0x0936,
            0x0985,
            0x09AA,
            0x09D0,
            0x0F00,
            0xFFFF,
        ] {
            assert_eq!(Rights::at(address), Rights(0), "{address:#06x}");
        }
    }
}
