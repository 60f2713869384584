//! Motor and load in motion: a step of Runge and Kutta's fourth order for each tick, at high speed two, and Coulomb friction after it.
//!
//! What is integrated is not the windings' currents but their flux, that of the magnets included, whose slope is the voltage less the ohmic one: the
//! back-EMF, which makes the currents change fastest, needs no integration then. The result is within 0.001 degree and 1 mA of the
//! exact solution while the rotor is in step; explicit Euler would lose steps that the motor does not.
//!
//! Friction holds a resting shaft against any smaller torque, which no slope can express: the step is made
//! without it, and then it takes from the speed what it can take in a tick, at most down to rest.

mod integration;

use core::f64::consts::TAU;

use board::{ELECTRICAL_PERIODS_PER_TURN, TICK};

use crate::angle::Angle;
use crate::bridge::Applied;
use crate::faults::Faults;
use crate::load::{Load, LoadState};
use crate::motor::{MotorParameters, MotorState};
use crate::windings::{Coils, Linear, Set, Vector, Windings, dot};
use integration::{Integration, Variables};

/// Electrical periods in a turn.
pub(crate) const PERIODS: f64 = ELECTRICAL_PERIODS_PER_TURN as f64;
/// The step of the integration in seconds: one control tick.
const STEP: f64 = TICK.0 as f64 * 1e-9;
/// Speed in rad/s, 15 turns a second, from which on a tick takes two steps: the rotor's electrical angle then turns by a quarter of a radian a tick, and
/// the error grows with the fourth power of that.
const FAST: f64 = 15.0 * TAU;
const TURNS_PER_RADIAN: f64 = 1.0 / TAU;

/// Currents, speeds and angles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct State {
    pub(crate) motor: MotorState,
    /// With a rigid coupling the motor's speed and angle.
    pub(crate) load: LoadState,
    /// The shaft's electrical angle where the last step has ended.
    ended: Angle,
}

impl MotorParameters {
    /// The motor by itself, for a power stage of one's own: its state one control tick later, with constant voltages over the windings (in V, as
    /// [`MotorState::currents`]), a torque of the load in Nm against positive motion, and the load's inertia in kg m^2.
    pub fn step(&self, state: MotorState, voltages: [f64; 2], torque: f64, inertia: f64) -> MotorState {
        let load = Load {
            torque,
            ..Load::inertia(inertia)
        };
        let machine = Machine::new(self, 0.0, &load, &Faults::default());
        let mut state = State::of(state);
        machine.step(&mut state, &Applied::voltage(voltages));
        state.motor
    }
}

/// What a step has moved.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Moved {
    /// Charge through the windings, as a vector.
    pub(crate) charge: Vector,
    /// Heat in windings and transistors in J.
    pub(crate) heat: f64,
    /// Energy that the windings have not got because of dead time, in J.
    pub(crate) dead: f64,
    /// Energy taken by drag and by the coupling's damping in J.
    pub(crate) drag: f64,
    /// Energy taken by Coulomb friction in J.
    pub(crate) friction: f64,
}

impl Moved {
    fn and(self, other: &Self) -> Self {
        Self {
            charge: [self.charge[0] + other.charge[0], self.charge[1] + other.charge[1]],
            heat: self.heat + other.heat,
            dead: self.dead + other.dead,
            drag: self.drag + other.drag,
            friction: self.friction + other.friction,
        }
    }
}

/// Motor and load, their data ready for the integration.
#[derive(Clone, Debug)]
pub(crate) struct Machine {
    pub(crate) windings: Windings,
    power_factor: f64,
    detent_torque: f64,
    drag: f64,
    /// The inertia that the rotor's shaft has, with a rigidly coupled load's.
    inertia: f64,
    /// Its reciprocal; 0 for a rotor that is stuck.
    lightness: f64,
    /// What friction takes from the speed in rad/s^2, of the rotor and of an elastically coupled load.
    friction: [f64; 2],
    /// Reciprocal of the inertia of an elastically coupled load.
    load_lightness: f64,
    stiffness: f64,
    damping: f64,
    load: Load,
    elastic: bool,
}

impl Machine {
    pub(crate) fn new(motor: &MotorParameters, in_series: f64, load: &Load, faults: &Faults) -> Self {
        let coupling = load.coupling.filter(|coupling| coupling.is_elastic(motor.inertia, load.inertia));
        let (inertia, friction, drag) = match coupling {
            Some(_) => (motor.inertia, motor.friction, motor.drag),
            None => (motor.inertia + load.inertia, motor.friction + load.friction, motor.drag + load.drag),
        };
        let lightness = if faults.stuck_rotor { 0.0 } else { 1.0 / inertia };
        let load_lightness = if coupling.is_some() { 1.0 / load.inertia } else { 0.0 };
        Self {
            windings: Windings::new(motor, in_series, faults),
            power_factor: motor.phases.power_factor(),
            detent_torque: motor.detent_torque,
            drag,
            inertia,
            lightness,
            friction: [friction * lightness, load.friction * load_lightness],
            load_lightness,
            stiffness: coupling.map_or(0.0, |coupling| coupling.stiffness),
            damping: coupling.map_or(0.0, |coupling| coupling.damping),
            load: *load,
            elastic: coupling.is_some(),
        }
    }

    /// Lets a tick pass.
    pub(crate) fn step(&self, state: &mut State, applied: &Applied) -> Moved {
        match self.windings.alike(applied.idle) {
            Some(coils) => self.step_with(coils, state, applied),
            None => self.step_with(&self.windings.coils(applied.idle), state, applied),
        }
    }

    fn step_with<M: Linear>(&self, coils: &Coils<M>, state: &mut State, applied: &Applied) -> Moved {
        if state.motor.speed.abs() < FAST {
            return self.advance(coils, state, applied, 1.0);
        }
        let first = self.advance(coils, state, applied, 0.5);
        let second = self.advance(coils, state, applied, 0.5);
        first.and(&second)
    }

    /// Lets a part of a tick pass.
    fn advance<M: Linear>(&self, coils: &Coils<M>, state: &mut State, applied: &Applied, part: f64) -> Moved {
        let (before, time) = (*state, part * STEP);
        let angle = before.angle();
        let flux = coils.flux(before.motor.currents, &angle);
        let integration = Integration {
            machine: self,
            coils,
            applied,
        };
        let (motor, load) = (&mut state.motor, &mut state.load);
        let (flux, passed) = if self.elastic {
            let (speeds, turns) = ([motor.speed, load.speed], [motor.turns, load.turns]);
            let (end, passed) = integration.step(&Variables { flux, speeds, turns }, &angle, time);
            ([motor.speed, load.speed], [motor.turns, load.turns]) = (end.speeds, end.turns);
            (end.flux, passed)
        } else {
            let (speeds, turns) = ([motor.speed], [motor.turns]);
            let (end, passed) = integration.step(&Variables { flux, speeds, turns }, &angle, time);
            ([motor.speed], [motor.turns]) = (end.speeds, end.turns);
            (load.speed, load.turns) = (motor.speed, motor.turns);
            (end.flux, passed)
        };
        let drag = self.dragged(&before, state) * time;
        let friction = self.rub(state, time);
        state.ended = Angle::new(state.motor.turns * PERIODS);
        state.motor.currents = coils.currents(flux, &state.ended);
        Moved {
            charge: passed.charge,
            heat: passed.heat * self.power_factor,
            dead: passed.dead * self.power_factor,
            drag,
            friction,
        }
    }

    /// Power that drag and the coupling's damping take, as if speeds changed evenly.
    fn dragged(&self, state: &State, after: &State) -> f64 {
        let square = |before: f64, after: f64| (before * before + before * after + after * after) * (1.0 / 3.0);
        let rotor = self.drag * square(state.motor.speed, after.motor.speed);
        if self.elastic {
            let twisting = square(state.motor.speed - state.load.speed, after.motor.speed - after.load.speed);
            rotor + self.damping * twisting + self.load.drag * square(state.load.speed, after.load.speed)
        } else {
            rotor
        }
    }

    /// Coulomb friction on rotor and load; the energy that it takes.
    fn rub(&self, state: &mut State, time: f64) -> f64 {
        let motor = rub(&mut state.motor.speed, &mut state.motor.turns, self.friction[0], time);
        if self.elastic {
            let load = rub(&mut state.load.speed, &mut state.load.turns, self.friction[1], time);
            0.5 * (self.inertia * motor + self.load.inertia * load)
        } else {
            (state.load.speed, state.load.turns) = (state.motor.speed, state.motor.turns);
            0.5 * self.inertia * motor
        }
    }

    /// The detent torque, sin(4 x) from sin(x) and cos(x).
    fn detent(&self, &Angle { sine, cosine, .. }: &Angle) -> f64 {
        4.0 * self.detent_torque * (sine * cosine) * (cosine * cosine - sine * sine)
    }

    /// The voltages that the turning rotor induces.
    pub(crate) fn emf(&self, state: &State) -> Vector {
        let Angle { sine, cosine, .. } = state.angle();
        let speed = PERIODS * state.motor.speed;
        self.windings.coils(Set::NONE).magnet.times([-sine * speed, cosine * speed])
    }

    /// Torque that the windings and the magnets give the rotor, in Nm.
    pub(crate) fn torque(&self, state: &State) -> f64 {
        let angle = state.angle();
        self.windings.coils(Set::NONE).torque(state.motor.currents, &angle) - self.detent(&angle)
    }

    /// Torque that the load takes from the shaft: the coupling's, or with a rigid one what acts on the load from outside.
    pub(crate) fn load_torque(&self, state: &State) -> f64 {
        if self.elastic {
            self.stiffness * twist(state) + self.damping * (state.motor.speed - state.load.speed)
        } else {
            self.load.torque
        }
    }

    /// Energy of all that turns, in J.
    pub(crate) fn kinetic_energy(&self, state: &State) -> f64 {
        let load = if self.elastic {
            self.load.inertia * state.load.speed * state.load.speed
        } else {
            0.0
        };
        0.5 * (self.inertia * state.motor.speed * state.motor.speed + load)
    }

    /// Energy in the windings' field, in J.
    pub(crate) fn magnetic_energy(&self, currents: Vector) -> f64 {
        0.5 * self.power_factor * dot(currents, self.windings.coils(Set::NONE).inductance.times(currents))
    }

    /// Energy in the detent and in the coupling's twist, in J.
    pub(crate) fn elastic_energy(&self, state: &State) -> f64 {
        let sine = Angle::new(state.motor.turns * (4.0 * PERIODS) * 0.5).sine;
        // The integral of sin(4 x), from 0: (1 - cos(4 x)) / 4.
        let detent = self.detent_torque / (2.0 * PERIODS) * sine * sine;
        detent
            + if self.elastic {
                0.5 * self.stiffness * twist(state) * twist(state)
            } else {
                0.0
            }
    }

    /// Energy that the load's torque has taken on a way in turns, in J.
    pub(crate) fn work(&self, turns: f64) -> f64 {
        self.load.torque * turns * TAU
    }

    /// All energy that an end stop can take, in J: a weight that pulls against the stop gains none by what the stop holds it back.
    pub(crate) fn mechanical_energy(&self, state: &State) -> f64 {
        self.kinetic_energy(state) + self.elastic_energy(state) + self.work(state.load.turns)
    }

    /// The state when the rotor has seized.
    pub(crate) fn stuck(&self, mut state: State) -> State {
        state.motor.speed = 0.0;
        if !self.elastic {
            state.load.speed = 0.0;
        }
        state
    }

    /// Brings the load to rest at the end of its travel. With a rigid coupling, the rotor with it. The energy that the end takes.
    pub(crate) fn stop_at(&self, state: &mut State, (lowest, highest): (f64, f64)) -> f64 {
        let (end, outwards) = if state.load.turns < lowest {
            (lowest, -1.0)
        } else if state.load.turns > highest {
            (highest, 1.0)
        } else {
            return 0.0;
        };
        let before = self.mechanical_energy(state);
        state.load.turns = end;
        if state.load.speed * outwards > 0.0 {
            state.load.speed = 0.0;
        }
        if !self.elastic {
            (state.motor.speed, state.motor.turns) = (state.load.speed, state.load.turns);
        }
        before - self.mechanical_energy(state)
    }
}

impl<M: Linear> Coils<M> {
    /// The flux through the windings, that of the magnets included.
    fn flux(&self, currents: Vector, angle: &Angle) -> Vector {
        let ([a, b], magnet) = (self.inductance.times(currents), self.magnet.times([angle.cosine, angle.sine]));
        [a + magnet[0], b + magnet[1]]
    }

    /// The currents that belong to a flux.
    #[inline]
    fn currents(&self, flux: Vector, angle: &Angle) -> Vector {
        let magnet = self.magnet.times([angle.cosine, angle.sine]);
        self.inverse.times([flux[0] - magnet[0], flux[1] - magnet[1]])
    }

    /// What the currents give the rotor, in Nm.
    #[inline]
    fn torque(&self, currents: Vector, angle: &Angle) -> f64 {
        let [a, b] = self.torque.times(currents);
        b * angle.cosine - a * angle.sine
    }
}

impl State {
    /// The motor in a state, and the load with it.
    pub(crate) fn of(motor: MotorState) -> Self {
        let MotorState { speed, turns, .. } = motor;
        Self {
            motor,
            load: LoadState { speed, turns },
            ended: Angle::ZERO,
        }
    }

    /// Electrical angle of the shaft.
    fn angle(&self) -> Angle {
        self.ended.at(self.motor.turns * PERIODS)
    }
}

/// How far the shaft is ahead of the load, in rad.
fn twist(state: &State) -> f64 {
    (state.motor.turns - state.load.turns) * TAU
}

/// Coulomb friction, which takes speed away but never turns it round. The loss has built up evenly within the time. By how much the speed's
/// square falls.
fn rub(speed: &mut f64, turns: &mut f64, deceleration: f64, time: f64) -> f64 {
    let (before, most) = (*speed, deceleration * time);
    *speed = if before.abs() <= most {
        0.0
    } else {
        before - most.copysign(before)
    };
    *turns += (*speed - before) * (time * 0.5 * TURNS_PER_RADIAN);
    before * before - *speed * *speed
}
