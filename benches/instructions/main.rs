//! How many instructions a control tick of the firmware core takes with everything on, tick by tick, and whether each keeps the budget.
//!
//! Callgrind counts them, and counts the same in every run: this is no measurement of time. Without valgrind there is no count, which is
//! said and is no error.

mod callgrind;

use std::path::Path;
use std::process::ExitCode;
use std::{fs, io};

use benchmarks::scenario::{SCENARIOS, Scenario};

/// The function that is a tick, as callgrind sees its name.
const TICK: &str = "*::counted_tick";

/// The argument that makes this program run one scenario under callgrind.
const RUN: &str = "--run";

fn main() -> ExitCode {
    let mut arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    if arguments.len() == 2 && arguments[0] == RUN {
        return run(&arguments[1]);
    }
    let filter = arguments.pop().unwrap_or_default();
    match callgrind::version() {
        Ok(version) => println!("{version}, {}, instructions per tick", std::env::consts::ARCH),
        Err(error) => {
            println!("instructions are not counted: valgrind: {error}");
            return ExitCode::SUCCESS;
        }
    }
    println!(
        "{:<32}{:>8}{:>8}{:>8}{:>10}{:>8}",
        "scenario", "ticks", "mean", "worst", "in tick", "limit"
    );
    let mut over = 0;
    for scenario in SCENARIOS.iter().filter(|scenario| scenario.name.contains(&filter)) {
        match count(scenario) {
            Ok(counts) => over += u32::from(report(scenario, &counts) > scenario.limit),
            Err(error) => {
                println!("{}: {error}", scenario.name);
                return ExitCode::FAILURE;
            }
        }
    }
    if over > 0 {
        println!("OVER the limit: {over}");
        return ExitCode::FAILURE;
    }
    println!("all within their limits");
    ExitCode::SUCCESS
}

/// The instructions of each tick of a scenario.
fn count(scenario: &Scenario) -> io::Result<Vec<u64>> {
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("instructions.{}", std::process::id()));
    let counts = callgrind::count(TICK, &[RUN, scenario.name], &file);
    // Nothing is lost if it stays.
    fs::remove_file(&file).ok();
    let counts = counts?;
    if counts.len() == scenario.ticks as usize {
        Ok(counts)
    } else {
        Err(io::Error::other(format!("{} counts for {} ticks", counts.len(), scenario.ticks)))
    }
}

/// Prints a scenario's line and returns its worst tick.
fn report(scenario: &Scenario, counts: &[u64]) -> u64 {
    let ticks = counts.len();
    let mean = counts.iter().sum::<u64>() / ticks as u64;
    let worst = counts.iter().copied().max().unwrap_or(0);
    let tick = counts.iter().position(|&count| count == worst).unwrap_or(0);
    let Scenario { name, limit, .. } = scenario;
    println!("{name:<32}{ticks:>8}{mean:>8}{worst:>8}{tick:>10}{limit:>8}");
    worst
}

/// Runs a scenario, under callgrind.
fn run(name: &str) -> ExitCode {
    let Some(scenario) = SCENARIOS.iter().find(|scenario| scenario.name == name) else {
        return ExitCode::FAILURE;
    };
    scenario.run(true);
    ExitCode::SUCCESS
}
