//! The windings as the bridge sees them, whole or broken.
//!
//! All windings together act on the current vector by symmetric matrices: resistance, inductance, and what the magnets induce. With whole windings
//! each is a plain number, at a fraction of the cost; a shorted one makes the two directions differ. A winding that cannot carry current
//! confines the vector to the direction across it: what is left of the inverse inductance is the part along that direction.

use board::TICK;

use crate::faults::{Faults, TURNS_LEFT};
use crate::machine::PERIODS;
use crate::motor::{MotorParameters, Phases};

const STEP: f64 = TICK.0 as f64 * 1e-9;
const SQRT_3_4: f64 = 0.866_025_403_784_438_6;

/// The most windings a motor has.
pub(crate) const MOST: usize = 3;

/// A vector in the plane of the windings.
pub(crate) type Vector = [f64; 2];

pub(crate) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// What a vector can be multiplied by: a number, or a matrix.
pub(crate) trait Linear: Copy {
    fn times(self, vector: Vector) -> Vector;
}

impl Linear for f64 {
    #[inline]
    fn times(self, vector: Vector) -> Vector {
        vector.map(|part| self * part)
    }
}

impl Linear for Symmetric {
    #[inline]
    fn times(self, [a, b]: Vector) -> Vector {
        [self.aa * a + self.ab * b, self.ab * a + self.bb * b]
    }
}

/// A symmetric matrix of two rows.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Symmetric {
    aa: f64,
    ab: f64,
    bb: f64,
}

impl Symmetric {
    /// The product of a vector with itself, times `factor`.
    fn square([a, b]: Vector, factor: f64) -> Self {
        Self {
            aa: factor * a * a,
            ab: factor * a * b,
            bb: factor * b * b,
        }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            aa: self.aa + other.aa,
            ab: self.ab + other.ab,
            bb: self.bb + other.bb,
        }
    }

    fn inverse(self) -> Self {
        let determinant = self.aa * self.bb - self.ab * self.ab;
        Self {
            aa: self.bb / determinant,
            ab: -self.ab / determinant,
            bb: self.aa / determinant,
        }
    }
}

/// What the windings make of a current vector or a flux, while some of them carry no current.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Coils<M> {
    pub(crate) resistance: M,
    pub(crate) inductance: M,
    /// From flux to current.
    pub(crate) inverse: M,
    /// Flux of the magnets through a winding that they face, in V s.
    pub(crate) magnet: M,
    /// Torque of a current at right angles to the magnets, in Nm/A.
    pub(crate) torque: M,
}

/// A set of windings, one bit for each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Set(pub(crate) u8);

impl Set {
    pub(crate) const NONE: Self = Self(0);

    fn has(self, winding: usize) -> bool {
        self.0 >> winding & 1 == 1
    }

    pub(crate) fn insert(&mut self, winding: usize) {
        self.0 |= 1 << winding;
    }
}

/// All windings of a motor.
#[derive(Clone, Debug)]
pub(crate) struct Windings {
    pub(crate) phases: Phases,
    /// The directions of the windings; without a third it is nought.
    axes: [Vector; MOST],
    /// Volts of the bus for each ampere of mean ripple in a winding.
    pub(crate) ripple: [f64; MOST],
    /// All of them carrying current.
    coils: Coils<Symmetric>,
    /// The same in all directions, and while none of them carries current; `None` with a shorted winding.
    alike: Option<[Coils<f64>; 2]>,
    /// The inverse of the inductance, for each set of windings without current.
    inverse: [Symmetric; 1 << MOST],
    /// Windings whose wire is broken.
    pub(crate) open: Set,
}

impl Windings {
    /// Windings of a motor, with the resistance that each has in series.
    pub(crate) fn new(motor: &MotorParameters, in_series: f64, faults: &Faults) -> Self {
        let (axes, count, weight) = match motor.phases {
            Phases::Two => ([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]], 2, 1.0),
            Phases::Three => ([[1.0, 0.0], [-0.5, SQRT_3_4], [-0.5, -SQRT_3_4]], 3, 2.0 / 3.0),
        };
        // The windings that a break or a short concerns.
        let (open, shorted): ([u8; 2], [u8; 2]) = match motor.phases {
            Phases::Two => ([0b01, 0b10], [0b01, 0b10]),
            Phases::Three => ([0b001, 0b100], [0b011, 0b110]),
        };
        let mut windings = Self {
            phases: motor.phases,
            axes,
            ripple: [0.0; MOST],
            coils: Coils::default(),
            alike: (faults.shorted == [false; 2]).then(|| {
                let coils = coil(motor, in_series, 1.0);
                [coils, Coils { inverse: 0.0, ..coils }]
            }),
            inverse: [Symmetric::default(); 1 << MOST],
            open: Set::NONE,
        };
        for (winding, &axis) in axes.iter().enumerate().take(count) {
            let is = |broken: [bool; 2], sets: [u8; 2]| (0..2).any(|fault| broken[fault] && Set(sets[fault]).has(winding));
            let coil = coil(motor, in_series, if is(faults.shorted, shorted) { TURNS_LEFT } else { 1.0 });
            let along = |value: f64| Symmetric::square(axis, weight * value);
            let coils = &mut windings.coils;
            coils.resistance = coils.resistance.plus(along(coil.resistance));
            coils.inductance = coils.inductance.plus(along(coil.inductance));
            coils.magnet = coils.magnet.plus(along(coil.magnet));
            coils.torque = coils.torque.plus(along(coil.torque));
            windings.ripple[winding] = coil.inductance * (16.0 / STEP);
            if is(faults.open, open) {
                windings.open.insert(winding);
            }
        }
        windings.inverse = core::array::from_fn(|set| windings.confined(Set(set as u8)));
        windings
    }

    /// What the windings do while some of them carry no current, if that is the same in all directions.
    #[inline]
    pub(crate) fn alike(&self, idle: Set) -> Option<&Coils<f64>> {
        let [flowing, still] = self.alike.as_ref()?;
        match idle {
            Set::NONE => Some(flowing),
            _ => (usize::from(idle.0) + 1 == 1 << self.count()).then_some(still),
        }
    }

    /// What the windings do while some of them carry no current.
    pub(crate) fn coils(&self, idle: Set) -> Coils<Symmetric> {
        Coils {
            inverse: self.inverse[usize::from(idle.0) % (1 << MOST)],
            ..self.coils
        }
    }

    /// Number of windings.
    pub(crate) fn count(&self) -> usize {
        match self.phases {
            Phases::Two => 2,
            Phases::Three => 3,
        }
    }

    fn confined(&self, without: Set) -> Symmetric {
        match without.0.count_ones() {
            0 => self.coils.inductance.inverse(),
            1 => {
                let across = self.across(without);
                Symmetric::square(across, 1.0 / dot(across, self.coils.inductance.times(across)))
            }
            _ => Symmetric::default(),
        }
    }

    /// The direction across the one winding of the set.
    fn across(&self, set: Set) -> Vector {
        let [a, b] = self.axes[set.0.trailing_zeros() as usize % MOST];
        [-b, a]
    }

    /// What is left of a current vector when a set of windings carries no current any more.
    pub(crate) fn without(&self, currents: Vector, set: Set) -> Vector {
        match set.0.count_ones() {
            0 => currents,
            1 => {
                let across = self.across(set);
                across.map(|part| part * dot(across, currents))
            }
            _ => [0.0; 2],
        }
    }

    /// The current of each winding.
    #[inline]
    pub(crate) fn currents(&self, [a, b]: Vector) -> [f64; MOST] {
        match self.phases {
            Phases::Two => [a, b, 0.0],
            Phases::Three => [a, -0.5 * a + SQRT_3_4 * b, -0.5 * a - SQRT_3_4 * b],
        }
    }

    /// The vector of voltages over the windings, each between its leg's terminal and the star, or between its two legs.
    #[inline]
    pub(crate) fn vector(&self, [u, v, w]: [f64; MOST]) -> Vector {
        match self.phases {
            Phases::Two => [u, v],
            Phases::Three => [(2.0 * u - v - w) * (1.0 / 3.0), (v - w) * (0.5 / SQRT_3_4)],
        }
    }
}

/// A single winding with a share of its turns left, and with what it has in series.
fn coil(motor: &MotorParameters, in_series: f64, turns: f64) -> Coils<f64> {
    let resistance = turns * motor.resistance + in_series;
    // A time constant below a tick could not be integrated.
    let inductance = (turns * turns * motor.inductance).max(resistance * STEP);
    Coils {
        resistance,
        inductance,
        inverse: 1.0 / inductance,
        magnet: turns * motor.back_emf / PERIODS,
        torque: turns * motor.torque_constant(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motors;

    #[test]
    fn numbers_and_matrices_do_the_same_with_whole_windings() {
        for motor in motors::ALL {
            let windings = Windings::new(&motor.parameters, 0.06, &Faults::default());
            let all = Set((1 << windings.count()) - 1);
            for idle in [Set::NONE, all] {
                let (numbers, matrices) = (windings.alike(idle).expect("whole windings"), windings.coils(idle));
                for vector in [[1.0, 0.0], [0.0, 1.0], [0.6, -0.8]] {
                    let same = |number: f64, matrix: Symmetric| {
                        let (one, other) = (number.times(vector), matrix.times(vector));
                        (0..2).all(|at| (one[at] - other[at]).abs() <= 1e-12 * number.abs())
                    };
                    assert!(same(numbers.resistance, matrices.resistance), "{}", motor.name);
                    assert!(same(numbers.inductance, matrices.inductance), "{}", motor.name);
                    assert!(same(numbers.inverse, matrices.inverse), "{}", motor.name);
                    assert!(same(numbers.magnet, matrices.magnet), "{}", motor.name);
                    assert!(same(numbers.torque, matrices.torque), "{}", motor.name);
                }
            }
        }
    }

    #[test]
    fn a_shorted_winding_takes_matrices() {
        let faults = Faults {
            shorted: [true, false],
            ..Faults::default()
        };
        let windings = Windings::new(&motors::QSH5718_56, 0.06, &faults);
        assert!(windings.alike(Set::NONE).is_none());
    }
}
