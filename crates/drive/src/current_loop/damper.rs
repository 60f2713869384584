//! The damper against mid-band instability: a rotor that swings about the commanded angle, found by its power alone.

use core::f32::consts::TAU;

use board::{ELECTRICAL_PERIODS_PER_TURN, TICKS_PER_SECOND};

use super::vector::Vector;

/// Trim in radians of the electrical period for a torque that deviates by the holding torque. This is 2 zeta wn / w with the corner w of
/// [`PASS`], a natural frequency wn of 225 Hz, which motors of this class have alone, and a damping ratio zeta of 0.16. With less, at 0.45,
/// a motor fell out of step 6 % below the envelope of voltage and current; with more, at 0.6, one whose 0x200C:06 was left at a third of
/// the truth did at four fifths of it.
const GAIN: f32 = 0.48;
/// The most that the commanded angle is trimmed, in radians.
const MOST: f32 = 0.7;
/// Corner below which torque counts, 150 Hz, as the share taken of each sample: the low pass makes the deviation of speed out of it.
const PASS: f32 = 0.046_030_8;
/// Corner below which it is the load's, 1 Hz, as the share taken of each sample.
const MEAN: f32 = 314.11e-6;
/// The damper begins at 1.5 turns a second and is whole at 2, in radians of the electrical period a tick. Below, the current loop itself
/// damps, and there is too little power to tell torque from.
const BEGIN: f32 = electrical(1.5);
const WHOLE: f32 = electrical(2.0);

/// Radians of the electrical period in a tick, at that many turns a second.
const fn electrical(turns: f32) -> f32 {
    turns * (ELECTRICAL_PERIODS_PER_TURN as f32 * TAU / TICKS_PER_SECOND as f32)
}

/// What the damper looks at: the tick that has just passed.
#[derive(Clone, Copy, Debug)]
pub struct Passed {
    /// The mean voltage over the windings.
    pub voltage: Vector,
    /// The mean current.
    pub current: Vector,
    /// The power in watt that has gone into the windings' magnetic field: 0 where the current's amplitude is meant to be even.
    pub magnetising: f32,
    /// The commanded amplitude in ampere.
    pub amplitude: f32,
    /// Radians of the electrical period by which the command has turned; negative backward.
    pub advance: f32,
}

/// Damps the rotor's swinging by trimming the commanded angle.
///
/// What the windings take beyond their heat and their field is the rotor's power, and over the commanded speed its torque. The field counts
/// where the current's amplitude is not meant to be even, as with the harmonic of 0x2060, which would be taken for torque otherwise. Torque
/// through a low pass is the deviation of speed; a trim against it is damping. The mean of the torque, the load's, is left out, so that no
/// trim stays.
#[derive(Clone, Debug, Default)]
pub struct Damper {
    torque: f32,
    mean: f32,
    running: bool,
}

impl Damper {
    /// The trim in radians after a tick; 0 at rest and if `back_emf` (V s/rad) is 0.
    pub fn tick(&mut self, passed: &Passed, resistance: f32, back_emf: f32) -> f32 {
        let speed = passed.advance.abs();
        if speed <= BEGIN || back_emf <= 0.0 || passed.amplitude <= 0.0 {
            *self = Self::default();
            return 0.0;
        }
        let heat = resistance * passed.current.dot(passed.current);
        let power = passed.voltage.dot(passed.current) - heat - passed.magnetising;
        // Radians of the shaft in a second.
        let turning = passed.advance * (TICKS_PER_SECOND as f32 / ELECTRICAL_PERIODS_PER_TURN as f32);
        let torque = power / (turning * back_emf * passed.amplitude);
        if !self.running {
            (self.running, self.torque, self.mean) = (true, torque, torque);
        }
        self.torque += PASS * (torque - self.torque);
        self.mean += MEAN * (self.torque - self.mean);
        let share = ((speed - BEGIN) * (1.0 / (WHOLE - BEGIN))).min(1.0);
        (-GAIN * (self.torque - self.mean)).clamp(-MOST, MOST) * share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs a motor whose torque alternates between half and a tenth of the holding torque, and gives the trims.
    fn trims(turns: f32, back_emf: f32) -> [f32; 4] {
        let mut damper = Damper::default();
        let advance = electrical(turns.abs()) * turns.signum();
        let speed = TAU * turns;
        core::array::from_fn(|half| {
            let torque = if half % 2 == 0 { 0.5 } else { 0.1 };
            let passed = Passed {
                // Back-EMF times current is speed times torque: here with 2 A, 0.25 V s/rad and heat of 1 ohm.
                voltage: Vector {
                    a: 2.0 + 0.25 * speed * torque,
                    b: 0.0,
                },
                current: Vector { a: 2.0, b: 0.0 },
                magnetising: 0.0,
                amplitude: 2.0,
                advance,
            };
            (0..200).fold(0.0, |_, _| damper.tick(&passed, 1.0, back_emf))
        })
    }

    #[test]
    fn more_torque_than_the_mean_pulls_the_command_back_in_both_directions_alike() {
        let forward = trims(10.0, 0.25);
        let backward = trims(-10.0, 0.25);
        assert_eq!(forward[0], 0.0, "the first torque is the load's");
        assert!((forward[1] - GAIN * 0.4).abs() < 0.03, "{forward:?}");
        for (there, back) in forward.iter().zip(backward) {
            assert!((there - back).abs() < 1e-4, "{forward:?} {backward:?}");
        }
    }

    #[test]
    fn a_field_that_grows_is_no_torque() {
        let mut damper = Damper::default();
        let mut trim_at = |magnetising| {
            let passed = Passed {
                voltage: Vector {
                    a: 3.0 + 0.5 * magnetising,
                    b: 0.0,
                },
                current: Vector { a: 2.0, b: 0.0 },
                magnetising,
                amplitude: 2.0,
                advance: electrical(5.0),
            };
            damper.tick(&passed, 1.0, 0.25)
        };
        assert!([0.0, 8.0, -8.0].into_iter().all(|power| trim_at(power).abs() < 1e-6));
    }

    #[test]
    fn the_damper_rests_below_its_speed_and_without_a_back_emf() {
        assert_eq!(trims(1.4, 0.25), [0.0; 4]);
        assert_eq!(trims(10.0, 0.0), [0.0; 4]);
    }

    #[test]
    fn the_trim_is_bounded_whatever_is_measured() {
        for trim in trims(1.6, 0.001) {
            assert!(trim.abs() <= MOST);
        }
    }
}
