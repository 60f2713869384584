//! What can break.

use board::Millivolts;

/// What is broken at present; [`Faults::default`] is nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faults {
    /// Windings A and B whose wire is broken: no current can flow. With three phases, the wires at A+ (U) and at B+ (W).
    pub open: [bool; 2],
    /// Windings A and B nine tenths of whose turns are shorted. What is left has a tenth of the resistance and of the back-EMF and a hundredth
    /// of the inductance, so that the current gets out of hand within a tick or two. With three phases, U and V or W and V together: one
    /// alone would still have the others in its way.
    pub shorted: [bool; 2],
    /// The sensors of the currents out of A+ and B+ read 1 A more than flows, as with a broken amplifier.
    pub sensors: [bool; 2],
    /// The rotor cannot turn, as with a seized bearing.
    pub stuck_rotor: bool,
    /// What the source's voltage is off by: negative for a sag, positive for a surge.
    pub supply_offset: Millivolts,
}

/// What a broken sensor reads too much, in ampere: more than twice the offset that a good one may have.
pub(crate) const SENSOR_OFFSET: f64 = 1.0;

/// Turns of a shorted winding that are left.
pub(crate) const TURNS_LEFT: f64 = 0.1;
