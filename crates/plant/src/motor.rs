//! The hybrid stepping motor: its data and its state.
//!
//! Two sine-wound phases, or three in star, on a rotor of 50 pole pairs. With the electrical angle `e` = 50 times the shaft's, resistance R,
//! inductance L, back-EMF constant K, speed w, and the currents as a vector (a, b):
//!
//! ```text
//! L da/dt = va - R a + K w sin e
//! L db/dt = vb - R b - K w cos e
//! torque  = k K (b cos e - a sin e) - D sin 4e        k = 1 with two phases, 3/2 with three
//! J dw/dt = torque - drag w - friction sgn w - load
//! ```
//!
//! A current vector at the angle c pulls the rotor to e = c, with the sine of the difference: at a quarter of a period the torque is
//! greatest, beyond half a period the rotor is pulled into the next period, and four full steps are lost. These are the equations that
//! Simscape's stepper motor block uses; iron losses, which it has as a resistor, are part of the drag here. Saturation and the dependence of L
//! on the angle are left out.

/// Number of windings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phases {
    /// Two windings, a quarter of an electrical period apart, each between two legs of the bridge.
    Two,
    /// Three windings, a third of an electrical period apart, in star.
    Three,
}

impl Phases {
    /// Torque and power of a current vector, compared with what its two components would make in two windings: Clarke's transformation keeps
    /// amplitudes, so that a vector stands for half as much again in three.
    pub(crate) fn power_factor(self) -> f64 {
        match self {
            Self::Two => 1.0,
            Self::Three => 1.5,
        }
    }
}

/// What a data sheet says of a motor, in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorParameters {
    /// Number of windings.
    pub phases: Phases,
    /// Resistance of a winding in ohm.
    pub resistance: f64,
    /// Inductance of a winding in henry.
    pub inductance: f64,
    /// Peak of the sinusoidal phase current at which the motor has its holding torque, in ampere.
    pub rated_current: f64,
    /// Back-EMF of a winding in V s/rad of the shaft, and with two windings the torque constant in Nm/A.
    pub back_emf: f64,
    /// Peak of the detent torque in Nm.
    pub detent_torque: f64,
    /// Inertia of the rotor in kg m^2.
    pub inertia: f64,
    /// Coulomb friction in Nm.
    pub friction: f64,
    /// Viscous drag, iron losses included, in Nm s/rad.
    pub drag: f64,
}

impl MotorParameters {
    /// Torque at one ampere of the current vector's amplitude, in Nm/A.
    pub fn torque_constant(&self) -> f64 {
        self.phases.power_factor() * self.back_emf
    }

    /// Static torque at a current vector's amplitude, in Nm, without the detent's part.
    pub fn holding_torque(&self, current: f64) -> f64 {
        self.torque_constant() * current
    }
}

/// Currents, speed and angle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorState {
    /// Current vector in ampere: with two phases the currents of windings A and B, with three those after Clarke's transformation.
    pub currents: [f64; 2],
    /// Speed of the shaft in rad/s.
    pub speed: f64,
    /// Angle of the shaft in turns.
    pub turns: f64,
}
