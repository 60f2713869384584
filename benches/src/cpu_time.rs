//! How long this thread has computed, which other programs on the machine do not lengthen.

use std::time::Duration;

/// CPU time of the calling thread; only differences mean something.
#[cfg(unix)]
pub fn cpu_time() -> Duration {
    nix::time::clock_gettime(nix::time::ClockId::CLOCK_THREAD_CPUTIME_ID)
        .expect("every Unix has a clock for each thread")
        .into()
}

/// Time since the first call: where threads have no clock of their own, other programs do lengthen it.
#[cfg(not(unix))]
pub fn cpu_time() -> Duration {
    static START: std::sync::LazyLock<std::time::Instant> = std::sync::LazyLock::new(std::time::Instant::now);
    START.elapsed()
}
