//! The firmware core of the USR2556E: from objects and measurements to the command to the power stage, every 50 us.
//!
//! [`Drive::tick`] falls through these modules from top to bottom:
//!
//! | module | holds |
//! |---|---|
//! | [`objects`] | the object table: every manufacturer's and profile object with its typed field |
//! | [`inputs`] | digital inputs: filter, polarity, function |
//! | [`faults`] | faults and their codes |
//! | [`controlword`] | 0x6040: commands, mode bits, edges |
//! | [`power_state`] | the CiA 402 power state machine as a pure function |
//! | `power_control` | what moves that machine: commands, option codes, network, emergency stop |
//! | `modes` | PP, PV, homing and CSP |
//! | [`homing`] | the homing methods as tables and their interpreter |
//! | [`profile`] | trapezoids, interpolation and filter in exact integers |
//! | `motion` | the commanded axis: profile, filter and position counter |
//! | `touch_probe` | positions latched by edges of inputs |
//! | `power_stage` | current and direction of the field |
//! | [`current_loop`] | the field's current in the windings: duties of the legs |
//! | `commissioning` | the first enabling: offsets, identification, gains |
//! | `protection` | over-current and phase loss |
//! | `brake` | when the holding brake opens and shuts |
//! | `outputs` | digital outputs: function and polarity |
//! | [`statusword`] | 0x6041 |
//! | `root` | square roots |
//! | [`alarm`] | the alarm LED |
//! | `write_checks` | what may not be written at present |
//!
//! Nothing here reads a clock, blocks or fails: a tick takes bounded time, and whatever a master writes has a defined effect.
#![no_std]
#![forbid(unsafe_code)]

pub mod alarm;
mod brake;
mod commissioning;
pub mod controlword;
pub mod current_loop;
mod drive;
pub mod faults;
pub mod homing;
pub mod inputs;
mod modes;
mod motion;
pub mod objects;
mod outputs;
mod power_control;
mod power_stage;
pub mod power_state;
pub mod profile;
mod protection;
mod root;
pub mod statusword;
mod touch_probe;
mod write_checks;

pub use alarm::{Alarm, Light};
pub use drive::Drive;
pub use modes::Mode;
pub use objects::{DriveObjects, slots};
pub use power_stage::CurrentVector;
pub use power_state::PowerState;
