//! What a plant is made of, and how its switches are wired.

use board::{INPUT_COUNT, Millivolts};

use crate::bridge::BridgeParameters;
use crate::load::Load;
use crate::motor::MotorParameters;
use crate::motors;
use crate::sensing::Sensing;
use crate::supply::SupplyParameters;
use crate::travel::{Travel, Turns};

/// What a plant is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantConfig {
    /// The axis the motor moves.
    pub travel: Travel,
    /// Where the axis stands at power-on.
    pub start: Turns,
    /// Which terminal each switch is wired to.
    pub wiring: Wiring,
    /// Further switches, as a touch probe or a flag is: where the axis switches IN1 to IN6 on, from the left edge up to, not including,
    /// the right one. They join whatever else is wired to the terminal.
    pub flags: [Option<(Turns, Turns)>; INPUT_COUNT],
    /// Voltage of the supply.
    pub supply: Millivolts,
    /// What is between that and the bridge.
    pub source: SupplyParameters,
    /// The bridge.
    pub bridge: BridgeParameters,
    /// The converter of currents and voltage.
    pub sensing: Sensing,
    /// The motor.
    pub motor: MotorParameters,
    /// What its shaft drives.
    pub load: Load,
}

impl Default for PlantConfig {
    /// A NEMA 23 motor with as much inertia again as its rotor has, at 36 V.
    fn default() -> Self {
        Self {
            travel: Travel::default(),
            start: Turns(0.0),
            wiring: Wiring::default(),
            flags: [None; INPUT_COUNT],
            supply: Millivolts(36_000),
            source: SupplyParameters::default(),
            bridge: BridgeParameters::default(),
            sensing: Sensing::default(),
            motor: motors::QSH5718_56,
            load: Load::inertia(300e-7),
        }
    }
}

/// Which input terminal, 1 to 6, each switch of the axis is wired to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wiring {
    /// Terminal of the switch at the positive end.
    pub positive_limit: usize,
    /// Terminal of the switch at the negative end.
    pub negative_limit: usize,
    /// Terminal of the home switch.
    pub home: usize,
}

impl Default for Wiring {
    /// As the drive's inputs are assigned at delivery (manual 2.2.7).
    fn default() -> Self {
        Self {
            positive_limit: 3,
            negative_limit: 4,
            home: 5,
        }
    }
}
