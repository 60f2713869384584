//! The PI regulators of the current's two parts in the commanded frame.

use super::gains::Gains;
use super::vector::Vector;

/// Bound of the integrators in volt. Nothing with sense comes near; without back-calculation (0x200B:04 = 0) they would grow for ever.
const MOST: f32 = 1_000.0;

/// Two PI regulators with the integrators in volt.
#[derive(Clone, Debug, Default)]
pub struct Regulator {
    integral: Vector,
}

impl Regulator {
    /// The voltage for an error, both in the frame, before the limit.
    pub fn voltage(&self, error: Vector, gains: &Gains) -> Vector {
        error.times(gains.proportional).plus(self.integral)
    }

    /// Begins with the voltage that holds the present current.
    pub fn resume(&mut self, voltage: Vector) {
        self.integral = voltage;
    }

    /// Integrates the error, and takes off the `excess`: the voltage beyond what the limit left of it.
    pub fn integrate(&mut self, error: Vector, excess: Vector, gains: &Gains) {
        let integral = self.integral.plus(error.times(gains.integral)).minus(excess.times(gains.tracking));
        self.integral = Vector {
            a: integral.a.clamp(-MOST, MOST),
            b: integral.b.clamp(-MOST, MOST),
        };
    }
}
