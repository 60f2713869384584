//! Motion profiles: where the commanded position goes in each tick of 50 us.
//!
//! - [`quantity`]: positions, speeds and accelerations as exact integers
//! - [`generator`]: trapezoidal motion to a target, at a velocity, and to a stop
//! - `braking`: the arithmetic of stopping exactly at a given distance
//! - [`interpolator`]: cyclic synchronous position, straight lines between the master's targets
//! - [`sliding_average`]: the smoothing filter of object 0x2009
//!
//! The fixed point is chosen so that every speed and acceleration is a whole number: with `f` ticks a second, a pulse has `f * f` sub-pulses. A speed of `n`
//! pulses/s is then exactly `n * f` sub-pulses a tick, and an acceleration of `n` pulses/s^2 exactly `n` sub-pulses a tick, each tick.

mod braking;
pub mod generator;
pub mod interpolator;
pub mod quantity;
pub mod sliding_average;

pub use generator::{Command, Generator, Onward, Progress};
pub use interpolator::Interpolator;
pub use quantity::{Acceleration, Position, Ramp, Speed};
pub use sliding_average::SlidingAverage;
