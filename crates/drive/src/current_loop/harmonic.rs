//! The harmonic against the first resonance, objects 0x2060 to 0x2062 (manual 2.2.26 to 2.2.28).

use super::vector::{Direction, Vector};
use crate::objects::DriveObjects;

/// Most of the current that is commanded to a winding with its harmonic, in ampere: half again the largest operating current, and a good
/// piece below what over-current protection lets through. Amplitudes of which this cuts the tops off are beyond any use.
const MOST: f32 = 9.0;

/// A third harmonic in each winding, as the objects have it.
///
/// The manual names amplitude and two phases but not the order. It is taken as the third of the current, which makes torque of the second
/// harmonic and the fourth: with equal phases the second, as a difference of the windings does; with phases half a period apart the
/// fourth, as the detent of a hybrid motor does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Harmonic {
    /// Amplitude in per mille of the current's.
    amplitude: u16,
    /// Phase in winding A, 2^-32 periods of the harmonic.
    phase_a: u32,
    /// Phase in winding B.
    phase_b: u32,
}

impl Harmonic {
    /// The harmonic of the objects; none at amplitude 0, or if the motor has three phases, for which the manual has none.
    pub fn from_objects(objects: &DriveObjects) -> Option<Self> {
        let phase = |register: u16| u32::from(register) << 22;
        (objects.harmonic_amplitude != 0 && objects.motor_type == 0).then(|| Self {
            amplitude: objects.harmonic_amplitude.min(1_000),
            phase_a: phase(objects.harmonic_phase_a),
            phase_b: phase(objects.harmonic_phase_b),
        })
    }

    /// The angles of the harmonic in windings A and B, for a current at this `angle`.
    pub const fn angles(self, angle: u32) -> [u32; 2] {
        let third = angle.wrapping_mul(3);
        [third.wrapping_add(self.phase_a), third.wrapping_add(self.phase_b)]
    }

    /// `current`, which has this `amplitude`, with the harmonic at the directions of [`Harmonic::angles`].
    pub fn added_to(self, current: Vector, amplitude: f32, [first, second]: [Direction; 2]) -> Vector {
        let height = amplitude * f32::from(self.amplitude) * 1e-3;
        let a = current.a + height * first.cosine;
        let b = current.b + height * second.sine;
        Vector {
            a: a.clamp(-MOST, MOST),
            b: b.clamp(-MOST, MOST),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn harmonic(amplitude: u16, phase_a: u16, phase_b: u16) -> Option<Harmonic> {
        let mut objects = DriveObjects::new();
        (objects.harmonic_amplitude, objects.harmonic_phase_a, objects.harmonic_phase_b) = (amplitude, phase_a, phase_b);
        Harmonic::from_objects(&objects)
    }

    /// The torque per ampere of the operating current that a rotor at `angle` less `behind` has from the harmonic alone, in units of
    /// the torque constant.
    fn torque(harmonic: Harmonic, angle: u32) -> f32 {
        let current = harmonic.added_to(Vector::default(), 1.0, Direction::of_each(harmonic.angles(angle)));
        Direction::of(angle).into_frame(current).b
    }

    // manual: 2.2.26/harmonic 2.2.27/phase 2.2.28/phase
    #[test]
    fn phases_half_a_period_apart_make_a_torque_of_the_fourth_harmonic_and_equal_ones_of_the_second() {
        let detent = harmonic(50, 512, 0).unwrap();
        let mismatch = harmonic(50, 128, 128).unwrap();
        for step in 0..64u32 {
            let angle = step << 26;
            let fourth = -0.05 * Direction::of(angle.wrapping_mul(4).wrapping_add(512 << 22)).sine;
            assert!((torque(detent, angle) - fourth).abs() < 1e-6, "fourth at {step}");
            let second = 0.05 * Direction::of(angle.wrapping_mul(2).wrapping_add(128 << 22)).sine;
            assert!((torque(mismatch, angle) - second).abs() < 1e-6, "second at {step}");
        }
    }

    #[test]
    fn amplitude_zero_and_three_phases_are_no_harmonic_and_1024_is_a_whole_turn() {
        assert_eq!(harmonic(0, 3, 4), None);
        assert_eq!(harmonic(1, 1_024, 1_024), harmonic(1, 0, 0));
        let mut objects = DriveObjects::new();
        (objects.harmonic_amplitude, objects.motor_type) = (100, 1);
        assert_eq!(Harmonic::from_objects(&objects), None);
    }

    #[test]
    fn a_harmonic_as_large_as_the_current_stays_below_the_limit_of_over_current() {
        let whole = harmonic(1_000, 0, 512).unwrap();
        for step in 0..64u32 {
            let angle = step << 26;
            let direction = Direction::of(angle);
            let current = direction.out_of_frame(Vector { a: 6.0, b: 0.0 });
            let with = whole.added_to(current, 6.0, Direction::of_each(whole.angles(angle)));
            assert!(with.a.abs() <= MOST && with.b.abs() <= MOST);
        }
    }
}
