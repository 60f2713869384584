//! The program `usr2556e` from outside: exit statuses, files, and what it says to bad input.
//!
//! | module | holds |
//! |---|---|
//! | [`program`] | starting the program, and what it has left behind |
//! | [`serving`] | drives that are served beside a test |
//! | [`files`] | the demonstration, exports, EEPROM files, captures |
//! | [`arguments`] | what cannot be meant |
//! | [`motor`] | motors, and the motor of a drive |
//! | [`tune`] | values found by experiment |
//! | [`network`] | interfaces and privileges |
//! | [`cables`] | rings, and cables that are cut |
//! | [`faults`] | windings, motor and supply that break |
//! | [`exec`] | commands in a network of their own |

mod arguments;
mod cables;
mod exec;
mod faults;
mod files;
mod motor;
mod network;
mod program;
mod serving;
mod tune;

use libtest_mimic::{Arguments, Trial};
use program::Outcome;

/// A test and its name.
type Case = (&'static str, fn() -> Outcome);

fn main() -> std::process::ExitCode {
    let cases = [
        arguments::CASES,
        files::CASES,
        motor::CASES,
        tune::CASES,
        network::CASES,
        exec::CASES,
        cables::CASES,
        faults::CASES,
    ]
    .concat();
    let trials = cases.into_iter().map(|(name, case)| Trial::ignorable_test(name, case)).collect();
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}
