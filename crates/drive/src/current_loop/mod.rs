//! The current loop: from the commanded current vector and the measured currents to the duties of the legs, every tick.
//!
//! | module | holds |
//! |---|---|
//! | [`vector`] | vectors of the current plane, sine and cosine |
//! | [`gains`] | 0x200B: the registers' scales |
//! | [`regulator`] | PI in the frame that turns with the command |
//! | [`auto_zero`] | offsets of the current sensors |
//! | [`identification`] | resistance and inductance of the motor, at the first enabling |
//! | [`ripple`] | a winding's answer to a square wave |
//! | [`bridge`] | limits of the supply, and duties, for two phases and three |
//!
//! The frame turns with the commanded vector, so that a motor that runs evenly has constant currents and voltages in it, and the
//! regulators leave no error at any speed.

pub mod auto_zero;
mod bridge;
mod gains;
pub mod identification;
mod regulator;
mod ripple;
mod vector;

use board::{Milliamps, PowerStage, Sensors};

use crate::objects::DriveObjects;
use crate::power_stage::CurrentVector;
pub use bridge::{Bridge, Phases};
pub use gains::Gains;
use regulator::Regulator;
pub use vector::{Direction, Vector};

/// Measured currents beyond this are taken for it, in mA: more than any sensor of the drive reads.
const MOST_MEASURED: i32 = 30_000;

/// What the loop takes from the objects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Gains, 0x200B.
    pub gains: Gains,
    /// Phases of the motor, 0x200C:01.
    pub phases: Phases,
}

impl Settings {
    /// The settings as the objects have them now.
    pub fn from_objects(objects: &DriveObjects) -> Self {
        Self {
            gains: Gains::from_objects(objects),
            phases: Phases::from_object(objects.motor_type),
        }
    }
}

/// The loop of both currents.
#[derive(Clone, Debug, Default)]
pub struct CurrentLoop {
    regulator: Regulator,
    /// The vector commanded in the tick before, which is what the present measurement is to show.
    due: Option<CurrentVector>,
}

impl CurrentLoop {
    /// No current is commanded: the loop begins anew when one is.
    pub fn off(&mut self) {
        *self = Self::default();
    }

    /// Takes over from the identification, which has commanded `command` with this voltage in its frame.
    pub fn resume(&mut self, command: CurrentVector, voltage: Vector) {
        self.regulator.resume(voltage);
        self.due = Some(command);
    }

    /// The duties that bring the currents to `command` by the end of the tick.
    ///
    /// What is measured now is the end of the tick before, so the error is that against the vector of the tick before. The duties act in
    /// the PWM period after this tick, whose middle is a period and a half after the measurement; the voltage is turned by as much.
    pub fn tick(&mut self, command: CurrentVector, sensors: &Sensors, settings: &Settings) -> PowerStage {
        let due = self.due.replace(command).unwrap_or(command);
        let advance = command.angle.0.wrapping_sub(due.angle.0) as i32;
        let frame = Direction::of(due.angle.0);
        let ahead = Direction::of(due.angle.0.wrapping_add(advance.wrapping_add(advance >> 1) as u32));

        let measured = settings.phases.current(sensors.phase_currents.map(ampere));
        let wanted = Vector {
            a: ampere(due.amplitude),
            b: 0.0,
        };
        let error = wanted.minus(frame.into_frame(measured));
        let gains = &settings.gains;
        let bridge = Bridge::at(sensors.bus_voltage, settings.phases);
        let asked = self.regulator.voltage(error, gains);
        let voltage = bridge.limited(ahead.out_of_frame(asked));
        self.regulator.integrate(error, asked.minus(ahead.into_frame(voltage)), gains);
        PowerStage::Legs(bridge.duties(voltage))
    }
}

/// A current in ampere.
pub(crate) fn ampere(current: Milliamps) -> f32 {
    current.0.clamp(-MOST_MEASURED, MOST_MEASURED) as f32 * 1e-3
}
