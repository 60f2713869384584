//! Motor and load in motion: a step of Runge and Kutta's fourth order for each tick, at high speed two, and Coulomb friction after it.
//!
//! What is integrated is not the windings' currents but their flux, that of the magnets included, whose slope is the voltage less the ohmic one: the
//! back-EMF, which makes the currents change fastest, needs no integration then. The result is within 0.001 degree and 1 mA of the
//! exact solution while the rotor is in step; explicit Euler would lose steps that the motor does not.
//!
//! Friction holds a resting shaft against any smaller torque, which no slope can express: the step is made
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
/// Speed in rad/s, 15 turns a second, from which on a tick takes two steps: the rotor's electrical angle then turns by a quarter of a radian a tick, and
/// the error grows with the fourth power of that.
const FAST: f64 = 15.0 * core::f64::consts::TAU;
const TURNS_PER_RADIAN: f64 = 1.0 / core::f64::consts::TAU;

/// Currents, speeds and angles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct State {
    pub(crate) motor: MotorState,
    /// With a rigid coupling the motor's speed and angle.
    pub(crate) load: LoadState,
    /// The shaft's angle in turns, with its electrical sine and cosine, where the last step has ended.
    ended: (f64, f64, f64),
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
        machine.step(&State::of(state), &Applied::voltage(voltages)).0.motor
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
    back_emf: f64,
    torque_constant: f64,
    /// Flux of the magnets through a winding that they face, in V s.
    flux: f64,
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
            back_emf: motor.back_emf,
            torque_constant: motor.torque_constant(),
            flux: motor.back_emf / PERIODS,
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

    /// The state one tick later.
    pub(crate) fn step(&self, state: &State, applied: &Applied) -> (State, Moved) {
        if state.motor.speed.abs() < FAST {
            return self.advance(state, applied, STEP);
        }
        let (middle, first) = self.advance(state, applied, STEP / 2.0);
        let (end, second) = self.advance(&middle, applied, STEP / 2.0);
        (end, first.and(&second))
    }

    fn advance(&self, state: &State, applied: &Applied, time: f64) -> (State, Moved) {
        let (motor, load) = (&state.motor, &state.load);
        let direction = state.direction();
        let [a, b] = self.windings.inductance.times(motor.currents);
        let [of_magnet_a, of_magnet_b] = self.magnet(direction);
        let (a, b) = (a + of_magnet_a, b + of_magnet_b);
        let (flux, mut after, mut moved) = if self.elastic {
            let start = [a, b, motor.speed, motor.turns, load.speed, load.turns];
            let ([a, b, speed, turns, load_speed, load_turns], moved) = self.integrate(start, direction, applied, time);
            ([a, b], State::new((speed, turns), (load_speed, load_turns)), moved)
        } else {
            let ([a, b, speed, turns], moved) = self.integrate([a, b, motor.speed, motor.turns], direction, applied, time);
            ([a, b], State::new((speed, turns), (speed, turns)), moved)
        };
        moved.friction = self.rub(&mut after, time);
        let (sine, cosine) = sin_cos(after.motor.turns * PERIODS);
        after.ended = (after.motor.turns, sine, cosine);
        after.motor.currents = self.currents(flux, (sine, cosine), applied);
        (after, moved)
    }

    /// The magnets' flux through the windings.
    fn magnet(&self, (sine, cosine): (f64, f64)) -> Vector {
        self.windings.emf.times([self.flux * cosine, self.flux * sine])
    }

    /// The currents that belong to a flux.
    #[inline]
    fn currents(&self, flux: Vector, direction: (f64, f64), applied: &Applied) -> Vector {
        let magnet = self.magnet(direction);
        self.windings
            .inverse(applied.idle)
            .times([flux[0] - magnet[0], flux[1] - magnet[1]])
    }

    /// Coulomb friction on rotor and load; the energy that it takes.
    fn rub(&self, state: &mut State, time: f64) -> f64 {
        let before = self.kinetic_energy(state);
        rub(&mut state.motor.speed, &mut state.motor.turns, self.friction[0], time);
        if self.elastic {
            rub(&mut state.load.speed, &mut state.load.turns, self.friction[1], time);
        } else {
            (state.load.speed, state.load.turns) = (state.motor.speed, state.motor.turns);
        }
        before - self.kinetic_energy(state)
    }

    /// A step of the fourth order, over flux, speed and angle, and with six variables over the load's speed and angle.
    fn integrate<const N: usize>(&self, start: [f64; N], direction: (f64, f64), applied: &Applied, step: f64) -> ([f64; N], Moved) {
        let ahead = |slope: &Slope<N>, time: f64| -> [f64; N] { core::array::from_fn(|at| start[at] + time * slope.of[at]) };
        let slope = |at: [f64; N]| self.slope(&at, sin_cos(at[3] * PERIODS), applied);
        let k1 = self.slope(&start, direction, applied);
        let k2 = slope(ahead(&k1, step / 2.0));
        let k3 = slope(ahead(&k2, step / 2.0));
        let k4 = slope(ahead(&k3, step));
        let sixth = step * (1.0 / 6.0);
        let over = |part: &dyn Fn(&Slope<N>) -> f64| (part(&k1) + 2.0 * (part(&k2) + part(&k3)) + part(&k4)) * sixth;
        let end = core::array::from_fn(|at| start[at] + over(&|slope| slope.of[at]));
        let moved = Moved {
            charge: [over(&|slope| slope.currents[0]), over(&|slope| slope.currents[1])],
            heat: over(&|slope| slope.heat) * self.power_factor,
            dead: over(&|slope| slope.dead) * self.power_factor,
            drag: over(&|slope| slope.drag),
            friction: 0.0,
        };
        (end, moved)
    }

    #[inline]
    fn slope<const N: usize>(&self, at: &[f64; N], direction: (f64, f64), applied: &Applied) -> Slope<N> {
        let (speed, turns) = (at[2], at[3]);
        let windings = &self.windings;
        let currents = self.currents([at[0], at[1]], direction, applied);
        let ohmic = windings.resistance.times(currents);
        let dead = applied.dead(windings, currents);
        let torque = self.torque_of(currents, direction);
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
        of[0] = applied.voltage[0] - dead[0] - ohmic[0];
        of[1] = applied.voltage[1] - dead[1] - ohmic[1];
        of[2] = (torque - self.drag * speed - taken) * self.lightness;
        of[3] = speed * TURNS_PER_RADIAN;
        Slope {
            of,
            currents,
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
        let (sine, cosine) = state.direction();
        let emf = self.back_emf * state.motor.speed;
        self.windings.emf.times([-sine * emf, cosine * emf])
    }

    /// Torque that the windings and the magnets give the rotor, in Nm.
    pub(crate) fn torque(&self, state: &State) -> f64 {
        self.torque_of(state.motor.currents, state.direction())
    }

    fn torque_of(&self, currents: Vector, (sine, cosine): (f64, f64)) -> f64 {
        let pull = self.windings.emf.times([-sine, cosine]);
        self.torque_constant * dot(currents, pull) - self.detent(sine, cosine)
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
    /// The motor in a state, and the load with it.
    pub(crate) fn of(motor: MotorState) -> Self {
        Self {
            motor,
            ..Self::new((motor.speed, motor.turns), (motor.speed, motor.turns))
        }
    }

    /// Speeds and angles, and no current.
    fn new((speed, turns): (f64, f64), load: (f64, f64)) -> Self {
        let (sine, cosine) = (0.0, 1.0);
        Self {
            motor: MotorState {
                currents: [0.0; 2],
                speed,
                turns,
            },
            load: LoadState {
                speed: load.0,
                turns: load.1,
            },
            ended: (0.0, sine, cosine),
        }
    }

    /// Electrical sine and cosine of the shaft's angle.
    fn direction(&self) -> (f64, f64) {
        let (turns, sine, cosine) = self.ended;
        if turns == self.motor.turns {
            (sine, cosine)
        } else {
            sin_cos(self.motor.turns * PERIODS)
        }
    }
}

/// How far the shaft is ahead of the load, in rad.
fn twist(state: &State) -> f64 {
    (state.motor.turns - state.load.turns) * core::f64::consts::TAU
}

struct Slope<const N: usize> {
    of: [f64; N],
    currents: Vector,
    heat: f64,
    dead: f64,
    drag: f64,
}

/// Coulomb friction, which takes speed away but never turns it round. The loss has built up evenly within the time.
fn rub(speed: &mut f64, turns: &mut f64, deceleration: f64, time: f64) {
    let most = deceleration * time;
    let rubbed = if speed.abs() <= most { 0.0 } else { *speed - most.copysign(*speed) };
    *turns += (rubbed - *speed) * (time * 0.5 * TURNS_PER_RADIAN);
    *speed = rubbed;
}
