//! Masters in processes of their own, on virtual cables. What is missing for a test is told as the reason why it was ignored.
//!
//! | module | holds |
//! |---|---|
//! | [`pysoem`] | SOEM through Python |
//! | [`kickcat`] | KickCAT through Python |
//! | [`python`] | what masters in Python have in common |
//! | [`ring`] | SOEM, and cables that are cut |
//! | [`built_in`] | the program's own master |
//! | [`tshark`] | what Wireshark thinks of the frames |
//! | [`cable`] | a virtual cable between interfaces of this machine |

mod built_in;
mod cable;
mod kickcat;
#[path = "../cli/program.rs"]
mod program;
mod pysoem;
mod python;
mod ring;
mod tshark;

use libtest_mimic::{Arguments, Trial};
use program::Outcome;

/// A test and its name.
type Case = (&'static str, fn() -> Outcome);

fn main() -> std::process::ExitCode {
    let cases = [pysoem::CASES, ring::CASES, kickcat::CASES, built_in::CASES, tshark::CASES].concat();
    let trials = cases.into_iter().map(|(name, case)| Trial::ignorable_test(name, case)).collect();
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}
