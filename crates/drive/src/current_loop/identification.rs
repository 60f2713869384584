//! Identification of the motor's resistance and inductance while the shaft is locked (manual 2.2.11, 2.2.12).
//!
//! | step | what | why |
//! |---|---|---|
//! | 1 | a square wave of 2.5 kHz on both axes, doubled until it shows | a rough inductance; an open or shorted winding |
//! | 2 | a soft loop takes the current to its full value and waits for the rotor | the voltage there |
//! | 3 | the square wave again, on top of the full current | the inductance, with the rotor aligned and the current far from zero |
//! | 4 | the soft loop takes the current to half its value | the voltage there; of the difference to step 2, which dead times and offsets do not touch, the resistance |
//!
//! A voltage of steps 2 and 4 counts when two means of 8 ms agree and the current across the commanded direction is calm: a rotor that still
//! swings induces voltages that would pass for resistance.

use super::levels::Levels;
use super::pulses::{Pulse, Pulses};
use super::vector::{Direction, Vector};

/// Ticks that the identification takes at the most: 103 ms, which with 2 ms for the offsets before makes 105 ms.
pub const MOST_TICKS: u32 = 2_060;

/// What a tick looks at.
#[derive(Clone, Copy, Debug)]
pub struct Situation {
    /// The measured current, offsets taken off, in ampere.
    pub current: Vector,
    /// The supply in volt.
    pub supply: f32,
    /// The current of the locked shaft in ampere.
    pub amplitude: f32,
    /// Its direction.
    pub direction: Direction,
    /// Whether the motor has three phases.
    pub three_phases: bool,
}

/// A motor's winding as identified.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Winding {
    /// Resistance in ohm, that of bridge and cable included.
    pub resistance: f32,
    /// Inductance in henry.
    pub inductance: f32,
    /// Whether the rotor came to rest in time. If not, the values are rough.
    pub settled: bool,
}

/// What comes of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// The voltage over the windings for this tick.
    Drive(Vector),
    /// The motor is known; the voltage that holds the present current, in the commanded frame.
    Known(Winding, Vector),
    /// A winding, counted from 0, carries no current.
    Open(usize),
    /// A winding has no inductance worth the name.
    Shorted,
    /// The values make no sense, as those of a motor that somebody turns.
    Unknown,
}

/// The identification under way.
#[derive(Clone, Debug)]
pub struct Identification {
    tick: u32,
    step: Step,
}

#[derive(Clone, Debug)]
enum Step {
    Pulses(Pulses),
    Levels(Levels),
}

impl Identification {
    /// Before its first tick.
    pub fn new() -> Self {
        Self {
            tick: 0,
            step: Step::Pulses(Pulses::default()),
        }
    }

    /// One tick of it.
    pub fn tick(&mut self, at: &Situation) -> Outcome {
        self.tick += 1;
        let levels = match &mut self.step {
            Step::Levels(levels) => levels,
            Step::Pulses(pulses) => {
                let inductance = match pulses.tick(at) {
                    Pulse::Drive(voltage) => return Outcome::Drive(voltage),
                    Pulse::Open(winding) => return Outcome::Open(winding),
                    Pulse::Shorted => return Outcome::Shorted,
                    Pulse::Answered(inductance) => inductance,
                };
                self.step = Step::Levels(Levels::new(inductance));
                return self.tick(at);
            }
        };
        match levels.advance(self.tick) {
            Some(outcome) => outcome,
            None => Outcome::Drive(levels.drive(at)),
        }
    }

    /// The share of the locked current that is commanded.
    pub fn level(&self) -> f32 {
        match &self.step {
            Step::Pulses(_) => 0.0,
            Step::Levels(levels) => levels.level(),
        }
    }
}

impl Default for Identification {
    fn default() -> Self {
        Self::new()
    }
}
