//! What the benchmarks share: a small master that uses nothing but plain frames, so that every byte and every instant of what is measured
//! is in the benchmark's hand.
//!
//! | module | holds |
//! |---|---|
//! | [`bus`] | what frames go out on; [`bus::Lockstep`], drives in memory whose time the benchmark moves |
//! | [`cyclic`] | the cyclic frames of N drives over their default process data |
//! | [`bring_up`] | from power-on to Operation Enabled in CSP |
//! | [`firmware_core`] | the firmware core before a plant, with everything on |
//! | [`field`] | what lets a plant's motor turn, without a drive |
//! | [`scenario`] | what it does there: every mode and every kind of surprise |
//! | [`cpu_time`] | how long this thread has computed |
//! | [`machine`] | one line about the machine |

pub mod bring_up;
pub mod bus;
pub mod cpu_time;
pub mod cyclic;
pub mod field;
pub mod firmware_core;
pub mod machine;
pub mod scenario;
