//! What the shaft drives.

use board::TICK;

const STEP: f64 = TICK.0 as f64 * 1e-9;

/// Inertia, friction and torque behind the shaft, reduced to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Inertia in kg m^2.
    pub inertia: f64,
    /// Coulomb friction in Nm: holds against as much torque at rest, and takes as much in motion.
    pub friction: f64,
    /// Viscous drag in Nm s/rad.
    pub drag: f64,
    /// Torque that acts in the negative direction whatever the motion, as a hanging weight does, in Nm.
    pub torque: f64,
    /// What is between shaft and load; `None` for a rigid coupling.
    pub coupling: Option<Coupling>,
}

impl Load {
    /// A rigidly coupled inertia and nothing else.
    pub const fn inertia(inertia: f64) -> Self {
        Self {
            inertia,
            friction: 0.0,
            drag: 0.0,
            torque: 0.0,
            coupling: None,
        }
    }
}

/// An elastic coupling or a belt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling {
    /// Stiffness in Nm/rad: some 20 for a belt, 100 to 3000 for a bellows coupling.
    pub stiffness: f64,
    /// Damping in Nm s/rad.
    pub damping: f64,
}

impl Coupling {
    /// Whether a tick is short enough to see the load swing against the rotor, or the damping stop it. Otherwise the coupling is as good as
    /// rigid: it would swing at more than 3 kHz.
    pub(crate) fn is_elastic(&self, rotor: f64, load: f64) -> bool {
        let lightness = 1.0 / rotor + 1.0 / load;
        load > 0.0 && self.stiffness * lightness * STEP * STEP < 1.0 && self.damping * lightness * STEP < 1.0
    }
}

/// State of the load.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoadState {
    /// Speed in rad/s.
    pub speed: f64,
    /// Angle in turns.
    pub turns: f64,
}
