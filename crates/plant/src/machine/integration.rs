//! A step of Runge and Kutta's fourth order over flux, speeds and angles.
//!
//! The slope of an angle is a speed, which is known a stage before the torque is. Written out for each kind of variable, and not for a vector of
//! them that are all alike, the sines for the next stage are computed while this stage's torque still is: that saves a quarter of the time.

use core::array::from_fn;
use core::f64::consts::TAU;

use super::{Machine, PERIODS, TURNS_PER_RADIAN};
use crate::angle::Angle;
use crate::bridge::Applied;
use crate::windings::{Coils, Linear, Vector, dot};

/// What is integrated: with one body the rotor and all that it drives, with two the rotor and the load.
pub(super) struct Variables<const BODIES: usize> {
    /// Flux through the windings, that of the magnets included.
    pub(super) flux: Vector,
    pub(super) speeds: [f64; BODIES],
    pub(super) turns: [f64; BODIES],
}

/// The slopes of flux and speeds, and those of what a step moves.
struct Slope<const BODIES: usize> {
    flux: Vector,
    speeds: [f64; BODIES],
    /// The currents, whose integral is the charge.
    currents: Vector,
    /// Power that resistances take, and what dead time keeps from the windings; with three phases two thirds of it.
    heat: f64,
    dead: f64,
}

/// What a step has moved through the windings.
pub(super) struct Passed {
    pub(super) charge: Vector,
    /// Energies as the powers of [`Slope`].
    pub(super) heat: f64,
    pub(super) dead: f64,
}

/// What slopes come from.
pub(super) struct Integration<'a, M> {
    pub(super) machine: &'a Machine,
    pub(super) coils: &'a Coils<M>,
    pub(super) applied: &'a Applied,
}

impl<M: Linear> Integration<'_, M> {
    /// The variables after a step that begins at this electrical angle, and what has passed through the windings.
    #[inline(always)]
    pub(super) fn step<const BODIES: usize>(&self, start: &Variables<BODIES>, angle: &Angle, time: f64) -> (Variables<BODIES>, Passed) {
        let turned = |at: &Variables<BODIES>| angle.turned_to(at.turns[0] * PERIODS);
        let k1 = self.slope(start, angle);
        let second = start.ahead(&k1, &start.speeds, time / 2.0);
        let k2 = self.slope(&second, &turned(&second));
        let third = start.ahead(&k2, &second.speeds, time / 2.0);
        let k3 = self.slope(&third, &turned(&third));
        let fourth = start.ahead(&k3, &third.speeds, time);
        let k4 = self.slope(&fourth, &turned(&fourth));
        let sixth = time * (1.0 / 6.0);
        let over = |k1: f64, k2: f64, k3: f64, k4: f64| (k1 + 2.0 * (k2 + k3) + k4) * sixth;
        let end = Variables {
            flux: from_fn(|at| start.flux[at] + over(k1.flux[at], k2.flux[at], k3.flux[at], k4.flux[at])),
            speeds: from_fn(|at| start.speeds[at] + over(k1.speeds[at], k2.speeds[at], k3.speeds[at], k4.speeds[at])),
            turns: from_fn(|at| {
                let mean = start.speeds[at] + (k1.speeds[at] + k2.speeds[at] + k3.speeds[at]) * sixth;
                start.turns[at] + mean * (time * TURNS_PER_RADIAN)
            }),
        };
        let passed = Passed {
            charge: from_fn(|at| over(k1.currents[at], k2.currents[at], k3.currents[at], k4.currents[at])),
            heat: over(k1.heat, k2.heat, k3.heat, k4.heat),
            dead: over(k1.dead, k2.dead, k3.dead, k4.dead),
        };
        (end, passed)
    }

    #[inline(always)]
    fn slope<const BODIES: usize>(&self, at: &Variables<BODIES>, angle: &Angle) -> Slope<BODIES> {
        let currents = self.coils.currents(at.flux, angle);
        let ohmic = self.coils.resistance.times(currents);
        let dead = self.applied.dead(&self.machine.windings, currents);
        let torque = self.coils.torque(currents, angle) - self.machine.detent(angle);
        Slope {
            flux: from_fn(|at| self.applied.voltage[at] - dead[at] - ohmic[at]),
            speeds: self.machine.accelerations(torque, at),
            currents,
            heat: dot(ohmic, currents),
            dead: dot(dead, currents),
        }
    }
}

impl<const BODIES: usize> Variables<BODIES> {
    /// Where slopes and speeds lead to within a time.
    #[inline(always)]
    fn ahead(&self, slope: &Slope<BODIES>, speeds: &[f64; BODIES], time: f64) -> Self {
        Self {
            flux: from_fn(|at| self.flux[at] + time * slope.flux[at]),
            speeds: from_fn(|at| self.speeds[at] + time * slope.speeds[at]),
            turns: from_fn(|at| self.turns[at] + (time * TURNS_PER_RADIAN) * speeds[at]),
        }
    }
}

impl Machine {
    /// What the torque of windings and magnets makes of the speeds.
    #[inline(always)]
    fn accelerations<const BODIES: usize>(&self, torque: f64, at: &Variables<BODIES>) -> [f64; BODIES] {
        let Variables { speeds, turns, .. } = at;
        let mut accelerations = [0.0; BODIES];
        let taken = if BODIES == 2 {
            let coupled = self.stiffness * TAU * (turns[0] - turns[1]) + self.damping * (speeds[0] - speeds[1]);
            accelerations[1] = (coupled - self.load.drag * speeds[1] - self.load.torque) * self.load_lightness;
            coupled
        } else {
            self.load.torque
        };
        accelerations[0] = (torque - self.drag * speeds[0] - taken) * self.lightness;
        accelerations
    }
}
