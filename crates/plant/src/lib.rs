//! What hangs on the drive's terminals, as a simulation: power stage, motor, load, travel, switches, supply.
//!
//! | module | holds |
//! |---|---|
//! | [`config`] | [`PlantConfig`]: what a plant is made of |
//! | `observation` | what only a simulation can see: true position, lag, currents, torque, energy |
//! | [`bridge`] | four legs with dead time and resistance, or their diodes when all transistors are off |
//! | [`supply`] | [`SupplyParameters`]: source, impedance, bus capacitor |
//! | [`sensing`] | [`Sensing`]: what the drive's converter makes of currents and voltage |
//! | [`motor`] | [`MotorParameters`]: the hybrid stepping motor and its equations |
//! | [`motors`] | motors with a name |
//! | [`envelope`] | [`Envelope`]: the largest torque of a motor at each speed, in closed form |
//! | `windings` | the windings as the bridge sees them, whole or broken |
//! | `machine` | motor and load in motion: the integration |
//! | [`load`] | [`Load`]: inertia, friction, torque, elastic coupling |
//! | [`faults`] | [`Faults`]: what can break |
//! | [`energy`] | [`EnergyAccount`]: where the energy goes |
//! | [`travel`] | [`Travel`]: the axis with its end stops, two limit switches and a home switch |
//! | `terminals` | the input terminals: what is wired to them, and when within a step they change |
//!
//! [`Plant::step`] takes one control tick. It holds no clock and no randomness but the seeded noise of [`sensing`]: the same actuator commands give the
//! same sensor values, bit for bit, on every machine.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod angle;
pub mod bridge;
pub mod config;
pub mod energy;
pub mod envelope;
pub mod faults;
pub mod load;
mod machine;
pub mod motor;
pub mod motors;
mod observation;
pub mod sensing;
pub mod supply;
mod terminals;
pub mod travel;
mod windings;

use board::{Actuators, Duty, InputLevels, LEG_COUNT, Milliamps, Millivolts, OutputLevels, PowerStage, Sensors};
use bridge::Applied;
pub use bridge::BridgeParameters;
pub use config::{PlantConfig, Wiring};
pub use energy::EnergyAccount;
pub use envelope::Envelope;
pub use faults::Faults;
use faults::SENSOR_OFFSET;
pub use load::{Coupling, Load, LoadState};
use machine::{Machine, Moved, State};
pub use motor::{MotorParameters, MotorState, Phases};
use sensing::Converter;
pub use sensing::Sensing;
use supply::Bus;
pub use supply::SupplyParameters;
use terminals::Terminals;
pub use travel::{Switches, Travel, Turns};

/// Power stage, motor, axis, switches and supply of one drive.
#[derive(Clone, Debug)]
pub struct Plant {
    config: PlantConfig,
    faults: Faults,
    machine: Machine,
    state: State,
    bus: Bus,
    converter: Converter,
    terminals: Terminals,
    outputs: OutputLevels,
    phase_currents: [Milliamps; 2],
    /// The duties that the next PWM period begins with.
    duties: Option<[Duty; LEG_COUNT]>,
    bus_voltage: Millivolts,
    account: EnergyAccount,
}

impl Plant {
    /// A plant at rest, its shaft at the configured start and its bus charged.
    pub fn new(config: PlantConfig) -> Self {
        let bus = Bus::new(config.source, volt(config.supply));
        let converter = Converter::new(config.sensing);
        let mut plant = Self {
            faults: Faults::default(),
            machine: machine(&config, &Faults::default()),
            state: State::of(at_rest(config.start)),
            bus_voltage: converter.voltage(bus.voltage),
            bus,
            converter,
            terminals: Terminals::new(&config),
            outputs: OutputLevels(0),
            phase_currents: [Milliamps(0); 2],
            duties: None,
            account: EnergyAccount::default(),
            config,
        };
        plant.account.hand = plant.stored().stored();
        plant
    }

    /// Lets one tick (50 us) pass under the given commands and returns what the sensors read at its end.
    ///
    /// Within the tick the axis turns evenly, which tells when inputs change. A switch that it passes from end to end in one tick does
    /// not show.
    pub fn step(&mut self, actuators: &Actuators) -> Sensors {
        let start = self.axis();
        self.outputs = actuators.outputs;
        let stage = self.preload(actuators.stage);
        self.drive(stage);
        let [a, b] = self.currents();
        let [off_a, off_b] = self.faults.sensors.map(|broken| if broken { SENSOR_OFFSET } else { 0.0 });
        self.phase_currents = [a + off_a, b + off_b].map(|ampere| self.converter.current(ampere));
        self.bus_voltage = self.converter.voltage(self.bus.voltage);
        let inputs = self.terminals.step(start, self.axis());
        self.sensors_with(inputs)
    }

    /// What the bridge does in the coming PWM period: switching off acts at once, duties wait for the period after theirs. Before the first ones, the
    /// legs idle at half the supply.
    fn preload(&mut self, stage: PowerStage) -> PowerStage {
        const IDLE: [Duty; LEG_COUNT] = [Duty(1 << 15); LEG_COUNT];
        let next = match stage {
            PowerStage::Legs(duties) => Some(duties),
            _ => None,
        };
        let present = core::mem::replace(&mut self.duties, next);
        next.map_or(PowerStage::Off, |_| PowerStage::Legs(present.unwrap_or(IDLE)))
    }

    /// A tick of bridge, motor, load and supply.
    fn drive(&mut self, stage: PowerStage) {
        let applied = self.applied(stage);
        let (currents, turns) = (self.state.motor.currents, self.state.load.turns);
        let moved = self.machine.step(&mut self.state, &applied);
        let (mut drawn, mut heat) = (self.drawn(&applied, &moved), moved.heat);
        let state = &mut self.state;
        if applied.is_off() {
            let spent = applied.spend(&self.machine.windings, currents, state.motor.currents, moved.charge);
            state.motor.currents = spent.currents;
            drawn = spent.drawn;
            heat += spent.heat;
        }
        let (lowest, highest) = self.config.travel.stops;
        let stopped = self.machine.stop_at(state, (lowest.0, highest.0));
        let way = state.load.turns - turns;
        let fed = self.bus.step(drawn);
        let account = &mut self.account;
        account.source += fed.source;
        account.consumption += fed.consumption;
        account.heat += heat;
        account.drag += moved.drag;
        account.friction += moved.friction + stopped;
        account.load += self.machine.work(way);
    }

    /// What the bridge does to the windings in the coming tick: at the voltage that the bus has in the middle of it.
    fn applied(&self, stage: PowerStage) -> Applied {
        let (bridge, windings) = (&self.config.bridge, &self.machine.windings);
        let currents = self.state.motor.currents;
        if let PowerStage::Legs(duties) = stage {
            let bus = self.bus.in_mid_tick(Applied::drawn_by_legs(windings, duties, currents));
            return Applied::legs(bridge, windings, duties, bus);
        }
        let emf = self.machine.emf(&self.state);
        let off = |bus: f64| Applied::off(bridge, windings, currents, emf, bus);
        let drawn = off(self.bus.voltage).drawn(windings, currents);
        off(self.bus.in_mid_tick(drawn))
    }

    /// The charge that the bridge has taken from the bus: what dead time keeps from the windings, it does not take.
    fn drawn(&self, applied: &Applied, moved: &Moved) -> f64 {
        let kept = if applied.bus > 0.0 { moved.dead / applied.bus } else { 0.0 };
        applied.drawn(&self.machine.windings, moved.charge) - kept
    }

    /// What the sensors read now.
    pub fn sensors(&self) -> Sensors {
        self.sensors_with(self.terminals.levels(self.axis()))
    }

    fn sensors_with(&self, inputs: InputLevels) -> Sensors {
        Sensors {
            inputs,
            level_ages: self.terminals.ages,
            bus_voltage: self.bus_voltage,
            phase_currents: self.phase_currents,
        }
    }

    /// The switches of the axis.
    pub fn switches(&self) -> Switches {
        self.config.travel.switches(self.axis())
    }

    /// The outputs as the drive last set them.
    pub fn outputs(&self) -> OutputLevels {
        self.outputs
    }

    /// Holds input terminals on by hand, beside what the switches do, from the next step's start on.
    pub fn hold_inputs(&mut self, held_on: InputLevels) {
        self.terminals.held_on = held_on;
    }

    /// Gives the supply another voltage, from the next step on. The bus follows: upwards through the source's impedance within a tick or two,
    /// downwards as fast as the drive discharges it.
    pub fn set_supply(&mut self, supply: Millivolts) {
        self.config.supply = supply;
        self.feed();
    }

    fn feed(&mut self) {
        self.bus.source = volt(self.config.supply) + volt(self.faults.supply_offset);
    }

    /// Gives the load another torque in Nm against positive motion, from the next step on.
    pub fn set_load_torque(&mut self, torque: f64) {
        self.config.load.torque = torque;
        self.machine = machine(&self.config, &self.faults);
    }

    /// Breaks or mends, from the next step on.
    pub fn set_faults(&mut self, faults: Faults) {
        let before = self.stored().stored();
        self.faults = faults;
        self.machine = machine(&self.config, &faults);
        let motor = &mut self.state.motor;
        motor.currents = self.machine.windings.without(motor.currents, self.machine.windings.open);
        if faults.stuck_rotor {
            self.state = self.machine.stuck(self.state);
        }
        self.feed();
        self.account.hand += self.stored().stored() - before;
    }

    /// What is broken at present.
    pub fn faults(&self) -> Faults {
        self.faults
    }

    /// Moves the axis by hand; with the power stage on, the shaft then locks into the nearest electrical period.
    pub fn place(&mut self, position: Turns) {
        self.set_motor(MotorState {
            currents: self.state.motor.currents,
            ..at_rest(position)
        });
    }

    /// Gives the motor another state, and the load its speed and angle.
    pub fn set_motor(&mut self, motor: MotorState) {
        let before = self.stored().stored();
        self.state = State::of(motor);
        self.account.hand += self.stored().stored() - before;
    }
}

fn machine(config: &PlantConfig, faults: &Faults) -> Machine {
    Machine::new(&config.motor, config.bridge.in_series(config.motor.phases), &config.load, faults)
}

fn at_rest(position: Turns) -> MotorState {
    MotorState {
        turns: position.0,
        ..MotorState::default()
    }
}

fn volt(millivolts: Millivolts) -> f64 {
    f64::from(millivolts.0) / 1000.0
}
