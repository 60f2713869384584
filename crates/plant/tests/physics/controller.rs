//! A controller of the tests' own: it gives a plant a current vector, by the voltage that this needs and a proportional part.

use std::f64::consts::TAU;

use board::{Actuators, Duty, OutputLevels, PowerStage};
use plant::{BridgeParameters, MotorParameters, Phases, Plant, PlantConfig, SupplyParameters, Turns};

pub const TICK: f64 = 50e-6;
pub const PERIODS: f64 = 50.0;

/// A plant whose power stage is ideal: no dead time, no resistance, a stiff supply that also takes back.
pub fn ideal(motor: MotorParameters, supply: i32) -> PlantConfig {
    let mut config = PlantConfig {
        motor,
        supply: board::Millivolts(supply),
        source: SupplyParameters {
            impedance: 0.0,
            capacitance: 1e6,
            consumption: 0.0,
        },
        bridge: BridgeParameters {
            on_resistance: 0.0,
            dead_time: 0.0,
            diode_drop: 0.0,
        },
        ..PlantConfig::default()
    };
    config.travel.stops = (Turns(-1e6), Turns(1e6));
    config
}

/// The current vector of a plant, from the currents out of A+ and B+.
pub fn vector(plant: &Plant) -> [f64; 2] {
    plant.motor().currents
}

/// Duties for a current vector of an amplitude in ampere at a phase in electrical periods, while the field turns at `speed` turns a second.
pub fn duties(plant: &Plant, amplitude: f64, phase: f64, speed: f64) -> [Duty; 4] {
    let motor = plant.config().motor;
    let supply = plant.bus_voltage();
    let (sine, cosine) = (TAU * phase).sin_cos();
    let [a, b] = vector(plant);
    let quadrature = TAU * speed * (PERIODS * motor.inductance * amplitude + motor.back_emf);
    let gain = 4000.0 * motor.inductance;
    let wanted = [
        motor.resistance * amplitude * cosine - quadrature * sine + gain * (amplitude * cosine - a),
        motor.resistance * amplitude * sine + quadrature * cosine + gain * (amplitude * sine - b),
    ];
    legs(motor.phases, wanted).map(|leg| Duty(((0.5 + (leg / supply).clamp(-0.475, 0.475)) * 65_536.0) as u16))
}

/// Voltages of the legs, against the middle of the bus, for a vector of voltages over the windings.
pub fn legs(phases: Phases, [a, b]: [f64; 2]) -> [f64; 4] {
    let half = 3_f64.sqrt() / 2.0;
    match phases {
        Phases::Two => [a / 2.0, -a / 2.0, b / 2.0, -b / 2.0],
        Phases::Three => [a, -a / 2.0 + half * b, -a / 2.0 - half * b, 0.0],
    }
}

/// A tick at whose start the legs get duties for the next.
pub fn step(plant: &mut Plant, duties: [Duty; 4]) {
    plant.step(&commands(duties));
}

/// Duties and nothing else.
pub fn commands(duties: [Duty; 4]) -> Actuators {
    Actuators {
        stage: PowerStage::Legs(duties),
        outputs: OutputLevels(0),
    }
}

/// A field that turns.
pub struct Field {
    pub amplitude: f64,
    pub phase: f64,
    /// Turns a second.
    pub speed: f64,
}

impl Field {
    pub fn new(plant: &Plant, amplitude: f64) -> Self {
        Self {
            amplitude,
            phase: plant.shaft().0 * PERIODS,
            speed: 0.0,
        }
    }

    /// A tick, while the field accelerates by turns a second each second.
    pub fn tick(&mut self, plant: &mut Plant, acceleration: f64) {
        let duties = self.duties(plant);
        step(plant, duties);
        self.advance(acceleration);
    }

    /// Turns on by a tick.
    pub fn advance(&mut self, acceleration: f64) {
        self.phase += PERIODS * (self.speed + acceleration * TICK / 2.0) * TICK;
        self.speed += acceleration * TICK;
    }

    /// The duties that the field wants in the period after the coming one.
    pub fn duties(&self, plant: &Plant) -> [Duty; 4] {
        duties(plant, self.amplitude, self.phase + PERIODS * self.speed * TICK, self.speed)
    }

    pub fn run(&mut self, plant: &mut Plant, seconds: f64, acceleration: f64) {
        for _ in 0..(seconds / TICK).round() as u32 {
            self.tick(plant, acceleration);
        }
    }
}
