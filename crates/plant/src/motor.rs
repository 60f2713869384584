//! The hybrid stepping motor: windings, torque, rotor.

use board::{ELECTRICAL_PERIODS_PER_TURN, TICK};

use crate::angle::sin_cos;

/// Electrical periods in a turn.
const PERIODS: f64 = ELECTRICAL_PERIODS_PER_TURN as f64;
/// The step of the integration in seconds: one control tick.
const STEP: f64 = TICK.0 as f64 * 1e-9;

/// Number of windings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phases {
    /// Two windings, a quarter of an electrical period apart, each between two legs of the bridge.
    Two,
    /// Three windings, a third of an electrical period apart, in star.
    Three,
}

/// What a data sheet says of a motor, in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorParameters {
    /// Number of windings.
    pub phases: Phases,
    /// Resistance of a winding in ohm.
    pub resistance: f64,
    /// Inductance of a winding in henry.
    pub inductance: f64,
    /// Peak of the sinusoidal phase current at which the motor has its holding torque, in ampere.
    pub rated_current: f64,
    /// Back-EMF of a winding in V s/rad of the shaft, and with two windings the torque constant in Nm/A.
    pub back_emf: f64,
    /// Peak of the detent torque in Nm.
    pub detent_torque: f64,
    /// Inertia of the rotor in kg m^2.
    pub inertia: f64,
    /// Coulomb friction in Nm.
    pub friction: f64,
    /// Viscous drag, iron losses included, in Nm s/rad.
    pub drag: f64,
}

impl MotorParameters {
    /// Torque at one ampere of the current vector's amplitude, in Nm/A.
    pub fn torque_constant(&self) -> f64 {
        match self.phases {
            Phases::Two => self.back_emf,
            Phases::Three => 1.5 * self.back_emf,
        }
    }

    /// Static torque at a current vector's amplitude, in Nm, without the detent's part.
    pub fn holding_torque(&self, current: f64) -> f64 {
        self.torque_constant() * current
    }
}

/// Currents, speed and angle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorState {
    /// Current vector in ampere: with two phases the currents of windings A and B, with three those after Clarke's transformation.
    pub currents: [f64; 2],
    /// Speed of the shaft in rad/s.
    pub speed: f64,
    /// Angle of the shaft in turns.
    pub turns: f64,
}

impl MotorState {
    fn after(self, slope: &Slope, time: f64) -> Self {
        Self {
            currents: [
                self.currents[0] + time * slope.currents[0],
                self.currents[1] + time * slope.currents[1],
            ],
            speed: self.speed + time * slope.speed,
            turns: self.turns + time * slope.turns,
        }
    }
}

#[derive(Clone, Copy)]
struct Slope {
    currents: [f64; 2],
    speed: f64,
    turns: f64,
}

impl MotorParameters {
    /// The state one tick later, with constant voltages over the windings (in V, as [`MotorState::currents`]) and a constant torque of the
    /// load (in Nm) against positive motion, and the load's inertia in kg m^2.
    pub fn step(&self, state: MotorState, voltages: [f64; 2], load: f64, load_inertia: f64) -> MotorState {
        let slope = |at: MotorState| self.slope(at, voltages, load, load_inertia);
        let k1 = slope(state);
        let k2 = slope(state.after(&k1, STEP / 2.0));
        let k3 = slope(state.after(&k2, STEP / 2.0));
        let k4 = slope(state.after(&k3, STEP));
        let mean = |part: fn(&Slope) -> f64| (part(&k1) + 2.0 * (part(&k2) + part(&k3)) + part(&k4)) / 6.0;
        let mean = Slope {
            currents: [mean(|k| k.currents[0]), mean(|k| k.currents[1])],
            speed: mean(|k| k.speed),
            turns: mean(|k| k.turns),
        };
        self.rub(state.after(&mean, STEP), load_inertia)
    }

    fn slope(&self, at: MotorState, voltages: [f64; 2], load: f64, load_inertia: f64) -> Slope {
        let (sine, cosine) = sin_cos(at.turns * PERIODS);
        let [a, b] = at.currents;
        let emf = self.back_emf * at.speed;
        // sin(4 x) from sin(x) and cos(x).
        let detent = self.detent_torque * 4.0 * sine * cosine * (cosine * cosine - sine * sine);
        let torque = self.torque_constant() * (b * cosine - a * sine) - detent - self.drag * at.speed - load;
        Slope {
            currents: [
                (voltages[0] - self.resistance * a + emf * sine) / self.inductance,
                (voltages[1] - self.resistance * b - emf * cosine) / self.inductance,
            ],
            speed: torque / (self.inertia + load_inertia),
            turns: at.speed / core::f64::consts::TAU,
        }
    }

    /// Coulomb friction, which takes speed away but never turns it round.
    fn rub(&self, state: MotorState, load_inertia: f64) -> MotorState {
        let most = self.friction * STEP / (self.inertia + load_inertia);
        let speed = if state.speed.abs() <= most {
            0.0
        } else {
            state.speed - most.copysign(state.speed)
        };
        MotorState {
            speed,
            turns: state.turns + (speed - state.speed) * STEP / 2.0 / core::f64::consts::TAU,
            ..state
        }
    }
}
