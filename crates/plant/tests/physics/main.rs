//! The plant's physics: against an independent solver, against formulas, and what happens when something breaks.

mod controller;
mod energy;
mod faults;
mod load;
mod motor;
mod power_stage;
mod reference;
mod supply;
mod terminals;
