//! Homing (manual 2.4.6): finding position zero with the help of switches.
//!
//! - [`method`]: the methods, as tables of legs
//! - [`sequence`]: the one interpreter that runs any of them
//!
//! The position of the deciding edge is the home position: the position counter is set so that the edge reads 0x607C. What the axis
//! travels while it brakes after the edge stays visible in the counter.

pub mod method;
pub mod sequence;

pub use method::Method;
pub use sequence::{Action, Homing, HomingError, Outcome, Parameters, Signals};
