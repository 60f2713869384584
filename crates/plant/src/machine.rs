//! Motor and load in motion: one step of Runge and Kutta's fourth order for each tick, and Coulomb friction after it.
//!
//! With 50 us a step is within 0.001 degree and 1 mA of the exact solution while the rotor is in step; explicit Euler would lose
//! steps that the motor does not. Friction holds a resting shaft against any smaller torque, which no slope can express: the step is made
//! without it, and then it takes from the speed what it can take in a tick, at most down to rest.

use board::{ELECTRICAL_PERIODS_PER_TURN, TICK};

use crate::angle::sin_cos;
use crate::bridge::Applied;
use crate::faults::Faults;
use crate::load::{Load, LoadState};
use crate::motor::{MotorParameters, MotorState};
use crate::windings::{Vector, Windings, dot};

/// Electrical periods in a turn.
pub(crate) const PERIODS: f64 = ELECTRICAL_PERIODS_PER_TURN as f64;
/// The step of the integration in seconds: one control tick.
const STEP: f64 = TICK.0 as f64 * 1e-9;
const TURNS_PER_RADIAN: f64 = 1.0 / core::f64::consts::TAU;

/// Currents, speeds and angles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct State {
    pub(crate) motor: MotorState,
    /// With a rigid coupling the motor's speed and angle.
    pub(crate) load: LoadState,
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

/// Motor and load, their data ready for the integration.
#[derive(Clone, Debug)]
pub(crate) struct Machine {
    pub(crate) windings: Windings,
    power_factor: f64,
    back_emf: f64,
    detent_torque: f64,
    drag: f64,
    /// The inertia that the rotor's shaft has, with a rigidly coupled load's.
    inertia: f64,
    /// Its reciprocal; 0 for a rotor that is stuck.
    lightness: f64,
    /// The most speed that friction takes within a tick, from the rotor and from an elastically coupled load.
    rub: [f64; 2],
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
            back_emf: motor.back_emf,
            detent_torque: motor.detent_torque,
            drag,
            inertia,
            lightness,
            rub: [friction * STEP * lightness, load.friction * STEP * load_lightness],
            load_lightness,
            stiffness: coupling.map_or(0.0, |coupling| coupling.stiffness),
            damping: coupling.map_or(0.0, |coupling| coupling.damping),
            load: *load,
            elastic: coupling.is_some(),
        }
    }

    /// The state one tick later.
    pub(crate) fn step(&self, state: &State, applied: &Applied) -> (State, Moved) {
        let State { motor, load } = state;
        let [a, b] = motor.currents;
        let (mut after, mut moved) = if self.elastic {
            let (end, moved) = self.integrate([a, b, motor.speed, motor.turns, load.speed, load.turns], applied);
            let [a, b, speed, turns, load_speed, load_turns] = end;
            (State::new([a, b], (speed, turns), (load_speed, load_turns)), moved)
        } else {
            let (end, moved) = self.integrate([a, b, motor.speed, motor.turns], applied);
            let [a, b, speed, turns] = end;
            (State::new([a, b], (speed, turns), (speed, turns)), moved)
        };
        moved.friction = self.kinetic_energy(&after);
        rub(&mut after.motor.speed, &mut after.motor.turns, self.rub[0]);
        if self.elastic {
            rub(&mut after.load.speed, &mut after.load.turns, self.rub[1]);
        } else {
            (after.load.speed, after.load.turns) = (after.motor.speed, after.motor.turns);
        }
        moved.friction -= self.kinetic_energy(&after);
        (after, moved)
    }

    /// A step of the fourth order, over currents, speed and angle, and with six variables over the load's speed and angle.
    fn integrate<const N: usize>(&self, start: [f64; N], applied: &Applied) -> ([f64; N], Moved) {
        let ahead = |slope: &Slope<N>, time: f64| -> [f64; N] { core::array::from_fn(|at| start[at] + time * slope.of[at]) };
        let k1 = self.slope(&start, applied);
        let y2 = ahead(&k1, STEP / 2.0);
        let k2 = self.slope(&y2, applied);
        let y3 = ahead(&k2, STEP / 2.0);
        let k3 = self.slope(&y3, applied);
        let y4 = ahead(&k3, STEP);
        let k4 = self.slope(&y4, applied);
        let over = |[first, second, third, last]: [f64; 4]| (first + 2.0 * (second + third) + last) * (STEP / 6.0);
        let end = core::array::from_fn(|at| start[at] + over([k1.of[at], k2.of[at], k3.of[at], k4.of[at]]));
        let moved = Moved {
            charge: [0, 1].map(|at| over([start[at], y2[at], y3[at], y4[at]])),
            heat: over([k1.heat, k2.heat, k3.heat, k4.heat]) * self.power_factor,
            dead: over([k1.dead, k2.dead, k3.dead, k4.dead]) * self.power_factor,
            drag: over([k1.drag, k2.drag, k3.drag, k4.drag]),
            friction: 0.0,
        };
        (end, moved)
    }

    #[inline]
    fn slope<const N: usize>(&self, at: &[f64; N], applied: &Applied) -> Slope<N> {
        let currents = [at[0], at[1]];
        let (speed, turns) = (at[2], at[3]);
        let windings = &self.windings;
        let (sine, cosine) = sin_cos(turns * PERIODS);
        let pull = windings.emf.times([-sine, cosine]);
        let ohmic = windings.resistance.times(currents);
        let dead = applied.dead(windings, currents);
        let emf = self.back_emf * speed;
        let rest = |of: usize| applied.voltage[of] - dead[of] - ohmic[of] - emf * pull[of];
        let [a, b] = windings.inverse(applied.idle).times([rest(0), rest(1)]);
        let torque = self.power_factor * self.back_emf * dot(currents, pull) - self.detent(sine, cosine);
        let mut of = [0.0; N];
        let mut drag = self.drag * speed * speed;
        let taken = if N == 6 {
            let (load_speed, load_turns) = (at[4], at[5]);
            let damped = self.damping * (speed - load_speed);
            let coupled = self.stiffness * core::f64::consts::TAU * (turns - load_turns) + damped;
            drag += damped * (speed - load_speed) + self.load.drag * load_speed * load_speed;
            of[4] = (coupled - self.load.drag * load_speed - self.load.torque) * self.load_lightness;
            of[5] = load_speed * TURNS_PER_RADIAN;
            coupled
        } else {
            self.load.torque
        };
        of[0] = a;
        of[1] = b;
        of[2] = (torque - self.drag * speed - taken) * self.lightness;
        of[3] = speed * TURNS_PER_RADIAN;
        Slope {
            of,
            heat: dot(currents, ohmic),
            dead: dot(currents, dead),
            drag,
        }
    }

    /// The detent torque, sin(4 x) from sin(x) and cos(x).
    fn detent(&self, sine: f64, cosine: f64) -> f64 {
        let double = 2.0 * sine * cosine;
        self.detent_torque * 2.0 * double * (cosine * cosine - sine * sine)
    }

    /// The voltages that the turning rotor induces.
    pub(crate) fn emf(&self, state: &State) -> Vector {
        let (sine, cosine) = sin_cos(state.motor.turns * PERIODS);
        let emf = self.back_emf * state.motor.speed;
        self.windings.emf.times([-sine * emf, cosine * emf])
    }

    /// Torque that the windings and the magnets give the rotor, in Nm.
    pub(crate) fn torque(&self, state: &State) -> f64 {
        let (sine, cosine) = sin_cos(state.motor.turns * PERIODS);
        let pull = self.windings.emf.times([-sine, cosine]);
        self.power_factor * self.back_emf * dot(state.motor.currents, pull) - self.detent(sine, cosine)
    }

    /// Torque that the load takes from the shaft: the coupling's, or with a rigid one what acts on the load from outside.
    pub(crate) fn load_torque(&self, state: &State) -> f64 {
        if self.elastic {
            let State { motor, load } = state;
            self.stiffness * twist(state) + self.damping * (motor.speed - load.speed)
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
        0.5 * self.power_factor * dot(currents, self.windings.inductance.times(currents))
    }

    /// Energy in the detent and in the coupling's twist, in J.
    pub(crate) fn elastic_energy(&self, state: &State) -> f64 {
        let (sine, _) = sin_cos(state.motor.turns * (4.0 * PERIODS) * 0.5);
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
        self.load.torque * turns * core::f64::consts::TAU
    }

    /// The state when the rotor has seized.
    pub(crate) fn stuck(&self, mut state: State) -> State {
        state.motor.speed = 0.0;
        if !self.elastic {
            state.load.speed = 0.0;
        }
        state
    }

    /// Brings the load to rest at the end of its travel. With a rigid coupling, the rotor with it.
    pub(crate) fn stop_at(&self, state: &mut State, (lowest, highest): (f64, f64)) {
        let outwards = if state.load.turns < lowest {
            state.load.turns = lowest;
            -1.0
        } else if state.load.turns > highest {
            state.load.turns = highest;
            1.0
        } else {
            return;
        };
        if state.load.speed * outwards > 0.0 {
            state.load.speed = 0.0;
        }
        if !self.elastic {
            (state.motor.speed, state.motor.turns) = (state.load.speed, state.load.turns);
        }
    }
}

impl State {
    /// Everything at rest at a position.
    pub(crate) fn at_rest(turns: f64) -> Self {
        Self::new([0.0; 2], (0.0, turns), (0.0, turns))
    }

    fn new(currents: Vector, (speed, turns): (f64, f64), load: (f64, f64)) -> Self {
        Self {
            motor: MotorState { currents, speed, turns },
            load: LoadState {
                speed: load.0,
                turns: load.1,
            },
        }
    }
}

/// How far the shaft is ahead of the load, in rad.
fn twist(state: &State) -> f64 {
    (state.motor.turns - state.load.turns) * core::f64::consts::TAU
}

struct Slope<const N: usize> {
    of: [f64; N],
    heat: f64,
    dead: f64,
    drag: f64,
}

/// Coulomb friction, which takes speed away but never turns it round. The loss has built up evenly within the tick.
fn rub(speed: &mut f64, turns: &mut f64, most: f64) {
    let rubbed = if speed.abs() <= most { 0.0 } else { *speed - most.copysign(*speed) };
    *turns += (rubbed - *speed) * (STEP / 2.0 * TURNS_PER_RADIAN);
    *speed = rubbed;
}
