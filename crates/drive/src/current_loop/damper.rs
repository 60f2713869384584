//! The damper against mid-band instability: a rotor that swings about the commanded angle, found by its power alone.

use core::f32::consts::TAU;

use board::{ELECTRICAL_PERIODS_PER_TURN, TICKS_PER_SECOND};

use super::vector::Vector;

/// Trim in radians of the electrical period for a torque that deviates by the holding torque. This is 2 zeta wn / w, with the damping
/// ratio zeta = 0.2, a natural frequency wn of 225 Hz, which motors of this class have alone, and the corner w of [`PASS`].
const GAIN: f32 = 0.6;
/// The most that the commanded angle is trimmed, in radians.
const MOST: f32 = 0.7;
/// Corner below which torque counts, 150 Hz, as the share taken of each sample: the low pass makes the deviation of speed out of it.
const PASS: f32 = 1.0 - 0.953_970_7;
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
    /// The commanded amplitude in ampere.
    pub amplitude: f32,
    /// Radians of the electrical period by which the command has turned; negative backward.
    pub advance: f32,
}

/// Damps the rotor's swinging by trimming the commanded angle.
///
/// What the windings take beyond their heat is the rotor's power, and over the commanded speed its torque. Torque through a low pass is
/// the deviation of speed; a trim against it is damping. The mean of the torque, the load's, is left out, so that no trim stays.
#[derive(Clone, Debug, Default)]
pub struct Damper {
    torque: f32,
    mean: f32,
    running: bool,
    trim: f32,
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
        let power = passed.voltage.dot(passed.current) - heat;
        // Radians of the shaft in a second.
        let turning = passed.advance * (TICKS_PER_SECOND as f32 / ELECTRICAL_PERIODS_PER_TURN as f32);
        let torque = power / (turning * back_emf * passed.amplitude);
        if !self.running {
            (self.running, self.torque, self.mean) = (true, torque, torque);
        }
        self.torque += PASS * (torque - self.torque);
        self.mean += MEAN * (self.torque - self.mean);
        let share = ((speed - BEGIN) * (1.0 / (WHOLE - BEGIN))).min(1.0);
        self.trim = (-GAIN * (self.torque - self.mean)).clamp(-MOST, MOST) * share;
        self.trim
    }

    /// The trim in radians.
    pub const fn trim(&self) -> f32 {
        self.trim
    }
}
