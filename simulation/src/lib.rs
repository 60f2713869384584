//! One drive under a master that does anything, watched in every control tick; the same seed does the same again.
//!
//! | module | holds |
//! |---|---|
//! | [`random`] | chance from a seed |
//! | [`bus`] | the wire with one whole virtual drive at its end, and time |
//! | [`machine`] | the motor, its load and its supply |
//! | [`master`] | a master: states, process data |
//! | `mailbox` | its mailbox: SDO and files |
//! | [`acts`] | what it does: sense and nonsense |
//! | [`invariants`] | what must hold in every tick |
//! | [`coverage`] | what was visited |
//! | [`journal`] | what was done last |
//! | [`campaign`] | many seeds on several threads |
#![forbid(unsafe_code)]

pub mod acts;
pub mod bus;
pub mod campaign;
pub mod coverage;
pub mod invariants;
pub mod journal;
pub mod machine;
mod mailbox;
pub mod master;
pub mod random;

use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

use bus::Bus;
use coverage::Coverage;
use invariants::{Invariants, Verdict};
use journal::Journal;
use master::Master;
use plant::PlantConfig;
use random::Random;

/// A drive, its master and all that is known of them.
pub struct Simulation {
    bus: Bus,
    random: Random,
    master: Master,
    invariants: Invariants,
    coverage: Coverage,
    journal: Journal,
    /// What the next power-on must find.
    kept: acts::parameters::Kept,
    machine: PlantConfig,
    /// Whether the drive has been told what motor it has.
    commissioned: bool,
}

/// Something that must not be.
#[derive(Clone, Debug)]
pub struct Failure {
    /// The seed that does it again.
    pub seed: u64,
    /// Simulated time since power-on.
    pub at: Duration,
    /// What is wrong.
    pub what: String,
    /// What the master did last.
    pub acts: Vec<String>,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "seed {} after {:.6} s: {}", self.seed, self.at.as_secs_f64(), self.what)?;
        for act in &self.acts {
            writeln!(f, "    {act}")?;
        }
        write!(f, "again: cargo run --release -p simulation -- --seed {}", self.seed)
    }
}

impl Simulation {
    /// A new drive and the master of a seed.
    pub fn new(seed: u64) -> Self {
        let machine = machine::of(seed);
        Self {
            bus: Bus::new(machine),
            random: Random::new(seed),
            master: Master::default(),
            invariants: Invariants::default(),
            coverage: Coverage::default(),
            journal: Journal::default(),
            kept: acts::parameters::Kept::default(),
            machine,
            commissioned: false,
        }
    }

    /// Lets the master of `seed` act for so much simulated time, or a little more until its last act is over.
    ///
    /// # Errors
    /// An invariant did not hold, or the drive panicked.
    pub fn run(seed: u64, span: Duration) -> Result<Coverage, Box<Failure>> {
        let mut simulation = Self::new(seed);
        let verdict = catch_unwind(AssertUnwindSafe(|| simulation.act_until(span)));
        let what = match verdict {
            Ok(Ok(())) => return Ok(simulation.coverage),
            Ok(Err(what)) => what,
            Err(panic) => format!("panic: {}", message(panic.as_ref())),
        };
        Err(Box::new(Failure {
            seed,
            at: Duration::from_nanos(simulation.bus.now().0),
            what,
            acts: simulation.journal.last(),
        }))
    }

    fn act_until(&mut self, span: Duration) -> Verdict {
        while u128::from(self.bus.now().0) < span.as_nanos() {
            self.act()?;
        }
        Ok(())
    }

    /// Lets a control tick pass.
    fn tick(&mut self) -> Verdict {
        let sensors = *self.bus.drive().sensors();
        self.bus.tick();
        self.invariants.tick(self.bus.drive(), &sensors, &mut self.coverage)
    }

    fn ticks(&mut self, count: u64) -> Verdict {
        (0..count).try_for_each(|_| self.tick())
    }

    /// Keeps what the master is about to do, for the case that it goes wrong.
    fn note(&mut self, act: impl FnOnce() -> String) {
        self.journal.note(self.bus.now(), act);
    }
}

fn message(panic: &(dyn std::any::Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("without a message")
}
