//! Addresses and bits of an ET1100-class slave controller's registers (ETG.1000.4; ESC data sheet, section II).

/// Chip type (u8), first of the read-only information block.
pub const TYPE: u16 = 0x0000;
/// Revision (u8).
pub const REVISION: u16 = 0x0001;
/// Build (u16).
pub const BUILD: u16 = 0x0002;
/// Number of FMMUs (u8).
pub const FMMU_COUNT: u16 = 0x0004;
/// Number of sync managers (u8).
pub const SM_COUNT: u16 = 0x0005;
/// Process memory in kB (u8).
pub const RAM_SIZE: u16 = 0x0006;
/// Two bits a port (u8).
pub const PORT_DESCRIPTOR: u16 = 0x0007;
/// Features (u16).
pub const FEATURES: u16 = 0x0008;
/// Configured station address (u16).
pub const STATION_ADDRESS: u16 = 0x0010;
/// Configured station alias (u16).
pub const STATION_ALIAS: u16 = 0x0012;
/// Write register enable (u8): bit 0 lifts the protection of the registers for the rest of the frame.
pub const WRITE_REGISTER_ENABLE: u16 = 0x0020;
/// Write register protection (u8): bit 0 protects the registers against the bus.
pub const WRITE_REGISTER_PROTECTION: u16 = 0x0021;
/// ESC write enable (u8): bit 0 lifts the protection of the whole chip for the rest of the frame.
pub const ESC_WRITE_ENABLE: u16 = 0x0030;
/// ESC write protection (u8): bit 0 protects registers and memory against the bus.
pub const ESC_WRITE_PROTECTION: u16 = 0x0031;
/// ESC reset by the bus (u8): takes the letters of "RES", shows how far the sequence has come.
pub const RESET: u16 = 0x0040;
/// ESC reset by the slave (u8).
pub const RESET_PDI: u16 = 0x0041;
/// DL control (u32): forwarding rule, loop control (second byte), FIFO, alias.
pub const DL_CONTROL: u16 = 0x0100;
/// Physical read/write offset (u16): how far behind its reading an APRW or FPRW writes.
pub const PHYSICAL_OFFSET: u16 = 0x0108;
/// DL status (u16).
pub const DL_STATUS: u16 = 0x0110;
/// AL control (u16).
pub const AL_CONTROL: u16 = 0x0120;
/// AL status (u16).
pub const AL_STATUS: u16 = 0x0130;
/// AL status code (u16).
pub const AL_STATUS_CODE: u16 = 0x0134;
/// RUN LED override (u8).
pub const RUN_LED: u16 = 0x0138;
/// ERR LED override (u8).
pub const ERR_LED: u16 = 0x0139;
/// PDI control (u8), from SII word 0.
pub const PDI_CONTROL: u16 = 0x0140;
/// ESC configuration (u8), from SII word 0.
pub const ESC_CONFIGURATION: u16 = 0x0141;
/// PDI configuration (u16), from SII word 1.
pub const PDI_CONFIGURATION: u16 = 0x0150;
/// SYNC and latch configuration (u8), the upper half of SII word 1: bits 3 and 7 report SYNC0 and SYNC1 as AL events.
pub const SYNC_LATCH_CONFIGURATION: u16 = 0x0151;
/// Extended PDI configuration (u16), from SII word 3.
pub const EXTENDED_PDI_CONFIGURATION: u16 = 0x0152;
/// ECAT event mask (u16).
pub const ECAT_EVENT_MASK: u16 = 0x0200;
/// AL event mask (u32).
pub const AL_EVENT_MASK: u16 = 0x0204;
/// ECAT event request (u16).
pub const ECAT_EVENT_REQUEST: u16 = 0x0210;
/// AL event request (u32).
pub const AL_EVENT_REQUEST: u16 = 0x0220;
/// Receive error counters, two bytes a port.
pub const RX_ERROR_COUNTERS: u16 = 0x0300;
/// Forwarded receive error counters (4 x u8).
pub const FORWARDED_ERROR_COUNTERS: u16 = 0x0308;
/// Processing unit error counter (u8): frames of broken structure.
pub const PROCESSING_ERROR_COUNTER: u16 = 0x030C;
/// PDI error counter (u8).
pub const PDI_ERROR_COUNTER: u16 = 0x030D;
/// PDI error code (u8).
pub const PDI_ERROR_CODE: u16 = 0x030E;
/// Lost link counters (4 x u8).
pub const LOST_LINK_COUNTERS: u16 = 0x0310;
/// Watchdog divider (u16): a watchdog tick is (divider + 2) x 40 ns.
pub const WATCHDOG_DIVIDER: u16 = 0x0400;
/// PDI watchdog time in watchdog ticks (u16).
pub const PDI_WATCHDOG_TIME: u16 = 0x0410;
/// Process data watchdog time in watchdog ticks (u16).
pub const PROCESS_WATCHDOG_TIME: u16 = 0x0420;
/// Process data watchdog status (u16): bit 0 is 0 when expired.
pub const PROCESS_WATCHDOG_STATUS: u16 = 0x0440;
/// Process data watchdog expiry counter (u8).
pub const PROCESS_WATCHDOG_COUNTER: u16 = 0x0442;
/// PDI watchdog expiry counter (u8).
pub const PDI_WATCHDOG_COUNTER: u16 = 0x0443;
/// EEPROM configuration (u8): who owns the interface.
pub const EEPROM_CONFIGURATION: u16 = 0x0500;
/// EEPROM PDI access state (u8).
pub const EEPROM_PDI_ACCESS: u16 = 0x0501;
/// EEPROM control and status (u16).
pub const EEPROM_CONTROL: u16 = 0x0502;
/// EEPROM word address (u32).
pub const EEPROM_ADDRESS: u16 = 0x0504;
/// EEPROM data (8 bytes).
pub const EEPROM_DATA: u16 = 0x0508;
/// First FMMU; [`FMMU_SIZE`] bytes each.
pub const FMMU: u16 = 0x0600;
/// Bytes of one FMMU's registers.
pub const FMMU_SIZE: u16 = 16;
/// First sync manager; [`SM_SIZE`] bytes each.
pub const SM: u16 = 0x0800;
/// Bytes of one sync manager's registers.
pub const SM_SIZE: u16 = 8;
/// Receive times of ports 0 to 3 (4 x u32); writing latches them.
pub const DC_RECEIVE_TIMES: u16 = 0x0900;
/// System time (u64); writing feeds the control loop.
pub const DC_SYSTEM_TIME: u16 = 0x0910;
/// Receive time of the processing unit (u64).
pub const DC_PROCESSING_TIME: u16 = 0x0918;
/// System time offset (u64).
pub const DC_SYSTEM_TIME_OFFSET: u16 = 0x0920;
/// System time delay (u32).
pub const DC_SYSTEM_TIME_DELAY: u16 = 0x0928;
/// System time difference (u32), sign and magnitude.
pub const DC_SYSTEM_TIME_DIFFERENCE: u16 = 0x092C;
/// Speed counter start (u16); writing resets the control loop.
pub const DC_SPEED_START: u16 = 0x0930;
/// Speed counter difference (u16).
pub const DC_SPEED_DIFFERENCE: u16 = 0x0932;
/// System time difference filter depth (u8).
pub const DC_FILTER_DEPTH: u16 = 0x0934;
/// Speed counter filter depth (u8).
pub const DC_SPEED_FILTER_DEPTH: u16 = 0x0935;
/// Cyclic unit control (u8).
pub const DC_CYCLIC_CONTROL: u16 = 0x0980;
/// Activation (u8), see [`dc_activation`].
pub const DC_ACTIVATION: u16 = 0x0981;
/// Pulse length of SYNC signals in 10 ns (u16).
pub const DC_PULSE_LENGTH: u16 = 0x0982;
/// Activation status (u8).
pub const DC_ACTIVATION_STATUS: u16 = 0x0984;
/// SYNC0 status (u8).
pub const DC_SYNC0_STATUS: u16 = 0x098E;
/// SYNC1 status (u8).
pub const DC_SYNC1_STATUS: u16 = 0x098F;
/// Start time of cyclic operation, and time of the next SYNC0 (u64).
pub const DC_START_TIME: u16 = 0x0990;
/// Time of the next SYNC1 (u64).
pub const DC_NEXT_SYNC1: u16 = 0x0998;
/// SYNC0 cycle time in ns (u32).
pub const DC_SYNC0_CYCLE: u16 = 0x09A0;
/// SYNC1 cycle time in ns (u32).
pub const DC_SYNC1_CYCLE: u16 = 0x09A4;
/// Latch control (u8 a unit), see [`dc_latch`].
pub const DC_LATCH_CONTROL: u16 = 0x09A8;
/// Latch status (u8 a unit), see [`dc_latch`].
pub const DC_LATCH_STATUS: u16 = 0x09AE;
/// Latch times (u64 each): positive and negative edge of unit 0, then of unit 1.
pub const DC_LATCH_TIMES: u16 = 0x09B0;
/// Free memory for the application, before the process memory.
pub const USER_RAM: u16 = 0x0F80;
/// First byte of the process memory.
pub const PROCESS_RAM: u16 = 0x1000;

/// Bits of [`DC_ACTIVATION`].
pub mod dc_activation {
    /// Cyclic operation is on.
    pub const CYCLIC: u8 = 1 << 0;
    /// SYNC0 is generated.
    pub const SYNC0: u8 = 1 << 1;
    /// SYNC1 is generated.
    pub const SYNC1: u8 = 1 << 2;
    /// Writing the start time activates cyclic operation.
    pub const AUTO: u8 = 1 << 3;
    /// A start time written with 32 bits is extended to 64.
    pub const EXTEND_START: u8 = 1 << 4;
    /// A start time that is not in the near future starts cyclic operation at once.
    pub const PLAUSIBILITY: u8 = 1 << 5;
    /// The near future is 2^31 ns instead of half the width of the clock.
    pub const NEAR_FUTURE: u8 = 1 << 6;
    /// One pulse at once, whatever the cycle; reads as 0.
    pub const DEBUG_PULSE: u8 = 1 << 7;
}

/// Bits of [`DC_LATCH_CONTROL`] and [`DC_LATCH_STATUS`].
pub mod dc_latch {
    /// Control: of the positive edges, only the first is latched until its time has been read. Status: it has been latched.
    pub const POSITIVE: u8 = 1 << 0;
    /// Control: of the negative edges, only the first is latched until its time has been read. Status: it has been latched.
    pub const NEGATIVE: u8 = 1 << 1;
    /// Status: the level of the input.
    pub const LEVEL: u8 = 1 << 2;
}

/// Offsets and bits within a sync manager's eight bytes.
pub mod sync_manager {
    /// Start address (u16).
    pub const START: u16 = 0;
    /// Length (u16).
    pub const LENGTH: u16 = 2;
    /// Control (u8).
    pub const CONTROL: u16 = 4;
    /// Status (u8).
    pub const STATUS: u16 = 5;
    /// Activate (u8).
    pub const ACTIVATE: u16 = 6;
    /// PDI control (u8).
    pub const PDI_CONTROL: u16 = 7;

    /// Bits 1:0 of control: the mode.
    pub const CONTROL_MODE: u8 = 0b11;
    /// Mode of three buffers.
    pub const MODE_BUFFERED: u8 = 0b00;
    /// Mode of one buffer with handshake.
    pub const MODE_MAILBOX: u8 = 0b10;
    /// Bits 3:2 of control: the direction.
    pub const CONTROL_DIRECTION: u8 = 0b1100;
    /// The master writes, the slave reads.
    pub const DIRECTION_WRITE: u8 = 0b0100;
    /// The slave writes, the master reads.
    pub const DIRECTION_READ: u8 = 0b0000;
    /// Bit 4 of control: the slave's accesses show in the ECAT event request.
    pub const CONTROL_ECAT_EVENT: u8 = 1 << 4;
    /// Bit 5 of control: the master's accesses show in the AL event request.
    pub const CONTROL_AL_EVENT: u8 = 1 << 5;
    /// Bit 6 of control: a completed write triggers the process data watchdog.
    pub const CONTROL_WATCHDOG: u8 = 1 << 6;
    /// Bit 0 of status: the buffer was written, and nothing of it read since.
    pub const STATUS_WRITTEN: u8 = 1 << 0;
    /// Bit 1 of status: the buffer was read, and nothing written to it since.
    pub const STATUS_READ: u8 = 1 << 1;
    /// Bit 3 of status: the mailbox is full.
    pub const STATUS_FULL: u8 = 1 << 3;
    /// Bit 0 of activate: enabled by the master.
    pub const ACTIVATE_ENABLE: u8 = 1 << 0;
    /// Bit 1 of activate: repeat request, a toggle.
    pub const ACTIVATE_REPEAT: u8 = 1 << 1;
    /// Bit 0 of PDI control: deactivated by the slave.
    pub const PDI_DEACTIVATE: u8 = 1 << 0;
    /// Bit 1 of PDI control: acknowledge of the repeat request.
    pub const PDI_REPEAT_ACK: u8 = 1 << 1;
}
