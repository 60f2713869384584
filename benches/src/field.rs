//! What lets a plant's motor turn, without a drive.

use std::f64::consts::TAU;

use board::{Actuators, Duty, ELECTRICAL_PERIODS_PER_TURN, LEG_COUNT, PowerStage, TICK};
use plant::{MotorParameters, Phases, Plant, PlantConfig};

const SECONDS: f64 = TICK.0 as f64 * 1e-9;
const PERIODS: f64 = ELECTRICAL_PERIODS_PER_TURN as f64;
/// Turns a second within a second.
const ACCELERATION: f64 = 20.0;
/// What the controller corrects of an error of the current, as a rate in 1/s.
const BANDWIDTH: f64 = 4000.0;

/// Commands that bring the motor to a speed in turns a second and keep it there for a number of ticks; and the plant when it has reached that.
///
/// # Panics
/// The motor has lost steps.
pub fn turning(config: PlantConfig, speed: f64, ticks: u32) -> (Plant, Vec<Actuators>) {
    let mut plant = Plant::new(config);
    let mut field = Field::default();
    while field.speed < speed {
        plant.step(&field.command(&plant));
        field.advance(ACCELERATION);
    }
    let ready = plant.clone();
    let commands = (0..ticks).map(|_| {
        let command = field.command(&plant);
        plant.step(&command);
        field.advance(0.0);
        command
    });
    let commands = commands.collect();
    let lag = field.turns - plant.shaft().0;
    assert!(lag.abs() < 0.5 / PERIODS, "the motor has lost steps: it lags by {lag} turns");
    (ready, commands)
}

/// A field that turns.
#[derive(Default)]
struct Field {
    turns: f64,
    speed: f64,
}

impl Field {
    fn advance(&mut self, acceleration: f64) {
        self.turns += (self.speed + acceleration * SECONDS / 2.0) * SECONDS;
        self.speed += acceleration * SECONDS;
    }

    /// Duties for rated current in the field's direction: by the voltage that this needs, and a proportional part.
    fn command(&self, plant: &Plant) -> Actuators {
        let motor = plant.config().motor;
        let amplitude = motor.rated_current;
        let (sine, cosine) = (TAU * PERIODS * self.turns).sin_cos();
        let induced = TAU * self.speed * (PERIODS * motor.inductance * amplitude + motor.back_emf);
        let (direct, gain) = (
            (motor.resistance + BANDWIDTH * motor.inductance) * amplitude,
            BANDWIDTH * motor.inductance,
        );
        let [a, b] = plant.motor().currents;
        let vector = [
            direct * cosine - induced * sine - gain * a,
            direct * sine + induced * cosine - gain * b,
        ];
        let duty = |leg: f64| Duty(((0.5 + (leg / plant.bus_voltage()).clamp(-0.475, 0.475)) * 65_536.0) as u16);
        Actuators {
            stage: PowerStage::Legs(legs(&motor, vector).map(duty)),
            ..Actuators::default()
        }
    }
}

/// Voltages of the legs, against the middle of the bus, for a vector of voltages over the windings.
fn legs(motor: &MotorParameters, [a, b]: [f64; 2]) -> [f64; LEG_COUNT] {
    let half = 3_f64.sqrt() / 2.0;
    match motor.phases {
        Phases::Two => [a / 2.0, -a / 2.0, b / 2.0, -b / 2.0],
        Phases::Three => [a, -a / 2.0 + half * b, -a / 2.0 - half * b, 0.0],
    }
}
