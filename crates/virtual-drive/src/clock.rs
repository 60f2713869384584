//! Where the simulation's time comes from.

use std::thread;
use std::time::{Duration, Instant};

use wire::Nanos;

/// The time of one simulation, counted from its start.
#[derive(Clone, Copy, Debug)]
pub enum Clock {
    /// The computer's own time: a drive as if it hung on the wire.
    RealTime(Instant),
    /// Time that moves only when somebody moves it: the same inputs give the same outputs on every machine.
    LockStep(Nanos),
}

impl Clock {
    /// A clock that starts now and goes with the computer's, for the calling thread, whose sleeps become precise.
    pub fn real_time() -> Self {
        sleep_precisely();
        Self::RealTime(Instant::now())
    }

    /// A clock that stands at zero until it is moved.
    pub fn lock_step() -> Self {
        Self::LockStep(Nanos(0))
    }

    /// The present instant.
    pub fn now(&self) -> Nanos {
        match self {
            Self::RealTime(start) => Nanos(0).after(start.elapsed()),
            Self::LockStep(now) => *now,
        }
    }

    /// Lets time pass up to `instant`; at once if that is over already.
    pub fn wait_until(&mut self, instant: Nanos) {
        match self {
            Self::RealTime(start) => {
                let remaining = (*start + Duration::from_nanos(instant.0)).saturating_duration_since(Instant::now());
                if !remaining.is_zero() {
                    thread::sleep(remaining);
                }
            }
            Self::LockStep(now) => *now = (*now).max(instant),
        }
    }
}

/// Makes this thread's sleeps end when they are asked to, instead of within 50 us, Linux's default for a thread that is not real-time.
///
/// Where the system refuses or does not know this, sleeps end a little late.
pub fn sleep_precisely() {
    #[cfg(target_os = "linux")]
    let _ = nix::sys::prctl::set_timerslack(1);
}
