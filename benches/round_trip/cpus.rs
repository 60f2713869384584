//! Master and responder each on a CPU of their own.
//!
//! Left to itself, the scheduler now and then puts both on the same CPU, where a frame flat out takes a quarter of the time: a difference many times
//! that between a drive and an echo.

use nix::sched::{CpuSet, sched_getaffinity, sched_setaffinity};
use nix::unistd::Pid;

/// The CPUs that this process may use.
pub struct Cpus(CpuSet);

impl Cpus {
    /// Those that the calling thread may use now.
    pub fn available() -> Self {
        Self(sched_getaffinity(Pid::from_raw(0)).expect("a thread may know its own CPUs"))
    }

    /// Keeps the calling thread on the `number`th of them, counted from 0; where there are not that many, on none in particular.
    pub fn pin(&self, number: usize) {
        let mut available = (0..CpuSet::count()).filter(|&cpu| self.0.is_set(cpu) == Ok(true));
        if let Some(cpu) = available.nth(number) {
            let mut only = CpuSet::new();
            only.set(cpu).expect("a CPU of a set fits into a set");
            restrict(&only);
        }
    }

    /// Lets the calling thread run on all of them.
    pub fn release(&self) {
        restrict(&self.0);
    }
}

fn restrict(cpus: &CpuSet) {
    sched_setaffinity(Pid::from_raw(0), cpus).expect("a thread may restrict itself to CPUs it has");
}
