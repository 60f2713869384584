//! Faults: what is detected, and which codes tell it (manual 1.6, 2.2.14, 2.3.1).

use board::Millivolts;

/// Above this bus voltage the power stage is in danger: the manual's limit of 50 V (manual 1.1.2) with room for a braking motor's
/// feedback, and below the 63 V that capacitors and transistors of this class bear.
pub const OVERVOLTAGE: Millivolts = Millivolts(60_000);

/// Consecutive ticks above [`OVERVOLTAGE`] that make a fault, so that a single disturbed sample does not.
const OVERVOLTAGE_TICKS: u8 = 2;

/// A fault the drive detects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The network left OP while the motor was enabled.
    Communication,
    /// The bus voltage is too high.
    Overvoltage,
    /// The saved parameters were lost.
    ParameterStorage,
}

impl Fault {
    /// The code in 0x603F (manual 2.3.1).
    pub const fn error_code(self) -> u16 {
        match self {
            Self::Communication => 0x7500,
            Self::Overvoltage => 0x3110,
            Self::ParameterStorage => 0x5530,
        }
    }

    /// The bit in 0x200E (manual 2.2.14), which has none for the network and for parameters.
    pub const fn alarm_bit(self) -> u16 {
        match self {
            Self::Communication | Self::ParameterStorage => 0x0000,
            Self::Overvoltage => 0x0004,
        }
    }

    /// How often the alarm LED flashes red (manual 1.6); 0 for the network, which has no place in the manual's table and shows in the ERR LED.
    pub const fn red_flashes(self) -> u8 {
        match self {
            Self::Communication => 0,
            Self::Overvoltage => 2,
            Self::ParameterStorage => 6,
        }
    }

    /// The error register 0x1001 while the fault is active (CiA 301).
    pub const fn error_register(self) -> u8 {
        const GENERIC: u8 = 1 << 0;
        const VOLTAGE: u8 = 1 << 2;
        const COMMUNICATION: u8 = 1 << 4;
        match self {
            Self::Communication => GENERIC | COMMUNICATION,
            Self::Overvoltage => GENERIC | VOLTAGE,
            Self::ParameterStorage => GENERIC,
        }
    }
}

/// Detects faults and keeps the first one until it is reset.
#[derive(Clone, Debug, Default)]
pub struct Faults {
    latched: Option<Fault>,
    overvoltage_ticks: u8,
    operational: bool,
    parameters_lost: bool,
}

impl Faults {
    /// The saved parameters were lost, which the next tick makes a fault. They do not get lost a second time: a reset ends it.
    pub const fn lose_parameters(&mut self) {
        self.parameters_lost = true;
    }

    /// Looks at a tick's measurements; `enabled` is whether losing the network is a fault. True if a fault is new.
    pub fn observe(&mut self, bus_voltage: Millivolts, operational: bool, enabled: bool) -> bool {
        self.operational = operational;
        self.overvoltage_ticks = match bus_voltage > OVERVOLTAGE {
            true => (self.overvoltage_ticks + 1).min(OVERVOLTAGE_TICKS),
            false => 0,
        };
        if self.latched.is_some() {
            return false;
        }
        if self.is_overvoltage() {
            self.latched = Some(Fault::Overvoltage);
        } else if enabled && !operational {
            self.latched = Some(Fault::Communication);
        } else if core::mem::take(&mut self.parameters_lost) {
            self.latched = Some(Fault::ParameterStorage);
        }
        self.latched.is_some()
    }

    /// The fault to be shown.
    pub const fn latched(&self) -> Option<Fault> {
        self.latched
    }

    /// Whether a reset would be in vain.
    pub fn persists(&self) -> bool {
        self.is_overvoltage() || self.latched == Some(Fault::Communication) && !self.operational
    }

    /// Forgets the fault.
    pub const fn reset(&mut self) {
        self.latched = None;
    }

    const fn is_overvoltage(&self) -> bool {
        self.overvoltage_ticks >= OVERVOLTAGE_TICKS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_sample_above_the_limit_is_no_fault_and_two_are() {
        let mut faults = Faults::default();
        assert!(!faults.observe(Millivolts(60_001), true, false));
        assert!(!faults.observe(OVERVOLTAGE, true, false));
        assert!(!faults.observe(Millivolts(60_001), true, false));
        assert!(faults.observe(Millivolts(60_001), true, false));
        assert_eq!(faults.latched(), Some(Fault::Overvoltage));
    }

    #[test]
    fn the_first_fault_stays_and_every_cause_has_to_be_gone() {
        let mut faults = Faults::default();
        assert!(faults.observe(Millivolts(24_000), false, true));
        faults.observe(Millivolts(61_000), true, false);
        faults.observe(Millivolts(61_000), true, false);
        assert_eq!(faults.latched(), Some(Fault::Communication));
        assert!(faults.persists());
        faults.observe(Millivolts(24_000), false, false);
        assert!(faults.persists());
        faults.observe(Millivolts(24_000), true, false);
        assert!(!faults.persists());
    }

    #[test]
    fn lost_parameters_are_a_fault_until_it_is_reset_and_never_again() {
        let mut faults = Faults::default();
        faults.lose_parameters();
        // Another fault goes first.
        assert!(faults.observe(Millivolts(24_000), false, true));
        assert_eq!(faults.latched(), Some(Fault::Communication));
        faults.reset();
        assert!(faults.observe(Millivolts(24_000), true, false));
        assert_eq!(faults.latched(), Some(Fault::ParameterStorage));
        assert!(!faults.persists());
        faults.reset();
        assert!(!faults.observe(Millivolts(24_000), true, false));
    }

    #[test]
    fn without_an_enabled_motor_the_network_may_go() {
        assert!(!Faults::default().observe(Millivolts(24_000), false, false));
    }
}
