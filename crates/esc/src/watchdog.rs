//! A watchdog: runs after its first trigger, expires when the next is late (ESC data sheet, section I, 13).

use wire::Nanos;

/// A watchdog's state; its time-out is a register and comes in with every call, 0 for off.
///
/// The slave stack's time lags behind the frames', so the last lapse stays known after the trigger that ended it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Watchdog {
    triggered: Option<Nanos>,
    expired: bool,
    lapse: Option<(Nanos, Nanos)>,
}

impl Watchdog {
    /// Triggers the watchdog. If it expired before without anybody having noticed, that instant is returned.
    pub(crate) fn trigger(&mut self, at: Nanos, timeout: u64) -> Option<Nanos> {
        let deadline = self.deadline(timeout).filter(|deadline| *deadline <= at);
        if let Some(deadline) = deadline {
            self.lapse = Some((deadline, at));
        }
        let unnoticed = deadline.filter(|_| !self.expired);
        self.triggered = Some(at);
        self.expired = false;
        unnoticed
    }

    /// Whether the watchdog has expired since the last call.
    pub(crate) fn poll(&mut self, now: Nanos, timeout: u64) -> bool {
        let expires = !self.expired && self.deadline(timeout).is_some_and(|deadline| deadline <= now);
        self.expired |= expires;
        expires
    }

    /// Starts a running watchdog's time anew, because its time-out changed.
    pub(crate) fn restart(&mut self, at: Nanos) {
        if self.triggered.is_some() && !self.expired {
            self.triggered = Some(at);
        }
    }

    /// Whether the watchdog was triggered in time as of `at`, or is off.
    pub(crate) fn is_content(&self, at: Nanos, timeout: u64) -> bool {
        let lapsed = self.lapse.is_some_and(|(from, until)| (from..until).contains(&at));
        timeout == 0 || (!lapsed && self.deadline(timeout).is_some_and(|deadline| at < deadline))
    }

    /// Whether the watchdog has ever been triggered.
    pub(crate) const fn was_triggered(&self) -> bool {
        self.triggered.is_some()
    }

    fn deadline(&self, timeout: u64) -> Option<Nanos> {
        let triggered = self.triggered.filter(|_| timeout != 0)?;
        Some(Nanos(triggered.0.saturating_add(timeout)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIMEOUT: u64 = 100;

    #[test]
    fn runs_only_after_the_first_trigger() {
        let mut watchdog = Watchdog::default();
        assert!(!watchdog.poll(Nanos(1_000), TIMEOUT));
        assert!(!watchdog.is_content(Nanos(0), TIMEOUT));
        assert_eq!(watchdog.trigger(Nanos(1_000), TIMEOUT), None);
        assert!(watchdog.is_content(Nanos(1_099), TIMEOUT) && !watchdog.is_content(Nanos(1_100), TIMEOUT));
    }

    #[test]
    fn expires_once_per_lapse() {
        let mut watchdog = Watchdog::default();
        watchdog.trigger(Nanos(0), TIMEOUT);
        assert!(!watchdog.poll(Nanos(99), TIMEOUT));
        assert!(watchdog.poll(Nanos(100), TIMEOUT));
        assert!(!watchdog.poll(Nanos(500), TIMEOUT));
        assert_eq!(watchdog.trigger(Nanos(600), TIMEOUT), None, "noticed before");
        assert!(watchdog.poll(Nanos(700), TIMEOUT));
    }

    #[test]
    fn a_late_trigger_does_not_hide_the_lapse_from_a_slave_whose_time_lags() {
        let mut watchdog = Watchdog::default();
        watchdog.trigger(Nanos(0), TIMEOUT);
        assert_eq!(watchdog.trigger(Nanos(250), TIMEOUT), Some(Nanos(100)));
        for (at, content) in [(99, true), (100, false), (249, false), (250, true), (349, true), (350, false)] {
            assert_eq!(watchdog.is_content(Nanos(at), TIMEOUT), content, "{at}");
        }
    }

    #[test]
    fn is_content_when_off() {
        let mut watchdog = Watchdog::default();
        assert!(watchdog.is_content(Nanos(5), 0));
        watchdog.trigger(Nanos(0), 0);
        assert!(!watchdog.poll(Nanos(u64::MAX), 0));
        assert!(watchdog.trigger(Nanos(u64::MAX), TIMEOUT).is_some());
        assert!(!watchdog.poll(Nanos(u64::MAX - 1), TIMEOUT), "time before the trigger");
    }
}
