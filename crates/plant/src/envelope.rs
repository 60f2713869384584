//! The pull-out envelope: the most torque that a motor can follow in step with, in closed form.
//!
//! In the frame of the rotor, the drive has to stay within two discs of the current plane: its current amplitude, and what its voltage can
//! drive through the winding against back-EMF and reactance. The torque at a speed is the highest point that both have in common. Detent
//! torque is not in it, for its mean over a turn is nothing, and neither is the motor's inertia: this is the torque of steady running.

use board::ELECTRICAL_PERIODS_PER_TURN;
use libm::sqrt;

use crate::motor::{MotorParameters, Phases};

/// The share of the supply that a bridge can put over a winding: the rest is dead time, and the least time the low transistors have to be
/// on for currents to be measured.
pub const MODULATION_LIMIT: f64 = 0.95;

const SQRT_3: f64 = 1.732_050_807_568_877_2;

/// No motor of this kind gets here, in turns a second: where the search for the fastest speed ends.
const FASTEST: f64 = 1000.0;

/// Halvings of the search for the fastest speed: to 1000 / 2^40 turns a second.
const HALVINGS: u32 = 40;

/// Electrical periods in a turn.
const PERIODS: f64 = ELECTRICAL_PERIODS_PER_TURN as f64;

/// Radians a second of one turn a second.
const TURN: f64 = core::f64::consts::TAU;

/// What a motor can do in steady running, behind a supply and with a current.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Envelope {
    motor: MotorParameters,
    /// Largest amplitude of the voltage over a winding.
    voltage: f64,
    /// Amplitude of the current.
    current: f64,
}

impl Envelope {
    /// Of a motor behind a supply in V, with a phase current of this amplitude in A.
    pub fn new(motor: &MotorParameters, supply: f64, current: f64) -> Self {
        let share = match motor.phases {
            Phases::Two => MODULATION_LIMIT,
            // The largest circle within the hexagon of a bridge with three legs.
            Phases::Three => MODULATION_LIMIT / SQRT_3,
        };
        Self {
            motor: *motor,
            voltage: share * supply,
            current,
        }
    }

    /// The speed in turns a second up to which the whole current can be driven at right angles to the rotor. Above it torque falls.
    ///
    /// 0 if the supply cannot drive the current even at rest.
    pub fn corner_speed(&self) -> f64 {
        let motor = &self.motor;
        let drop = motor.resistance * self.current;
        let reactance = PERIODS * motor.inductance * self.current;
        // (reactance w)^2 + (drop + emf w)^2 = voltage^2
        let square = reactance * reactance + motor.back_emf * motor.back_emf;
        let half = drop * motor.back_emf;
        let rest = drop * drop - self.voltage * self.voltage;
        if rest >= 0.0 {
            return 0.0;
        }
        (sqrt(half * half - square * rest) - half) / square / TURN
    }

    /// The largest load in Nm that the motor carries at a speed in turns a second; friction and drag are taken off. Below 0 the motor cannot
    /// turn so fast even without a load.
    pub fn torque_at(&self, speed: f64) -> f64 {
        let speed = speed.abs() * TURN;
        let electromagnetic = self.motor.torque_constant() * self.torque_current(speed);
        electromagnetic - self.motor.friction - self.motor.drag * speed
    }

    /// The speed in turns a second at which nothing is left for a load, 1000 at the most.
    pub fn no_load_speed(&self) -> f64 {
        let (mut low, mut high) = (0.0, FASTEST);
        if self.torque_at(high) > 0.0 {
            return high;
        }
        for _ in 0..HALVINGS {
            let middle = (low + high) / 2.0;
            if self.torque_at(middle) > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }

    /// The largest current at right angles to the rotor, in A, at a speed in rad/s.
    fn torque_current(&self, speed: f64) -> f64 {
        let motor = &self.motor;
        let reactance = PERIODS * speed * motor.inductance;
        let emf = speed * motor.back_emf;
        let square = motor.resistance * motor.resistance + reactance * reactance;
        // The voltage's disc: its radius and its centre, the current at which the drive's voltage is nothing.
        let radius = self.voltage / sqrt(square);
        let (d, q) = (-emf * reactance / square, -emf * motor.resistance / square);
        let distance = sqrt(d * d + q * q);
        let is_in_voltage = |x: f64, y: f64| (x - d) * (x - d) + (y - q) * (y - q) <= radius * radius;
        if is_in_voltage(0.0, self.current) {
            return self.current;
        }
        let top = q + radius;
        if d * d + top * top <= self.current * self.current {
            return top;
        }
        // What is left is where the two circles meet, or come nearest to one another.
        let along = (self.current * self.current - radius * radius + distance * distance) / (2.0 * distance);
        let across = sqrt((self.current * self.current - along * along).max(0.0));
        (along * q - across * d) / distance
    }
}
