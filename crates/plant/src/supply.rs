//! The supply: a source, its impedance, and the bus capacitor.
//!
//! A power supply with a diode at its output: it feeds the bus, but takes nothing back. What a braking motor returns therefore stays in the
//! capacitor and pumps the bus up: the energy of 3 J in a rotating mass takes 1000 uF from 36 to 85 V. Nothing but the drive's own consumption brings it
//! down again.

use board::{TICK, TICKS_PER_SECOND};

const STEP: f64 = TICK.0 as f64 * 1e-9;
const STEPS_PER_SECOND: f64 = TICKS_PER_SECOND as f64;

/// What is between the source's voltage and the bridge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupplyParameters {
    /// Resistance of source, cable and plugs in ohm.
    pub impedance: f64,
    /// The bus capacitor in farad.
    pub capacitance: f64,
    /// What the drive itself takes in ampere, for its processor, its network and its gate drivers.
    pub consumption: f64,
}

impl Default for SupplyParameters {
    /// A switched supply behind some metres of 1.5 mm^2 cable: 0.1 ohm. 470 uF, as much as fits a drive of this size and common in its
    /// class. 80 mA: 3 W at 36 V, of which the network's two transceivers and the slave controller take two thirds.
    fn default() -> Self {
        Self {
            impedance: 0.1,
            capacitance: 470e-6,
            consumption: 0.08,
        }
    }
}

/// A span of time, and in it the bus's way to where it settles.
#[derive(Clone, Copy, Debug)]
struct Span {
    /// By how much a current of 1 A discharges the capacitor in V.
    discharge: f64,
    /// The span in time constants of impedance and capacitor.
    constants: f64,
    /// The part that is left of a deviation.
    left: f64,
}

impl Span {
    fn new(seconds: f64, parameters: &SupplyParameters) -> Self {
        let constants = seconds / (parameters.impedance * parameters.capacitance);
        Self {
            discharge: seconds / parameters.capacitance,
            constants,
            left: decay(constants),
        }
    }
}

/// The exponential of `-x`, to 3e-4, by its series for a quarter of `x`.
fn decay(x: f64) -> f64 {
    let x = x / 4.0;
    let quarter = 1.0 / (1.0 + x * (1.0 + x / 2.0 * (1.0 + x / 3.0 * (1.0 + x / 4.0))));
    let half = quarter * quarter;
    half * half
}

/// The bus.
#[derive(Clone, Debug)]
pub(crate) struct Bus {
    parameters: SupplyParameters,
    tick: Span,
    half_tick: Span,
    /// Voltage of the source in V.
    pub(crate) source: f64,
    /// Voltage of the bus in V.
    pub(crate) voltage: f64,
    /// Mean current out of the source within the last tick, in ampere.
    pub(crate) current: f64,
}

/// Energies that a tick has moved, in J.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Fed {
    /// Out of the source, behind its impedance.
    pub(crate) source: f64,
    /// Into the drive's own consumption.
    pub(crate) consumption: f64,
}

impl Bus {
    /// A bus that the source has charged.
    pub(crate) fn new(parameters: SupplyParameters, source: f64) -> Self {
        Self {
            parameters,
            tick: Span::new(STEP, &parameters),
            half_tick: Span::new(STEP / 2.0, &parameters),
            source,
            voltage: (source - parameters.impedance * parameters.consumption).max(0.0),
            current: parameters.consumption,
        }
    }

    /// The voltage in the middle of the coming tick, in which the bridge draws `current`.
    pub(crate) fn in_mid_tick(&self, current: f64) -> f64 {
        self.after(current + self.consumption(), &self.half_tick)
    }

    /// Lets a tick pass, in which the bridge has drawn `charge`.
    pub(crate) fn step(&mut self, charge: f64) -> Fed {
        let consumption = self.consumption();
        let before = self.voltage;
        self.voltage = self.after(charge * STEPS_PER_SECOND + consumption, &self.tick);
        let drawn = charge + consumption * STEP;
        let fed = (self.parameters.capacitance * (self.voltage - before) + drawn).max(0.0);
        self.current = fed * STEPS_PER_SECOND;
        let mean = 0.5 * (before + self.voltage);
        Fed {
            source: mean * fed,
            consumption: mean * consumption * STEP,
        }
    }

    /// Energy in the capacitor in J.
    pub(crate) fn energy(&self) -> f64 {
        0.5 * self.parameters.capacitance * self.voltage * self.voltage
    }

    /// The drive's own current: it ends with the last charge.
    fn consumption(&self) -> f64 {
        let most = self.voltage * self.parameters.capacitance * STEPS_PER_SECOND;
        if self.parameters.consumption < most {
            self.parameters.consumption
        } else {
            most
        }
    }

    /// The voltage after a span in which `current` is drawn.
    fn after(&self, current: f64, span: &Span) -> f64 {
        let unfed = self.voltage - current * span.discharge;
        let settled = self.source - self.parameters.impedance * current;
        let voltage = if self.voltage < self.source {
            let fed = settled + (self.voltage - settled) * span.left;
            // What flows back lifts the bus over the source's voltage; the diode then blocks.
            if fed > self.source { unfed.max(self.source) } else { fed }
        } else if unfed >= self.source {
            unfed
        } else {
            // The bus sinks to the source's voltage first, and for the rest of the span the source feeds it.
            let rest = (self.source - unfed) / (self.voltage - unfed);
            settled + (self.source - settled) * decay(rest * span.constants)
        };
        voltage.max(0.0)
    }
}
