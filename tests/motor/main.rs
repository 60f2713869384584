//! The drive's current loop against the physical motor: steps of the current, pull-out, stall, reversal, resonance.

mod axis;
mod current;
mod resonance;
mod torque;

use plant::{MotorParameters, motors};

/// A motor by its name.
fn motor(name: &str) -> MotorParameters {
    let named = motors::ALL.iter().find(|motor| motor.name == name);
    named.unwrap_or_else(|| panic!("no motor {name}")).parameters
}
