//! The `ethercrab` master against the virtual drive, in memory and in lock-step.

mod bus;
mod coe;
mod differences;
mod homing;
mod information;
mod leds;
mod mapping;
mod motion;
mod objects;
mod raw_mailbox;
mod topology;
