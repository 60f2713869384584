//! Faults: what is detected, and which codes tell it (manual 1.6, 2.2.14, 2.3.1).

use board::Millivolts;

/// Above this bus voltage the power stage is in danger: the manual's limit of 50 V (manual 1.1.2) with room for a braking motor's
/// feedback, and below the 63 V that capacitors and transistors of this class bear.
pub const OVERVOLTAGE: Millivolts = Millivolts(60_000);

/// Consecutive ticks above [`OVERVOLTAGE`] that make a fault, so that a single disturbed sample does not.
const OVERVOLTAGE_TICKS: u8 = 2;

/// Below this bus voltage an enabled drive gives up: the manual's limit of 18 V (manual 1.1.2) with as much room as above.
pub const UNDERVOLTAGE: Millivolts = Millivolts(15_000);

/// Consecutive ticks below [`UNDERVOLTAGE`] that make a fault: 2 ms, as a supply may sag under the load of a start.
const UNDERVOLTAGE_TICKS: u8 = 40;

/// From this bus voltage on, a supply that was too low is back.
const SUPPLY_BACK: Millivolts = Millivolts(18_000);

/// Above this bus voltage no stop goes on, as every stop pumps the bus up further: what capacitors of this class bear.
const UNBEARABLE: Millivolts = Millivolts(63_000);

/// A fault the drive detects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The network left OP while the motor was enabled.
    Communication,
    /// A current is beyond what the power stage bears, or a winding is shorted.
    Overcurrent,
    /// The sensor of phase A, or what amplifies it, reads a current where there is none.
    CircuitA,
    /// As [`Fault::CircuitA`], of phase B.
    CircuitB,
    /// A winding, or its cable, carries no current.
    PhaseLoss,
    /// The bus voltage is too high.
    Overvoltage,
    /// The bus voltage is too low for a motor that is enabled.
    Undervoltage,
    /// The saved parameters were lost.
    ParameterStorage,
}

impl Fault {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Communication,
        Self::Overcurrent,
        Self::CircuitA,
        Self::CircuitB,
        Self::PhaseLoss,
        Self::Overvoltage,
        Self::Undervoltage,
        Self::ParameterStorage,
    ];

    /// The fault that a code in 0x603F tells.
    pub fn of_code(code: u16) -> Option<Self> {
        Self::ALL.into_iter().find(|fault| fault.error_code() == code)
    }

    /// What it is called.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Communication => "the network left OP while the motor was enabled",
            Self::Overcurrent => "over-current",
            Self::CircuitA => "circuit of phase A",
            Self::CircuitB => "circuit of phase B",
            Self::PhaseLoss => "phase loss",
            Self::Overvoltage => "over-voltage",
            Self::Undervoltage => "under-voltage",
            Self::ParameterStorage => "saved parameters lost",
        }
    }

    /// The code in 0x603F (manual 2.3.1).
    pub const fn error_code(self) -> u16 {
        match self {
            Self::Communication => 0x7500,
            Self::Overcurrent => 0x2211,
            Self::CircuitA => 0x3150,
            Self::CircuitB => 0x3151,
            Self::PhaseLoss => 0x7122,
            Self::Overvoltage => 0x3110,
            Self::Undervoltage => 0x3210,
            Self::ParameterStorage => 0x5530,
        }
    }

    /// The bit in 0x200E (manual 2.2.14), which has none for the network, for parameters and for a lost phase.
    pub const fn alarm_bit(self) -> u16 {
        match self {
            Self::Communication | Self::ParameterStorage | Self::PhaseLoss => 0x0000,
            Self::CircuitA | Self::CircuitB | Self::Undervoltage => 0x0001,
            Self::Overcurrent => 0x0002,
            Self::Overvoltage => 0x0004,
        }
    }

    /// How often the alarm LED flashes red (manual 1.6); 0 for the network, which has no place in the manual's table and shows in the ERR LED.
    pub const fn red_flashes(self) -> u8 {
        match self {
            Self::Communication => 0,
            Self::Overcurrent => 1,
            Self::Overvoltage => 2,
            Self::CircuitA | Self::CircuitB | Self::Undervoltage => 3,
            Self::ParameterStorage => 6,
            Self::PhaseLoss => 7,
        }
    }

    /// The error register 0x1001 while the fault is active (CiA 301).
    pub const fn error_register(self) -> u8 {
        const GENERIC: u8 = 1 << 0;
        const CURRENT: u8 = 1 << 1;
        const VOLTAGE: u8 = 1 << 2;
        const COMMUNICATION: u8 = 1 << 4;
        match self {
            Self::Communication => GENERIC | COMMUNICATION,
            Self::Overcurrent => GENERIC | CURRENT,
            Self::Overvoltage | Self::Undervoltage | Self::CircuitA | Self::CircuitB => GENERIC | VOLTAGE,
            Self::ParameterStorage | Self::PhaseLoss => GENERIC,
        }
    }

    /// Whether the current can no longer be controlled, so that the motor cannot be stopped but only be switched off.
    pub const fn is_uncontrolled(self) -> bool {
        matches!(self, Self::Overcurrent | Self::CircuitA | Self::CircuitB | Self::PhaseLoss)
    }
}

/// What [`Faults::observe`] looks at.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    /// The supply.
    pub bus_voltage: Millivolts,
    /// Whether the AL state is OP.
    pub operational: bool,
    /// Whether the motor is enabled: only then losing the network or the supply is a fault.
    pub enabled: bool,
    /// What currents tell.
    pub currents: Option<Fault>,
}

/// Detects faults and keeps the first one until it is reset.
#[derive(Clone, Debug, Default)]
pub struct Faults {
    latched: Option<Fault>,
    overvoltage_ticks: u8,
    undervoltage_ticks: u8,
    bus_voltage: Millivolts,
    operational: bool,
    currents: Option<Fault>,
    parameters_lost: bool,
}

impl Faults {
    /// The saved parameters were lost, which the next tick makes a fault. They do not get lost a second time: a reset ends it.
    pub const fn lose_parameters(&mut self) {
        self.parameters_lost = true;
    }

    /// Looks at a tick's measurements. True if a fault is new.
    pub fn observe(&mut self, measured: &Measured) -> bool {
        let bus = measured.bus_voltage;
        (self.bus_voltage, self.operational, self.currents) = (bus, measured.operational, measured.currents);
        self.overvoltage_ticks = count(self.overvoltage_ticks, bus > OVERVOLTAGE, OVERVOLTAGE_TICKS);
        self.undervoltage_ticks = count(self.undervoltage_ticks, bus < UNDERVOLTAGE && measured.enabled, UNDERVOLTAGE_TICKS);
        if self.latched.is_some() {
            return false;
        }
        if measured.currents.is_some() {
            self.latched = measured.currents;
        } else if self.is_overvoltage() {
            self.latched = Some(Fault::Overvoltage);
        } else if self.undervoltage_ticks >= UNDERVOLTAGE_TICKS {
            self.latched = Some(Fault::Undervoltage);
        } else if measured.enabled && !measured.operational {
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

    /// Whether the motor has to be switched off at once, whatever the option code says.
    pub fn forbids_stop(&self) -> bool {
        let cause = self.currents.or(self.latched);
        cause.is_some_and(Fault::is_uncontrolled) || self.latched.is_some() && self.bus_voltage > UNBEARABLE
    }

    /// Whether a reset would be in vain.
    pub fn persists(&self) -> bool {
        self.is_overvoltage()
            || self.currents.is_some()
            || match self.latched {
                Some(Fault::Communication) => !self.operational,
                Some(Fault::Undervoltage) => self.bus_voltage < SUPPLY_BACK,
                _ => false,
            }
    }

    /// Forgets the fault.
    pub const fn reset(&mut self) {
        self.latched = None;
    }

    const fn is_overvoltage(&self) -> bool {
        self.overvoltage_ticks >= OVERVOLTAGE_TICKS
    }
}

/// The ticks in a row for which `holds` was true, up to `most`.
const fn count(ticks: u8, holds: bool, most: u8) -> u8 {
    match holds {
        true if ticks < most => ticks + 1,
        true => most,
        false => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(bus_voltage: Millivolts, operational: bool, enabled: bool) -> Measured {
        Measured {
            bus_voltage,
            operational,
            enabled,
            currents: None,
        }
    }

    #[test]
    fn every_code_tells_its_fault() {
        assert!(
            Fault::ALL
                .into_iter()
                .all(|fault| Fault::of_code(fault.error_code()) == Some(fault))
        );
        assert_eq!(Fault::of_code(0), None);
    }

    #[test]
    fn one_sample_above_the_limit_is_no_fault_and_two_are() {
        let mut faults = Faults::default();
        assert!(!faults.observe(&measured(Millivolts(60_001), true, false)));
        assert!(!faults.observe(&measured(OVERVOLTAGE, true, false)));
        assert!(!faults.observe(&measured(Millivolts(60_001), true, false)));
        assert!(faults.observe(&measured(Millivolts(60_001), true, false)));
        assert_eq!(faults.latched(), Some(Fault::Overvoltage));
    }

    #[test]
    fn the_first_fault_stays_and_every_cause_has_to_be_gone() {
        let mut faults = Faults::default();
        assert!(faults.observe(&measured(Millivolts(24_000), false, true)));
        faults.observe(&measured(Millivolts(61_000), true, false));
        faults.observe(&measured(Millivolts(61_000), true, false));
        assert_eq!(faults.latched(), Some(Fault::Communication));
        assert!(faults.persists());
        faults.observe(&measured(Millivolts(24_000), false, false));
        assert!(faults.persists());
        faults.observe(&measured(Millivolts(24_000), true, false));
        assert!(!faults.persists());
    }

    #[test]
    fn lost_parameters_are_a_fault_until_it_is_reset_and_never_again() {
        let mut faults = Faults::default();
        faults.lose_parameters();
        // Another fault goes first.
        assert!(faults.observe(&measured(Millivolts(24_000), false, true)));
        assert_eq!(faults.latched(), Some(Fault::Communication));
        faults.reset();
        assert!(faults.observe(&measured(Millivolts(24_000), true, false)));
        assert_eq!(faults.latched(), Some(Fault::ParameterStorage));
        assert!(!faults.persists());
        faults.reset();
        assert!(!faults.observe(&measured(Millivolts(24_000), true, false)));
    }

    #[test]
    fn without_an_enabled_motor_the_network_may_go() {
        assert!(!Faults::default().observe(&measured(Millivolts(24_000), false, false)));
    }

    #[test]
    fn a_supply_below_15_v_for_2_ms_is_a_fault_of_an_enabled_motor_until_it_is_back_at_18_v() {
        let mut faults = Faults::default();
        for enabled in [false, true] {
            for tick in 0..39 {
                assert!(!faults.observe(&measured(Millivolts(14_999), true, enabled)), "{tick}");
            }
            assert!(!faults.observe(&measured(UNDERVOLTAGE, true, enabled)));
        }
        for _ in 0..39 {
            faults.observe(&measured(Millivolts(0), true, true));
        }
        assert!(faults.observe(&measured(Millivolts(14_999), true, true)));
        assert_eq!(faults.latched(), Some(Fault::Undervoltage));
        faults.observe(&measured(Millivolts(17_999), true, false));
        assert!(faults.persists());
        faults.observe(&measured(Millivolts(18_000), true, false));
        assert!(!faults.persists());
    }

    #[test]
    fn no_stop_goes_on_without_control_of_the_current_or_with_a_bus_beyond_63_v() {
        let mut faults = Faults::default();
        faults.observe(&measured(Millivolts(61_000), true, true));
        faults.observe(&measured(Millivolts(63_000), true, true));
        assert!(!faults.forbids_stop());
        faults.observe(&measured(Millivolts(63_001), true, true));
        assert!(faults.forbids_stop());
        faults.observe(&measured(Millivolts(61_000), true, true));
        let lost = Some(Fault::PhaseLoss);
        faults.observe(&Measured {
            currents: lost,
            ..measured(Millivolts(61_000), true, true)
        });
        assert_eq!((faults.latched(), faults.forbids_stop()), (Some(Fault::Overvoltage), true));
    }
}
