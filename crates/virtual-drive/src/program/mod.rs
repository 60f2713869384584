//! The program `usr2556e`: one module a command.
//!
//! | module | command |
//! |---|---|
//! | [`arguments`] | what can be typed |
//! | `demonstrate` | `usr2556e` alone |
//! | `serve` | `run` and `exec` |
//! | `order` | `cable` and `fault`: orders to a drive server |
//! | `motor` | `motor`: motors and their torque |
//! | `tune` | `tune`: values found by experiment |
//! | `lead` | `scan`, `sdo`, `move`: the built-in master on an interface |
//! | `export` | `esi` and `sii` |

pub mod arguments;
mod demonstrate;
mod export;
mod lead;
mod motor;
mod order;
mod serve;
mod tune;

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use anyhow::Context;
use arguments::{Arguments, Command};
use clap::Parser;

/// Runs the command that was typed; errors go to standard error with their causes.
pub fn run() -> ExitCode {
    let arguments = Arguments::parse();
    let result = match arguments.command {
        None => demonstrate::demonstrate(&arguments.demonstration).map(|()| ExitCode::SUCCESS),
        Some(Command::Run(options)) => serve::run(&options).map(|()| ExitCode::SUCCESS),
        Some(Command::Exec(options)) => serve::exec(&options),
        Some(Command::Cable(options)) => order::cable(&options).map(|()| ExitCode::SUCCESS),
        Some(Command::Fault(options)) => order::fault(&options).map(|()| ExitCode::SUCCESS),
        Some(Command::Motor(options)) => motor::motor(&options).map(|()| ExitCode::SUCCESS),
        Some(Command::Tune(options)) => tune::tune(&options).map(|()| ExitCode::SUCCESS),
        Some(Command::Scan(options)) => lead::scan(&options).map(|()| ExitCode::SUCCESS),
        Some(Command::Sdo(options)) => lead::sdo(&options).map(|()| ExitCode::SUCCESS),
        Some(Command::Move(options)) => lead::move_axis(&options),
        Some(Command::Esi(options)) => export::esi(&options).map(|()| ExitCode::SUCCESS),
        Some(Command::Sii(options)) => export::sii(&options).map(|()| ExitCode::SUCCESS),
    };
    result.unwrap_or_else(|error| {
        if !is_closed_pipe(&error) {
            eprintln!("usr2556e: {error:#}");
        }
        ExitCode::FAILURE
    })
}

/// Whether the reader of standard output has gone, as with `| head`: no error worth a word.
fn is_closed_pipe(error: &anyhow::Error) -> bool {
    error
        .chain()
        .filter_map(|cause| cause.downcast_ref::<std::io::Error>())
        .any(|cause| cause.kind() == std::io::ErrorKind::BrokenPipe)
}

/// A flag that Ctrl-C and a polite kill set instead of ending the process.
fn on_signal() -> anyhow::Result<Arc<AtomicBool>> {
    let flag = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
        signal_hook::flag::register(signal, Arc::clone(&flag)).context("cannot watch for Ctrl-C")?;
    }
    Ok(flag)
}
