//! Many seeds, on several threads.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;
use std::time::Duration;

use crate::coverage::Coverage;
use crate::{Failure, Simulation};

/// What to run.
#[derive(Clone, Copy, Debug)]
pub struct Campaign {
    /// The first seed; the others count up from it.
    pub first_seed: u64,
    /// How many seeds.
    pub seeds: u64,
    /// Simulated time of each.
    pub span: Duration,
    /// Threads.
    pub threads: usize,
}

impl Campaign {
    /// Runs all seeds and returns what they have been through. `done` is called after each of them, from any thread.
    ///
    /// # Errors
    /// The first failure; seeds that have begun are run to their end.
    pub fn run(&self, done: impl Fn() + Sync) -> Result<Coverage, Box<Failure>> {
        let next = AtomicU64::new(0);
        let stop = AtomicBool::new(false);
        let outcome = Mutex::new((Coverage::default(), None::<Box<Failure>>));
        thread::scope(|scope| {
            for _ in 0..self.threads.max(1) {
                scope.spawn(|| {
                    while !stop.load(Ordering::Relaxed) {
                        let number = next.fetch_add(1, Ordering::Relaxed);
                        if number >= self.seeds {
                            break;
                        }
                        let result = Simulation::run(self.first_seed.wrapping_add(number), self.span);
                        let mut outcome = outcome.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
                        match result {
                            Ok(coverage) => outcome.0.add(&coverage),
                            Err(failure) => {
                                stop.store(true, Ordering::Relaxed);
                                outcome.1.get_or_insert(failure);
                            }
                        }
                        drop(outcome);
                        done();
                    }
                });
            }
        });
        match outcome.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner()) {
            (coverage, None) => Ok(coverage),
            (_, Some(failure)) => Err(failure),
        }
    }
}
