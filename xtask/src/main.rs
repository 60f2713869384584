//! `cargo xtask`: the checks that this project runs on itself.
//!
//! - [`tidy`]: layering, banned words, module sizes, text hygiene: the design's rules as tests; the manual's statements and their tests.
//! - [`no_std`]: builds the firmware core for a Cortex-M, which has no standard library.
//! - [`fuzz`]: runs the fuzz targets for some time.
//! - [`ci`]: everything a change must pass, one step after the other.
#![forbid(unsafe_code)]

mod ci;
mod fuzz;
mod no_std;
mod tidy;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

const USAGE: &str = "\
Usage: cargo xtask COMMAND

Commands:
  tidy                    check layering, style, text hygiene and the tests of the manual's statements
  manual                  write the book's page of the manual's statements and their tests
  no-std                  build the firmware core for thumbv7em-none-eabihf
  fuzz [--seconds N]      run every fuzz target over its corpus and then on, a minute each unless told
  ci [--without STEP]...  run fmt, clippy, doc, tidy, test and no-std, all but the named steps";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["tidy"] => exit(tidy::check(&root())),
        ["manual"] => exit(tidy::renew_manual(&root())),
        ["no-std"] => exit(no_std::build(&root())),
        ["fuzz", rest @ ..] => match fuzz::seconds(rest) {
            Ok(seconds) => exit(fuzz::run(&root(), seconds)),
            Err(error) => misuse(&error),
        },
        ["ci", rest @ ..] => match ci::without(rest) {
            Ok(skipped) => exit(ci::run(&root(), &skipped)),
            Err(error) => misuse(&error),
        },
        ["help" | "--help" | "-h"] => {
            println!("{USAGE}");
            ExitCode::SUCCESS
        }
        [] => misuse("no command given"),
        other => misuse(&format!("unknown arguments: {}", other.join(" "))),
    }
}

/// The workspace's root: the folder above this crate.
fn root() -> PathBuf {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    own.parent().unwrap_or(own).to_path_buf()
}

fn exit(outcome: Result<(), String>) -> ExitCode {
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn misuse(error: &str) -> ExitCode {
    eprintln!("error: {error}\n\n{USAGE}");
    ExitCode::from(2)
}
