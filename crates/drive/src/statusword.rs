//! The statusword 0x6041 (manual 2.3.3).

use board::Millivolts;

use crate::power_state::PowerState;

/// Bit 4, voltage enabled.
pub const VOLTAGE_ENABLED: u16 = 1 << 4;
/// Bit 9, remote: the controlword of the network is obeyed.
pub const REMOTE: u16 = 1 << 9;
/// Bit 10, target reached; its meaning depends on the mode.
pub const TARGET_REACHED: u16 = 1 << 10;
/// Bit 11, internal limit active: a limit switch is valid.
pub const INTERNAL_LIMIT: u16 = 1 << 11;
/// Bit 12: set-point acknowledge (PP), speed is zero (PV), homing attained, drive follows the command (CSP).
pub const MODE_BIT_12: u16 = 1 << 12;
/// Bit 13: homing error.
pub const MODE_BIT_13: u16 = 1 << 13;

/// The range of the supply voltage (manual 1.1.2).
const SUPPLY: core::ops::RangeInclusive<Millivolts> = Millivolts(18_000)..=Millivolts(50_000);

/// Puts the statusword together; `mode_bits` are the mode's bits 10, 12 and 13.
pub fn compose(state: PowerState, bus_voltage: Millivolts, operational: bool, at_limit: bool, mode_bits: u16) -> u16 {
    state.statusword_bits()
        | mode_bits
        | flag(SUPPLY.contains(&bus_voltage), VOLTAGE_ENABLED)
        | flag(operational, REMOTE)
        | flag(at_limit, INTERNAL_LIMIT)
}

/// `bit` if `condition` holds.
pub const fn flag(condition: bool, bit: u16) -> u16 {
    if condition { bit } else { 0 }
}
