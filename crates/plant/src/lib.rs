//! What hangs on the drive's terminals, as a simulation: motor, travel, switches, supply.
//!
//! | module | holds |
//! |---|---|
//! | [`envelope`] | [`Envelope`]: the largest torque of a motor at each speed, in closed form |
//! | [`rotor`] | [`Rotor`]: the shaft, which follows the commanded field with a lag of first order |
//! | [`travel`] | [`Travel`]: the axis with its end stops, two limit switches and a home switch |
//! | `terminals` | the input terminals: what is wired to them, and when within a step they change |
//!
//! [`Plant::step`] takes one control tick. It holds no clock and no randomness: the same actuator commands give the same sensor values,
//! bit for bit, on every machine.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod angle;
pub mod envelope;
pub mod motor;
pub mod motors;
pub mod rotor;
mod terminals;
pub mod travel;

use board::{Actuators, Duty, INPUT_COUNT, InputLevels, LEG_COUNT, Milliamps, Millivolts, OutputLevels, PowerStage, Sensors};
pub use envelope::Envelope;
pub use motor::{MotorParameters, MotorState, Phases};
pub use rotor::{Rotor, Turns};
use terminals::Terminals;
pub use travel::{Switches, Travel};

const SQRT_3: f64 = 1.732_050_807_568_877_2;

/// What a plant is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantConfig {
    /// The axis the motor moves.
    pub travel: Travel,
    /// Where the axis stands at power-on.
    pub start: Turns,
    /// Which terminal each switch is wired to.
    pub wiring: Wiring,
    /// Further switches, as a touch probe or a flag is: where the axis switches IN1 to IN6 on, from the left edge up to, not including,
    /// the right one. They join whatever else is wired to the terminal.
    pub flags: [Option<(Turns, Turns)>; INPUT_COUNT],
    /// Voltage of the supply.
    pub supply: Millivolts,
    /// The motor.
    pub motor: MotorParameters,
    /// Inertia that turns with the shaft, in kg m^2.
    pub load_inertia: f64,
}

impl Default for PlantConfig {
    fn default() -> Self {
        Self {
            travel: Travel::default(),
            start: Turns(0.0),
            wiring: Wiring::default(),
            flags: [None; INPUT_COUNT],
            supply: Millivolts(36_000),
            motor: motors::QSH5718_56,
            load_inertia: 300e-7,
        }
    }
}

/// Which input terminal, 1 to 6, each switch of the axis is wired to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wiring {
    /// Terminal of the switch at the positive end.
    pub positive_limit: usize,
    /// Terminal of the switch at the negative end.
    pub negative_limit: usize,
    /// Terminal of the home switch.
    pub home: usize,
}

impl Default for Wiring {
    /// As the drive's inputs are assigned at delivery (manual 2.2.7).
    fn default() -> Self {
        Self {
            positive_limit: 3,
            negative_limit: 4,
            home: 5,
        }
    }
}

/// Motor, axis, switches and supply of one drive.
#[derive(Clone, Debug)]
pub struct Plant {
    config: PlantConfig,
    rotor: Rotor,
    motor: MotorState,
    terminals: Terminals,
    outputs: OutputLevels,
    phase_currents: [Milliamps; 2],
    /// The duties that the next PWM period begins with.
    duties: Option<[Duty; LEG_COUNT]>,
}

impl Plant {
    /// A plant at rest, its shaft at the configured start.
    pub fn new(config: PlantConfig) -> Self {
        let rotor = Rotor::new(config.start);
        Self {
            config,
            rotor,
            motor: MotorState {
                turns: config.start.0,
                ..MotorState::default()
            },
            terminals: Terminals::new(&config),
            outputs: OutputLevels(0),
            phase_currents: [Milliamps(0); 2],
            duties: None,
        }
    }

    /// Lets one tick (50 us) pass under the given commands and returns what the sensors read at its end.
    ///
    /// Within the tick the shaft turns evenly, which tells when inputs change. A switch that it passes from end to end in one tick does
    /// not show.
    pub fn step(&mut self, actuators: &Actuators) -> Sensors {
        let start = self.rotor.position();
        self.outputs = actuators.outputs;
        match actuators.stage {
            PowerStage::Off => {
                self.phase_currents = [Milliamps(0); 2];
                self.duties = None;
            }
            PowerStage::Field { angle, amplitude } => {
                self.rotor.follow(angle, amplitude);
                self.phase_currents = rotor::phase_currents(angle, amplitude);
            }
            PowerStage::Legs(duties) => {
                let voltages = self.duties.replace(duties).map_or([0.0; 2], |duties| self.voltages(duties));
                self.motor = self.config.motor.step(self.motor, voltages, 0.0, self.config.load_inertia);
                self.rotor = Rotor::new(Turns(self.motor.turns));
                self.phase_currents = self.leg_currents().map(|ampere| Milliamps((ampere * 1000.0) as i32));
            }
        }
        self.rotor.stop_at(self.config.travel.stops);
        let inputs = self.terminals.step(start, self.rotor.position());
        self.sensors_with(inputs)
    }

    /// The voltages over the windings, as the motor's equations have them.
    fn voltages(&self, duties: [Duty; LEG_COUNT]) -> [f64; 2] {
        let supply = f64::from(self.config.supply.0) / 1000.0;
        let [u, v, w, x] = duties.map(|duty| f64::from(duty.0) / 65_536.0 * supply);
        match self.config.motor.phases {
            Phases::Two => [u - v, w - x],
            Phases::Three => [(2.0 * u - v - w) / 3.0, (v - w) / SQRT_3],
        }
    }

    /// The currents out of the legs A+ and B+.
    fn leg_currents(&self) -> [f64; 2] {
        let [a, b] = self.motor.currents;
        match self.config.motor.phases {
            Phases::Two => [a, b],
            Phases::Three => [a, -a / 2.0 - SQRT_3 / 2.0 * b],
        }
    }

    /// What the sensors read now.
    pub fn sensors(&self) -> Sensors {
        self.sensors_with(self.terminals.levels(self.rotor.position()))
    }

    fn sensors_with(&self, inputs: InputLevels) -> Sensors {
        Sensors {
            inputs,
            level_ages: self.terminals.ages,
            bus_voltage: self.config.supply,
            phase_currents: self.phase_currents,
        }
    }

    /// Where the shaft really is, which an open-loop drive cannot know.
    pub fn shaft(&self) -> Turns {
        self.rotor.position()
    }

    /// The switches of the axis.
    pub fn switches(&self) -> Switches {
        self.config.travel.switches(self.rotor.position())
    }

    /// The outputs as the drive last set them.
    pub fn outputs(&self) -> OutputLevels {
        self.outputs
    }

    /// Holds input terminals on by hand, beside what the switches do, from the next step's start on.
    pub fn hold_inputs(&mut self, held_on: InputLevels) {
        self.terminals.held_on = held_on;
    }

    /// Gives the supply another voltage, from the next step on.
    pub fn set_supply(&mut self, supply: Millivolts) {
        self.config.supply = supply;
    }

    /// Moves the axis by hand; with the power stage on, the shaft then locks into the nearest electrical period.
    pub fn place(&mut self, position: Turns) {
        self.rotor = Rotor::new(position);
    }
}
