//! What was seen in each cycle of a demonstration.

use wire::Nanos;

use super::session::PULSES_PER_TURN;
use crate::motor_view::MotorView;

/// The parts of a demonstration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// From the first cycle in OP to Operation Enabled.
    Enabling,
    /// Homing on the home switch.
    Homing,
    /// A move in profile position mode.
    ProfilePosition,
    /// A sine in cyclic synchronous position mode.
    CyclicPosition,
    /// Back to Switch On Disabled.
    Disabling,
}

/// One cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// When the master began the cycle.
    pub time: Nanos,
    /// When it should have begun.
    pub due: Nanos,
    /// What was going on.
    pub phase: Phase,
    /// 0x607A as sent, in pulses; `None` when the phase does not use it.
    pub target: Option<i32>,
    /// 0x6064 as received, in pulses: where the drive commands the motor to be.
    pub commanded: i32,
    /// The motor as it really was.
    pub motor: MotorView,
}

/// A whole demonstration.
#[derive(Clone, Debug, Default)]
pub struct Samples {
    /// Cycles in order.
    pub cycles: Vec<Sample>,
    /// Position of the shaft, in pulses from power-on, at which 0x6064 reads 0, as homing has found it.
    pub home: f64,
}

impl Samples {
    /// The cycles of one phase.
    pub fn of(&self, phase: Phase) -> impl Iterator<Item = &Sample> {
        self.cycles.iter().filter(move |sample| sample.phase == phase)
    }

    /// Where the shaft was, in pulses from home.
    pub fn shaft_from_home(&self, sample: &Sample) -> f64 {
        sample.motor.shaft.0 * PULSES_PER_TURN - self.home
    }
}
