//! The `ethercrab` master against the virtual drive, in memory and in lock-step.

mod bus;
mod homing;
mod mapping;
mod motion;
mod objects;
mod topology;
