//! Simulates one drive under a random master for many hours.
#![forbid(unsafe_code)]

use std::process::ExitCode;
use std::thread;
use std::time::{Duration, Instant};

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use simulation::campaign::Campaign;
use simulation::coverage::REQUIRED;

/// Simulates one drive under a random master and checks it in every control tick. The exit status is 1 if something was wrong; what it
/// was and the seed that does it again are printed.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    /// Simulated hours in all; without it, one seed is run
    #[arg(long)]
    hours: Option<f64>,
    /// Seed, the first one if there are several
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Simulated minutes of each seed
    #[arg(long, default_value_t = 6.0)]
    minutes: f64,
    /// Threads; as many as there are cores by default
    #[arg(long)]
    threads: Option<usize>,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let seeds = arguments
        .hours
        .map_or(1, |hours| (hours * 60.0 / arguments.minutes).ceil().max(1.0) as u64);
    let campaign = Campaign {
        first_seed: arguments.seed,
        seeds,
        span: Duration::from_secs_f64(arguments.minutes * 60.0),
        threads: arguments
            .threads
            .unwrap_or_else(|| thread::available_parallelism().map_or(1, usize::from)),
    };
    let style = ProgressStyle::with_template("{pos} of {len} seeds {wide_bar} {eta} left").expect("a valid template");
    let progress = ProgressBar::new(seeds).with_style(style);
    let started = Instant::now();
    let outcome = campaign.run(|| progress.inc(1));
    progress.finish_and_clear();
    match outcome {
        Ok(coverage) => {
            let simulated = campaign.span.as_secs_f64() * seeds as f64;
            let rate = simulated * f64::from(board::TICKS_PER_SECOND) / started.elapsed().as_secs_f64() / 1e6;
            print!("{coverage}");
            for missing in REQUIRED.iter().filter(|what| coverage.of(what) == 0) {
                println!("never: {missing}");
            }
            println!(
                "{:.2} hours, seeds {} to {}, {rate:.2} million ticks/s: nothing wrong",
                simulated / 3600.0,
                arguments.seed,
                arguments.seed.wrapping_add(seeds - 1),
            );
            ExitCode::SUCCESS
        }
        Err(failure) => {
            eprintln!("{failure}");
            ExitCode::FAILURE
        }
    }
}
