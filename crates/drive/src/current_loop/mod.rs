//! The current loop: from the commanded current vector and the measured currents to the duties of the legs, every tick.
//!
//! | module | holds |
//! |---|---|
//! | `vector` | vectors of the current plane, sine and cosine |
//! | `gains` | 0x200B: the registers' scales |
//! | `harmonic` | 0x2060 to 0x2062: the harmonic against the first resonance |
//! | `regulator` | PI in the frame that turns with the command |
//! | `auto_zero` | offsets of the current sensors |
//! | [`identification`] | resistance and inductance of the motor, at the first enabling |
//! | `pulses`, `levels` | its steps |
//! | `ripple` | a winding's answer to a square wave |
//! | `damper` | trims the commanded angle against a swinging rotor |
//! | `bridge` | limits of the supply, and duties, for two phases and three |
//!
//! The frame turns with the commanded vector, so that a motor that runs evenly has constant currents and voltages in it, and the
//! regulators leave no error at any speed.

pub mod auto_zero;
mod bridge;
mod damper;
mod gains;
mod harmonic;
pub mod identification;
mod levels;
mod pulses;
mod regulator;
mod ripple;
mod vector;

use board::{Milliamps, Millivolts, PowerStage, TICKS_PER_SECOND};

use crate::objects::DriveObjects;
use crate::power_stage::CurrentVector;
pub use bridge::{Bridge, Phases};
use damper::{Damper, Passed};
pub use gains::Gains;
use harmonic::Harmonic;
use regulator::Regulator;
pub use vector::{Direction, Vector};
use vector::{angle_of, radians_of};

/// Measured currents beyond this are taken for it, in mA: more than any sensor of the drive reads.
const MOST_MEASURED: i32 = 30_000;

/// What the loop takes from the objects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Gains, 0x200B.
    pub gains: Gains,
    /// Phases of the motor, 0x200C:01.
    pub phases: Phases,
    /// Resistance of a winding in ohm: 0x200C:02 as identified if the drive sets the gains itself, else 0x200C:04.
    pub resistance: f32,
    /// Inductance of a winding in henry, which the loop's gain 0x200B:02 is in microhenry.
    pub inductance: f32,
    /// Back-EMF in V s/rad of the shaft, 0x200C:06.
    pub back_emf: f32,
    /// The harmonic in the current, 0x2060 to 0x2062.
    harmonic: Option<Harmonic>,
}

impl Settings {
    /// The settings as the objects have them now.
    pub fn from_objects(objects: &DriveObjects) -> Self {
        Self {
            gains: Gains::from_objects(objects),
            phases: Phases::from_object(objects.motor_type),
            resistance: f32::from(match objects.auto_pi {
                0 => objects.resistance_set,
                _ => objects.resistance_auto,
            }) * 1e-3,
            inductance: f32::from(objects.current_loop_kp) * 1e-6,
            back_emf: f32::from(objects.bemf_coefficient) * 1e-3,
            harmonic: Harmonic::from_objects(objects),
        }
    }
}

/// The loop of both currents.
#[derive(Clone, Debug, Default)]
pub struct CurrentLoop {
    regulator: Regulator,
    /// The vector commanded in the tick before, which is what the present measurement is to show.
    due: Option<CurrentVector>,
    damper: Damper,
    /// Currents measured in the tick before.
    current: Vector,
    /// The voltage commanded in the tick before, which acts now, and the one before that, which has just acted.
    voltages: [Vector; 2],
    trim: f32,
    limited: bool,
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

    /// The duties that bring the currents to `command` by the end of the tick; `currents` are those out of A+ and B+ in ampere.
    ///
    /// What is measured now is the end of the tick before, so the error is that against the vector of the tick before. The duties act in
    /// the PWM period after this tick, whose middle is a period and a half after the measurement; the voltage is turned by as much.
    #[inline(always)]
    pub fn tick(&mut self, command: CurrentVector, currents: [f32; 2], supply: Millivolts, settings: &Settings) -> PowerStage {
        let due = self.due.replace(command).unwrap_or(command);
        let turn = command.angle.0.wrapping_sub(due.angle.0) as i32;
        let measured = settings.phases.current(currents);
        let amplitude = ampere(due.amplitude);
        let growth = measured.dot(measured) - self.current.dot(self.current);
        let passed = Passed {
            voltage: self.voltages[1],
            current: self.current.plus(measured).times(0.5),
            magnetising: match settings.harmonic {
                None => 0.0,
                Some(_) => 0.5 * settings.inductance * growth * TICKS_PER_SECOND as f32,
            },
            amplitude,
            advance: radians_of(turn),
        };
        let trim = self.damper.tick(&passed, settings.resistance, settings.back_emf);
        let angle = due.angle.0.wrapping_add(angle_of(trim));
        let turned = angle.wrapping_add(turn.wrapping_add(turn >> 1) as u32);

        let (ahead, error) = match settings.harmonic {
            None => {
                let [frame, ahead] = Direction::of_each([angle, turned]);
                (ahead, Vector { a: amplitude, b: 0.0 }.minus(frame.into_frame(measured)))
            }
            Some(harmonic) => {
                let [first, second] = harmonic.angles(angle);
                let [frame, ahead, first, second] = Direction::of_each([angle, turned, first, second]);
                let current = frame.out_of_frame(Vector { a: amplitude, b: 0.0 });
                let current = harmonic.added_to(current, amplitude, [first, second]);
                (ahead, frame.into_frame(current.minus(measured)))
            }
        };
        let bridge = Bridge::at(supply, settings.phases);
        let asked = self.regulator.voltage(error, &settings.gains);
        let wanted = ahead.out_of_frame(asked);
        let voltage = bridge.limited(wanted);
        let excess = ahead.into_frame(wanted.minus(voltage));
        self.regulator.integrate(error, excess, &settings.gains);

        self.current = measured;
        self.voltages = [voltage, self.voltages[0]];
        (self.trim, self.limited) = (trim, voltage != wanted);
        PowerStage::Legs(bridge.duties(voltage))
    }

    /// The measured current in ampere.
    pub const fn current(&self) -> Vector {
        self.current
    }

    /// The commanded voltage over the windings in volt.
    pub const fn voltage(&self) -> Vector {
        self.voltages[0]
    }

    /// Whether the supply gives less voltage than the currents need, as it does at speed: torque falls from there on.
    pub const fn is_at_voltage_limit(&self) -> bool {
        self.limited
    }

    /// Radians of the electrical period by which the damper turns the commanded vector.
    pub const fn trim(&self) -> f32 {
        self.trim
    }
}

/// A current in ampere.
pub(crate) fn ampere(current: Milliamps) -> f32 {
    current.0.clamp(-MOST_MEASURED, MOST_MEASURED) as f32 * 1e-3
}
