//! Touch probes: positions latched by edges of inputs (manual 2.3.17 to 2.3.22, 2.4.5).
//!
//! Two instants belong to an edge. At the first, the input's level changes: this decides which position is latched. At the second, the
//! level has been steady for the time of 0x204B: this decides that there was an edge, and only then 0x60B9 and the latched position show
//! it. An input that goes back before that has had no edge.
//!
//! The latched position is the commanded one, which in open loop is the motor's, on the straight line between the ticks before and after
//! the edge; it is exact to the half pulse by which it is rounded, and to what the board's capture leaves open
//! ([`Sensors::level_ages`]). It counts in the coordinates in which it is shown: an origin that moves while the filter still waits moves
//! it too. What was shown stays as it is.

use board::{INPUT_COUNT, Nanos, Sensors, TICK};

use crate::inputs::{PROBES, Signals};
use crate::motion::Motion;
use crate::objects::DriveObjects;
use crate::profile::Position;

/// Bits of 0x60B8 that masters may set: those of probe 1 and, eight places further, those of probe 2. Bits 1 and 9 are reserved, but the
/// manual's first step sets bit 1.
const FUNCTION_BITS: u16 = 0x3333;

/// Whether 0x60B8 may be `function`: bits that select what these probes do not have must be 0.
pub const fn is_function(function: u16) -> bool {
    function & !FUNCTION_BITS == 0
}

/// A change of a probe's signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Edge {
    /// The signal became valid.
    Rising,
    /// The signal ceased to be valid.
    Falling,
}

impl Edge {
    const fn bit(self) -> u8 {
        match self {
            Self::Rising => 1,
            Self::Falling => 2,
        }
    }
}

/// One probe's byte of 0x60B8.
#[derive(Clone, Copy, Debug, Default)]
struct Function(u8);

impl Function {
    /// The edges that are latched, as [`Edge::bit`]; none while the probe is disabled.
    const fn edges(self) -> u8 {
        if self.is_enabled() { self.0 >> 4 & 3 } else { 0 }
    }

    const fn is_enabled(self) -> bool {
        self.0 & 1 != 0
    }
}

/// What a probe knows of its past.
#[derive(Clone, Debug, Default)]
struct Probe {
    /// The function in the tick before.
    function: Function,
    /// Edges latched since they were armed, as [`Edge::bit`].
    latched: u8,
}

impl Probe {
    /// Takes a tick's function and edge; returns whether the edge's position is to be latched.
    fn tick(&mut self, function: Function, edge: Option<Edge>) -> bool {
        // An edge lies before the tick that sees it, so it needs a probe that was armed by then and still is.
        let armed = function.edges() & self.function.edges();
        self.function = function;
        self.latched &= function.edges();
        let Some(bit) = edge.map(Edge::bit) else { return false };
        let latches = armed & bit != 0 && self.latched & bit == 0;
        if latches {
            self.latched |= bit;
        }
        latches
    }

    /// This probe's byte of 0x60B9.
    fn status(&self) -> u16 {
        u16::from(self.function.is_enabled()) | u16::from(self.latched) << 1
    }
}

/// Where and when an input's level changed.
#[derive(Clone, Copy, Debug, Default)]
struct Place {
    /// Time since power-up.
    instant: Nanos,
    /// How long that was before the end of its tick, a tick at the most.
    age: Nanos,
    /// Sub-pulses travelled since power-up by the end of that tick; wraps.
    travelled: i64,
    /// Sub-pulses travelled in that tick.
    travel: i64,
}

impl Place {
    /// Sub-pulses travelled since power-up by the instant. Inputs change more often than they are latched, so only what is latched is
    /// put to this division.
    const fn travelled(&self) -> i64 {
        // The fastest motion of all times a tick in nanoseconds is just within an i64.
        let since = self.travel * self.age.0 as i64 / TICK.0 as i64;
        self.travelled.wrapping_sub(since)
    }
}

/// The two touch probes.
#[derive(Clone, Debug, Default)]
pub(crate) struct TouchProbes {
    /// The end of this tick.
    now: Place,
    /// Where each input last began to differ from its filtered level.
    begun: [Place; INPUT_COUNT],
    probes: [Probe; PROBES],
}

impl TouchProbes {
    /// Follows the motion of a tick that is over and latches what its edges ask for.
    pub fn tick(&mut self, sensors: &Sensors, signals: &Signals, motion: &Motion, objects: &mut DriveObjects) {
        self.now.travel = motion.travel();
        self.now.travelled = self.now.travelled.wrapping_add(self.now.travel);
        self.now.instant.0 += TICK.0;
        if signals.differing != 0 {
            self.note(signals.differing, sensors);
        }
        let mut status = 0;
        for number in 0..PROBES {
            let function = Function((objects.probe_function >> (8 * number)) as u8);
            let edge = edge(signals, number);
            if self.probes[number].tick(function, edge)
                && let Some(edge) = edge
            {
                let place = self.place(edge, signals.changed & signals.probes[number]);
                let back = self.now.travelled.wrapping_sub(place.travelled());
                let position = Position::from_sub_pulses(motion.position().sub_pulses().wrapping_sub(back));
                latch(objects, number, edge, position);
            }
            status |= self.probes[number].status() << (8 * number);
        }
        objects.probe_status = status;
    }

    /// Notes where `inputs` have changed their level within the last tick.
    fn note(&mut self, inputs: u8, sensors: &Sensors) {
        for (number, begun) in self.begun.iter_mut().enumerate() {
            if inputs >> number & 1 != 0 {
                let age = sensors.level_ages[number].min(TICK);
                *begun = Place {
                    instant: Nanos(self.now.instant.0 - age.0),
                    age,
                    ..self.now
                };
            }
        }
    }

    /// Where the edge of a signal was that `inputs` have together: it rises with the first of them and falls with the last.
    fn place(&self, edge: Edge, mut inputs: u8) -> &Place {
        let mut place = self.begun.get(inputs.trailing_zeros() as usize).unwrap_or(&self.now);
        // Mostly it is but one input.
        while inputs & inputs.wrapping_sub(1) != 0 {
            inputs &= inputs - 1;
            let Some(begun) = self.begun.get(inputs.trailing_zeros() as usize) else {
                break;
            };
            let decides = match edge {
                Edge::Rising => begun.instant < place.instant,
                Edge::Falling => begun.instant > place.instant,
            };
            if decides {
                place = begun;
            }
        }
        place
    }
}

/// The edge of a probe's signal in this tick. Only a level that changes makes one, and no writing to polarity or function.
const fn edge(signals: &Signals, probe: usize) -> Option<Edge> {
    let inputs = signals.probes[probe];
    let is_valid = signals.valid & inputs != 0;
    let was_valid = (signals.valid ^ signals.changed) & inputs != 0;
    match (was_valid, is_valid) {
        (false, true) => Some(Edge::Rising),
        (true, false) => Some(Edge::Falling),
        _ => None,
    }
}

fn latch(objects: &mut DriveObjects, probe: usize, edge: Edge, position: Position) {
    let (latched, count) = match (probe, edge) {
        (0, Edge::Rising) => (&mut objects.probe_1_positive, &mut objects.probe_1_positive_count),
        (0, Edge::Falling) => (&mut objects.probe_1_negative, &mut objects.probe_1_negative_count),
        (_, Edge::Rising) => (&mut objects.probe_2_positive, &mut objects.probe_2_positive_count),
        (_, Edge::Falling) => (&mut objects.probe_2_negative, &mut objects.probe_2_negative_count),
    };
    *latched = position.pulses() as u32;
    *count = count.wrapping_add(1);
}
