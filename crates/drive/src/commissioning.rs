//! Getting to know the motor at its first enabling: offsets, identification, gains (manual 2.2.11, 2.2.12).

use board::{ElectricalAngle, Milliamps, Millivolts, Sensors};

use crate::current_loop::auto_zero::AutoZero;
use crate::current_loop::identification::{Identification, Outcome, Situation, Winding};
use crate::current_loop::{Direction, Phases, Vector, ampere};
use crate::faults::Fault;
use crate::objects::DriveObjects;
use crate::power_stage::CurrentVector;
use crate::protection::PHASE_LOSS;

/// Resistance of a transistor of the power stage that is on, with its shunt, in ohm: what of an identified resistance is not the motor's.
const TRANSISTOR: f32 = 0.03;

/// What the power stage is to do for a motor that is not known yet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Order {
    /// Nothing, as the offsets of the current sensors are not known yet.
    Wait,
    /// This voltage over the windings; the vector tells the current it is meant to make.
    Drive(CurrentVector, Vector),
    /// The current loop takes over from this vector and this voltage in its frame.
    TakeOver(CurrentVector, Vector),
    /// Nothing, because of a fault.
    Fault(Fault),
}

/// Where the identification stands in the present enabling.
#[derive(Clone, Debug, Default)]
enum Progress {
    /// The motor is off, or the offsets are still measured.
    #[default]
    Ahead,
    /// Under way.
    Running(Identification),
    /// Nothing more will be found out before the motor is enabled again.
    Over,
}

/// What the drive knows of sensors and motor.
#[derive(Clone, Debug, Default)]
pub struct Commissioning {
    zero: AutoZero,
    progress: Progress,
    /// Whether the motor has been identified to satisfaction.
    known: bool,
    winding: Option<Winding>,
    /// What follows from it in the objects.
    registers: Registers,
    /// 0x200B:01 and 0x200C:01 as last seen.
    seen: (u16, u16),
}

/// A winding as the objects show it.
#[derive(Clone, Copy, Debug, Default)]
struct Registers {
    /// 0x200C:02.
    resistance: u16,
    /// 0x200C:03.
    inductance: u16,
    /// 0x200B:02.
    kp: u16,
    /// 0x200B:03.
    ki: u16,
}

/// Time constants of windings, in seconds, between which those of all motors of this class lie. A resistance that says otherwise, measured while the
/// rotor still swung, is not believed.
const TIME_CONSTANTS: (f32, f32) = (0.5e-3, 10e-3);

impl Registers {
    fn of(winding: Winding, phases: Phases) -> Self {
        let believed = match winding.settled {
            true => winding.resistance,
            false => winding
                .resistance
                .clamp(winding.inductance / TIME_CONSTANTS.1, winding.inductance / TIME_CONSTANTS.0),
        };
        let transistors = match phases {
            Phases::Two => 2.0 * TRANSISTOR,
            Phases::Three => TRANSISTOR,
        };
        Self {
            resistance: rounded((believed - transistors) * 1e3).clamp(100, 65_535),
            inductance: rounded(winding.inductance * 1e3).min(10),
            kp: rounded(winding.inductance * 1e6).max(100),
            ki: rounded(believed * 1e3 / 5.0).min(10_000),
        }
    }
}

impl Commissioning {
    /// The motor as identified.
    pub const fn winding(&self) -> Option<Winding> {
        self.winding
    }

    /// Whether the identification is under way, so that no current loop drives.
    pub const fn is_running(&self) -> bool {
        matches!(self.progress, Progress::Running(_))
    }

    /// Whether a motor that is enabled has no current yet, as the offsets of the sensors are not known: 2 ms after power-on, or longer while
    /// somebody turns the shaft so fast that the diodes conduct.
    pub fn awaits_offsets(&self, objects: &DriveObjects) -> bool {
        let identifies = objects.auto_pi != 0 && !self.known && matches!(self.progress, Progress::Ahead);
        identifies && !self.zero.is_known()
    }

    /// What the current sensors read but for their offsets.
    pub fn corrected(&self, phase_currents: [Milliamps; 2]) -> [Milliamps; 2] {
        self.zero.corrected(phase_currents)
    }

    /// The circuit whose offset says that it is broken.
    pub fn broken_circuit(&self) -> Option<Fault> {
        self.zero.broken().map(|sensor| [Fault::CircuitA, Fault::CircuitB][sensor.min(1)])
    }

    /// A tick that began with the power stage on or off, and the sensors' readings in it.
    pub fn observe(&mut self, sensors: &Sensors, on: bool) {
        if on {
            self.zero.on();
        } else {
            self.zero.off(sensors.phase_currents);
        }
    }

    /// The motor is off. An identification that was under way begins anew the next time.
    pub fn off(&mut self) {
        self.progress = Progress::Ahead;
    }

    /// A fault of the windings or their circuits: the motor may be another one after it.
    pub fn doubt(&mut self) {
        self.known = false;
    }

    /// Shows what is known in the objects, and follows 0x200B:01: another identification is due when it becomes 1 and when the kind of
    /// motor changes. While it is 1 the gains are the drive's, whatever a process image writes there.
    pub fn publish(&mut self, objects: &mut DriveObjects) {
        let settings = (objects.auto_pi, objects.motor_type);
        if settings != self.seen {
            (self.known, self.winding, self.seen) = (false, None, settings);
        }
        if self.winding.is_some() {
            objects.resistance_auto = self.registers.resistance;
            objects.inductance_auto = self.registers.inductance;
            objects.current_loop_kp = self.registers.kp;
            objects.current_loop_ki = self.registers.ki;
        }
    }

    /// One tick of the motor's first enabling, with the currents out of A+ and B+ in ampere, offsets taken off; none if there is nothing to find out. A field that turns, as CSP may have it, ends the
    /// identification: the motor is identified the next time.
    pub fn tick(
        &mut self,
        angle: ElectricalAngle,
        moving: bool,
        currents: [f32; 2],
        supply: Millivolts,
        objects: &DriveObjects,
    ) -> Option<Order> {
        if objects.auto_pi == 0 || moving || self.known && matches!(self.progress, Progress::Ahead) {
            self.progress = Progress::Over;
        }
        if matches!(self.progress, Progress::Ahead) {
            if !self.zero.is_known() {
                return Some(Order::Wait);
            }
            self.progress = Progress::Running(Identification::new());
        }
        let Progress::Running(running) = &mut self.progress else {
            return None;
        };
        let phases = Phases::from_object(objects.motor_type);
        let amplitude = Milliamps(objects.peak_current.into());
        let situation = Situation {
            current: phases.current(currents),
            supply: supply.0.max(0) as f32 * 1e-3,
            amplitude: ampere(amplitude),
            direction: Direction::of(angle.0),
            three_phases: phases == Phases::Three,
        };
        let outcome = running.tick(&situation);
        let vector = CurrentVector {
            angle,
            amplitude: Milliamps((running.level() * amplitude.0 as f32) as i32),
        };
        if let Outcome::Drive(voltage) = outcome {
            return Some(Order::Drive(vector, voltage));
        }
        self.progress = Progress::Over;
        self.conclude(outcome, vector, objects)
    }

    /// What comes of the end of the identification.
    fn conclude(&mut self, outcome: Outcome, vector: CurrentVector, objects: &DriveObjects) -> Option<Order> {
        match outcome {
            Outcome::Known(winding, voltage) => {
                (self.known, self.winding) = (winding.settled, Some(winding));
                self.registers = Registers::of(winding, Phases::from_object(objects.motor_type));
                Some(Order::TakeOver(vector, voltage))
            }
            Outcome::Open(_) if objects.error_detection & PHASE_LOSS != 0 => Some(Order::Fault(Fault::PhaseLoss)),
            Outcome::Shorted => Some(Order::Fault(Fault::Overcurrent)),
            _ => None,
        }
    }
}

/// The nearest whole number.
fn rounded(value: f32) -> u16 {
    (value + 0.5) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_resistance_measured_while_the_rotor_swung_is_believed_within_what_motors_have() {
        let gains = |resistance, settled| {
            let winding = Winding {
                resistance,
                inductance: 2.8e-3,
                settled,
            };
            let registers = Registers::of(winding, Phases::Two);
            (registers.kp, registers.ki, registers.resistance)
        };
        assert_eq!(gains(1.56, true), (2800, 312, 1500));
        assert_eq!(gains(1.56, false), (2800, 312, 1500));
        assert_eq!(gains(0.05, false), (2800, 56, 220));
        assert_eq!(gains(50.0, false), (2800, 1120, 5540));
    }
}
