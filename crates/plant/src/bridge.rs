//! The bridge: four legs of two transistors, averaged over a PWM period.
//!
//! A leg's mean voltage is its duty's share of the bus. Three things take from it: the transistors' resistance; the dead time, in which both
//! transistors are off and the current chooses the diode, so that the leg loses its share in the direction of its current; and, with
//! all transistors off, the diodes' forward voltage.
//!
//! The dead time's error changes its sign with the current. Near zero it does so gradually, because the current's ripple crosses zero within
//! a period: over a band as wide as the mean ripple, which is a sixteenth of the bus voltage times the period over the inductance.
//!
//! With the transistors off, currents flow through the diodes against the bus and return their energy to it, until they are spent. A winding then stays
//! without current, unless the shaft is spun so fast that its back-EMF exceeds the bus: the diodes then rectify it.

use board::{Duty, LEG_COUNT, TICK, TICKS_PER_SECOND};

use crate::motor::Phases;
use crate::windings::{MOST, Set, Vector, Windings};

/// The PWM period, which is the control tick.
const PERIOD: f64 = TICK.0 as f64 * 1e-9;
/// PWM periods a second.
const FREQUENCY: f64 = TICKS_PER_SECOND as f64;
/// Current in ampere that is none.
const NONE: f64 = 1e-9;

/// What a bridge is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BridgeParameters {
    /// Resistance of one transistor that is on, in ohm, with its share of the current shunt.
    pub on_resistance: f64,
    /// Time between one transistor's going off and the other's going on, in seconds.
    pub dead_time: f64,
    /// Forward voltage of a diode in V.
    pub diode_drop: f64,
}

impl Default for BridgeParameters {
    /// Transistors for 80 V and 10 A in the size of this class: 30 mohm. 400 ns of dead time, as gate drivers of medium strength need: 0.8 % of
    /// the bus voltage for each leg. 0.8 V for a transistor's own diode.
    fn default() -> Self {
        Self {
            on_resistance: 0.03,
            dead_time: 400e-9,
            diode_drop: 0.8,
        }
    }
}

impl BridgeParameters {
    /// Resistance in series with a winding: two transistors are in its way with two phases, with three one for each wire.
    pub(crate) fn in_series(&self, phases: Phases) -> f64 {
        match phases {
            Phases::Two => 2.0 * self.on_resistance,
            Phases::Three => self.on_resistance,
        }
    }
}

/// What the bridge does to the windings throughout a tick.
#[derive(Clone, Debug)]
pub(crate) struct Applied {
    /// Voltages over the windings as a vector.
    pub(crate) voltage: Vector,
    /// The share of the bus voltage that dead time takes from each winding at most.
    lost: [f64; MOST],
    /// Windings without current.
    pub(crate) idle: Set,
    /// The direction of the current that each winding's diodes conduct; 0 without one, or with transistors on.
    diodes: [f64; MOST],
    /// The share of each winding's current that comes out of the bus.
    shares: [f64; MOST],
    /// Forward voltage of the diodes in a winding's way.
    drop: f64,
    /// Voltage of the bus.
    pub(crate) bus: f64,
    off: bool,
}

impl Applied {
    /// Voltages over the windings, from wherever they come.
    pub(crate) const fn voltage(voltage: Vector) -> Self {
        Self {
            voltage,
            lost: [0.0; MOST],
            idle: Set(0),
            diodes: [0.0; MOST],
            shares: [0.0; MOST],
            drop: 0.0,
            bus: 0.0,
            off: false,
        }
    }

    /// Transistors that switch.
    #[inline]
    pub(crate) fn legs(parameters: &BridgeParameters, windings: &Windings, duties: [Duty; LEG_COUNT], bus: f64) -> Self {
        let shares = leg_shares(windings.phases, duties);
        let [u, v, w] = shares;
        Self {
            voltage: windings.vector([u * bus, v * bus, w * bus]),
            lost: dead_shares(windings.phases, duties, parameters.dead_time * FREQUENCY),
            idle: windings.open,
            diodes: [0.0; MOST],
            shares,
            drop: 0.0,
            bus,
            off: false,
        }
    }

    /// All transistors off, while the windings have these currents and back-EMFs.
    pub(crate) fn off(parameters: &BridgeParameters, windings: &Windings, currents: Vector, emf: Vector, bus: f64) -> Self {
        let currents = windings.currents(currents);
        let emf = windings.currents(emf);
        let drop = parameters.diode_drop;
        let diodes = match windings.phases {
            Phases::Two => two_phase_diodes(currents, emf, bus + 2.0 * drop),
            Phases::Three => three_phase_diodes(currents, emf, bus, drop),
        };
        let mut idle = windings.open;
        for winding in (0..windings.count()).filter(|&winding| diodes[winding] == 0.0) {
            idle.insert(winding);
        }
        let (voltages, shares, drop) = match windings.phases {
            Phases::Two => (diodes.map(|sign| -sign * (bus + 2.0 * drop)), diodes.map(|sign| -sign), 2.0 * drop),
            Phases::Three => (
                diodes.map(|sign| bus * f64::from(sign < 0.0) - sign * drop),
                diodes.map(|sign| f64::from(sign < 0.0)),
                drop,
            ),
        };
        Self {
            voltage: windings.vector(voltages),
            lost: [0.0; MOST],
            idle,
            diodes,
            shares,
            drop,
            bus,
            off: true,
        }
    }

    /// Voltage that is lost to dead time.
    #[inline(always)]
    pub(crate) fn dead(&self, windings: &Windings, currents: Vector) -> Vector {
        let lost = |winding: usize, current: f64| {
            let rippled = windings.ripple[winding] * current;
            let most = self.bus;
            let rippled = if rippled < most { rippled } else { most };
            self.lost[winding] * if rippled > -most { rippled } else { -most }
        };
        match windings.phases {
            Phases::Two => [lost(0, currents[0]), lost(1, currents[1])],
            Phases::Three => {
                let [u, v, w] = windings.currents(currents);
                windings.vector([lost(0, u), lost(1, v), lost(2, w)])
            }
        }
    }

    /// The current out of the bus, or the charge, that belongs to a vector of currents or charges.
    pub(crate) fn drawn(&self, windings: &Windings, vector: Vector) -> f64 {
        sum(windings.currents(vector), self.shares)
    }

    /// Ends the currents that diodes have let through zero within the tick. Returns what is left of them, and of the windings' charges.
    pub(crate) fn spend(&self, windings: &Windings, before: Vector, after: Vector, charge: Vector) -> Spent {
        let (before, ends) = (windings.currents(before), windings.currents(after));
        let mut charges = windings.currents(charge);
        let mut spent = windings.open;
        for winding in 0..windings.count() {
            let sign = self.diodes[winding];
            if sign * ends[winding] <= NONE {
                let (start, end) = (before[winding], ends[winding]);
                let fallen = start - end;
                charges[winding] = if fallen * sign > NONE {
                    0.5 * PERIOD * start * start / fallen
                } else {
                    0.0
                };
                spent.insert(winding);
            }
        }
        Spent {
            currents: windings.without(after, spent),
            drawn: sum(charges, self.shares),
            heat: self.drop * charges.iter().map(|charge| charge.abs()).sum::<f64>(),
        }
    }

    /// The current that switching transistors take from the bus.
    pub(crate) fn drawn_by_legs(windings: &Windings, duties: [Duty; LEG_COUNT], currents: Vector) -> f64 {
        sum(windings.currents(currents), leg_shares(windings.phases, duties))
    }

    /// Whether the transistors are off.
    pub(crate) fn is_off(&self) -> bool {
        self.off
    }
}

/// What a tick with the transistors off has left and moved.
pub(crate) struct Spent {
    pub(crate) currents: Vector,
    /// Charge out of the bus.
    pub(crate) drawn: f64,
    /// Energy lost in the diodes.
    pub(crate) heat: f64,
}

fn sum(currents: [f64; MOST], shares: [f64; MOST]) -> f64 {
    currents[0] * shares[0] + currents[1] * shares[1] + currents[2] * shares[2]
}

fn share(duty: Duty) -> f64 {
    f64::from(duty.0) * (1.0 / 65_536.0)
}

/// The share of the bus voltage over each winding.
#[inline]
fn leg_shares(phases: Phases, [u, v, w, x]: [Duty; LEG_COUNT]) -> [f64; MOST] {
    let [u, v, w, x] = [share(u), share(v), share(w), share(x)];
    match phases {
        Phases::Two => [u - v, w - x, 0.0],
        Phases::Three => [u, v, w],
    }
}

/// The share of the bus voltage that dead time takes from each winding. A leg that hardly switches, or not at all, loses no more than it has.
#[inline]
fn dead_shares(phases: Phases, [u, v, w, x]: [Duty; LEG_COUNT], most: f64) -> [f64; MOST] {
    let lost = |duty: Duty| {
        let switched = share(Duty(duty.0.min(u16::MAX - duty.0)));
        if switched < most { switched } else { most }
    };
    let [u, v, w, x] = [lost(u), lost(v), lost(w), lost(x)];
    match phases {
        Phases::Two => [u + v, w + x, 0.0],
        Phases::Three => [u, v, w],
    }
}

/// The direction of a current, 0 for none.
fn sign(current: f64) -> f64 {
    if current.abs() <= NONE { 0.0 } else { 1.0_f64.copysign(current) }
}

/// Each winding has its own four diodes. Without current, they conduct if the back-EMF exceeds the bus; the current then flows with it.
fn two_phase_diodes(currents: [f64; MOST], emf: [f64; MOST], threshold: f64) -> [f64; MOST] {
    core::array::from_fn(|winding| match sign(currents[winding]) {
        0.0 if emf[winding].abs() > threshold => -1.0_f64.copysign(emf[winding]),
        sign => sign,
    })
}

/// Six diodes, as in a rectifier: without current, the legs of the highest and the lowest back-EMF conduct if these exceed the bus
/// together. A third leg joins two when its terminal is driven beyond the bus.
fn three_phase_diodes(currents: [f64; MOST], emf: [f64; MOST], bus: f64, drop: f64) -> [f64; MOST] {
    let mut signs = currents.map(sign);
    let free = |signs: &[f64; MOST]| (0..MOST).filter(|&leg| signs[leg] == 0.0).count();
    if free(&signs) >= 2 {
        signs = [0.0; MOST];
        let by_emf = |a: &usize, b: &usize| emf[*a].total_cmp(&emf[*b]);
        let highest = (0..MOST).max_by(by_emf).unwrap_or(0);
        let lowest = (0..MOST).min_by(by_emf).unwrap_or(0);
        if emf[highest] - emf[lowest] > bus + 2.0 * drop {
            (signs[highest], signs[lowest]) = (-1.0, 1.0);
        }
    } else if free(&signs) == 1 {
        for leg in (0..MOST).filter(|&leg| currents[leg].abs() <= NONE) {
            // Half the bus at the star, as the other two legs are at its two ends, and their back-EMFs are together the opposite of this.
            let terminal = 0.5 * bus + 1.5 * emf[leg];
            signs[leg] = f64::from(terminal < -drop) - f64::from(terminal > bus + drop);
        }
    }
    signs
}
