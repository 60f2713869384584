//! Where the energy goes.

/// Energies since power-on in J. At any time,
/// [`source`](Self::source) + [`hand`](Self::hand) = [`stored`](Self::stored) + [`spent`](Self::spent), but for the error of the integration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnergyAccount {
    /// Out of the source, behind its impedance.
    pub source: f64,
    /// Brought in by whoever moved the axis by hand, broke something or mended it. What is stored at the start counts here.
    pub hand: f64,
    /// Into the drive's own consumption.
    pub consumption: f64,
    /// Heat in windings, transistors and diodes.
    pub heat: f64,
    /// Drag, with iron losses and the coupling's damping.
    pub drag: f64,
    /// Coulomb friction, and what end stops have taken.
    pub friction: f64,
    /// Into the load's external torque; negative if a weight has driven the motor.
    pub load: f64,
    /// In the windings' field, at present.
    pub magnetic: f64,
    /// In the motion of rotor and load, at present.
    pub kinetic: f64,
    /// In the detent and the coupling's twist, at present.
    pub elastic: f64,
    /// In the bus capacitor, at present.
    pub capacitor: f64,
}

impl EnergyAccount {
    /// What is stored at present.
    pub fn stored(&self) -> f64 {
        self.magnetic + self.kinetic + self.elastic + self.capacitor
    }

    /// What has gone.
    pub fn spent(&self) -> f64 {
        self.consumption + self.heat + self.drag + self.friction + self.load
    }
}
