//! The identification's first step: a square wave on both axes, doubled until the windings answer.

use super::identification::Situation;
use super::ripple::{self, Answer};
use super::vector::Vector;

/// Ticks of one amplitude of the square wave in step 1: 2 ms.
const PULSE_TICKS: u32 = 40;
/// The first of them do not count.
const PULSE_LEAD: u32 = 8;
/// Share of the supply that the square wave begins with, and ends with.
pub const PULSE_SHARE: (f32, f32) = (0.02, 0.3);
/// Amplitude of the current that is enough in step 1: this share of the locked current, and at least this many ampere.
pub const RIPPLE_SHARE: f32 = 0.05;
const RIPPLE_LEAST: f32 = 0.05;
/// A current below this at the full square wave is noise: the winding is open. 10 mA are 70 mH at 24 V.
const OPEN_BELOW: f32 = 0.010;
/// An inductance below this is a short, in henry.
const SHORT_BELOW: f32 = 50e-6;

/// Step 1 under way.
#[derive(Clone, Debug, Default)]
pub struct Pulses {
    tick: u32,
    /// Share of the supply.
    share: f32,
    answer: Answer,
}

/// What comes of a tick.
pub enum Pulse {
    /// The voltage over the windings for this tick.
    Drive(Vector),
    /// The windings' inductance, roughly, in henry.
    Answered(f32),
    /// A winding, counted from 0, carries no current.
    Open(usize),
    /// A winding has no inductance worth the name.
    Shorted,
}

impl Pulses {
    /// One tick of it.
    pub fn tick(&mut self, at: &Situation) -> Pulse {
        if self.tick == PULSE_TICKS {
            if let Some(verdict) = self.verdict(at) {
                return verdict;
            }
            self.tick = 0;
        }
        if self.tick == 0 {
            self.share = (self.share * 2.0).clamp(PULSE_SHARE.0, PULSE_SHARE.1);
            self.answer = Answer::default();
        }
        let volts = self.share * at.supply;
        // A quarter of a period apart: a vector that turns, to which each of three phases answers alike.
        let voltage = Vector {
            a: volts * ripple::square(self.tick),
            b: volts * ripple::square(self.tick + ripple::PERIOD * 3 / 4),
        };
        if self.tick >= PULSE_LEAD {
            self.answer.add(self.tick, at.current, voltage);
        }
        self.tick += 1;
        Pulse::Drive(voltage)
    }

    /// What an amplitude has shown; none if it takes a larger one.
    fn verdict(&self, at: &Situation) -> Option<Pulse> {
        let ripple = self.answer.ripple(at.three_phases);
        let [a, b] = self.answer.inductances();
        let least = ripple.iter().copied().fold(f32::INFINITY, f32::min);
        let enough = (RIPPLE_SHARE * at.amplitude).max(RIPPLE_LEAST);
        let most = ripple.iter().copied().filter(|ripple| ripple.is_finite()).fold(0.0, f32::max);
        if most >= enough && a.min(b) < SHORT_BELOW {
            return Some(Pulse::Shorted);
        }
        if least < enough && self.share < PULSE_SHARE.1 {
            return None;
        }
        match ripple.iter().position(|ripple| *ripple < OPEN_BELOW) {
            Some(winding) => Some(Pulse::Open(winding)),
            None => Some(Pulse::Answered((a + b) / 2.0)),
        }
    }
}
