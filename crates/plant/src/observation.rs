//! What only a simulation can see.

use board::ElectricalAngle;

use crate::energy::EnergyAccount;
use crate::load::LoadState;
use crate::machine::PERIODS;
use crate::motor::{MotorState, Phases};
use crate::travel::Turns;
use crate::{Plant, PlantConfig, angle};

impl Plant {
    /// Where the shaft really is, which an open-loop drive cannot know.
    pub fn shaft(&self) -> Turns {
        Turns(self.state.motor.turns)
    }

    /// Where the axis is, with its switches and stops: at the shaft's position, or behind an elastic coupling.
    pub fn axis(&self) -> Turns {
        Turns(self.state.load.turns)
    }

    /// The motor.
    pub fn motor(&self) -> MotorState {
        self.state.motor
    }

    /// The load behind the coupling.
    pub fn load(&self) -> LoadState {
        self.state.load
    }

    /// What the plant is made of, with the supply's and the load's present values.
    pub fn config(&self) -> &PlantConfig {
        &self.config
    }

    /// By how much the shaft lags behind a commanded electrical angle, in electrical periods from -0.5 to 0.5: at a quarter the motor gives all
    /// its torque, beyond it falls out of step.
    pub fn lag(&self, commanded: ElectricalAngle) -> f64 {
        angle::lag(commanded, self.state.motor.turns * PERIODS)
    }

    /// Currents out of the legs A+ and B+ in ampere, before any converter.
    pub fn currents(&self) -> [f64; 2] {
        let [u, v, w] = self.machine.windings.currents(self.state.motor.currents);
        match self.config.motor.phases {
            Phases::Two => [u, v],
            Phases::Three => [u, w],
        }
    }

    /// Voltage of the bus in V.
    pub fn bus_voltage(&self) -> f64 {
        self.bus.voltage
    }

    /// Current out of the supply in ampere, as a mean over the last tick.
    pub fn supply_current(&self) -> f64 {
        self.bus.current
    }

    /// Torque that windings and magnets give the rotor, in Nm, the detent torque included.
    pub fn torque(&self) -> f64 {
        self.machine.torque(&self.state)
    }

    /// Torque that the load takes from the shaft, in Nm: that of an elastic coupling, or with a rigid one the external torque.
    pub fn load_torque(&self) -> f64 {
        self.machine.load_torque(&self.state)
    }

    /// Where the energy has gone since power-on.
    pub fn energy(&self) -> EnergyAccount {
        let stored = self.stored();
        EnergyAccount {
            magnetic: stored.magnetic,
            kinetic: stored.kinetic,
            elastic: stored.elastic,
            capacitor: stored.capacitor,
            ..self.account
        }
    }

    /// The present stores and nothing else.
    pub(crate) fn stored(&self) -> EnergyAccount {
        EnergyAccount {
            magnetic: self.machine.magnetic_energy(self.state.motor.currents),
            kinetic: self.machine.kinetic_energy(&self.state),
            elastic: self.machine.elastic_energy(&self.state),
            capacitor: self.bus.energy(),
            ..EnergyAccount::default()
        }
    }
}
