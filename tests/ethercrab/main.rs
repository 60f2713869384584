//! The `ethercrab` master against the virtual drive, in memory and in lock-step.

mod bus;
mod clocks;
mod coe;
mod differences;
mod eeprom;
mod faults;
mod homing;
mod information;
mod leds;
mod loss;
mod mapping;
mod motion;
mod objects;
mod parameters;
mod raw_mailbox;
mod topology;
mod touch_probe;
