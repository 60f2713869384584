//! What only a simulation can see of a drive's motor, at a glance.

use std::fmt;

use drive::CurrentVector;
use plant::envelope::Envelope;
use plant::{Plant, Turns};

use crate::synchronism::Synchronism;

/// The part by which a mean follows in each tick: it forgets with a time constant of 5 ms, longer than a period of the detent torque at
/// any speed at which it could be felt, and shorter than a ramp.
const FORGETTING: f64 = 0.01;

/// Follows the motor tick by tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorWatch {
    synchronism: Synchronism,
    /// Amplitude of the commanded current in A; `None` while the power stage is off.
    current: Option<f64>,
    /// Mean torque of the motor in Nm.
    torque: f64,
    /// Mean speed in rad/s.
    speed: f64,
}

impl MotorWatch {
    /// Looks at the end of a tick; `locked` is whether the shaft lock is over.
    pub(crate) fn observe(&mut self, vector: Option<CurrentVector>, locked: bool, plant: &Plant) {
        self.synchronism.observe(vector, locked, plant.shaft());
        self.current = vector.map(|vector| f64::from(vector.amplitude.0) / 1000.0);
        self.torque += FORGETTING * (plant.torque() - self.torque);
        self.speed += FORGETTING * (plant.motor().speed - self.speed);
    }

    /// Lag and lost periods.
    pub fn synchronism(&self) -> &Synchronism {
        &self.synchronism
    }

    /// The motor as it is now.
    pub fn view(&self, plant: &Plant) -> MotorView {
        MotorView {
            shaft: plant.shaft(),
            lag: self.synchronism.lag(),
            lost_periods: self.synchronism.lost_periods(),
            torque: self.torque,
            torque_reserve: self.torque_reserve(plant),
            currents: plant.currents(),
            bus_voltage: plant.bus_voltage(),
            supply_current: plant.supply_current(),
        }
    }

    /// The part of the pull-out torque at this speed, current and voltage that is not used.
    fn torque_reserve(&self, plant: &Plant) -> Option<f64> {
        let motor = &plant.config().motor;
        let envelope = Envelope::new(motor, plant.bus_voltage(), self.current?);
        let pull_out = envelope.torque_at(self.speed / std::f64::consts::TAU) + motor.friction + motor.drag * self.speed.abs();
        Some(if pull_out > 0.0 {
            (1.0 - self.torque.abs() / pull_out).clamp(0.0, 1.0)
        } else {
            0.0
        })
    }
}

/// The motor at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorView {
    /// Where the shaft is.
    pub shaft: Turns,
    /// By how much it lags behind the commanded field, in electrical periods from -0.5 to 0.5; see [`Synchronism::lag`].
    pub lag: f64,
    /// Electrical periods lost since power-on; see [`Synchronism::lost_periods`].
    pub lost_periods: i64,
    /// Torque of windings and magnets in Nm, as a mean over some 5 ms.
    pub torque: f64,
    /// What part of the torque that the motor could give at this speed, current and bus voltage before it falls out of step is not used, from
    /// 0 to 1; `None` while the power stage is off.
    pub torque_reserve: Option<f64>,
    /// Currents of windings A and B, or of the phases U and W, in A.
    pub currents: [f64; 2],
    /// Voltage at the power stage in V.
    pub bus_voltage: f64,
    /// Current that the supply delivers in A.
    pub supply_current: f64,
}

impl fmt::Display for MotorView {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b] = self.currents;
        match self.torque_reserve {
            Some(reserve) => write!(f, "lag {:4.0} deg el., torque reserve {:3.0} %", self.lag * 360.0, reserve * 100.0)?,
            None => write!(f, "shaft free")?,
        }
        write!(
            f,
            ", {a:+5.2} A {b:+5.2} A, bus {:4.1} V {:4.2} A",
            self.bus_voltage, self.supply_current
        )?;
        match self.lost_periods {
            0 => Ok(()),
            lost => write!(f, ", {} electrical periods lost", lost.abs()),
        }
    }
}
