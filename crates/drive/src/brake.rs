//! The holding brake on an output: when it opens and shuts around enabling (manual 2.2.5).

use board::TICKS_PER_SECOND;

/// For how many ticks the motor goes on holding while the brake shuts: 50 ms, meant to be more than spring-applied
/// brakes of motors of this size take.
const SHUTTING: u32 = TICKS_PER_SECOND / 20;

/// What the drive knows of the brake, tick by tick.
#[derive(Clone, Debug, Default)]
pub struct Brake {
    open: bool,
    /// Ticks until a brake that is told to shut has done so.
    shutting: u32,
}

impl Brake {
    /// Lets a tick pass in which the motor holds the shaft or not, and is about to be switched off or not.
    ///
    /// A motor that loses its current has nothing to wait for: the brake shuts with it.
    pub fn tick(&mut self, held: bool, leaving: bool) {
        let open = held && !leaving;
        self.shutting = match (held, self.open && !open) {
            (false, _) => 0,
            (true, true) => SHUTTING,
            (true, false) => self.shutting.saturating_sub(1),
        };
        self.open = open;
    }

    /// Whether the brake is to be open.
    pub const fn is_open(&self) -> bool {
        self.open
    }

    /// Whether the brake holds the shaft by itself, so that the motor may be switched off.
    pub const fn holds(&self) -> bool {
        !self.open && self.shutting == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_holds_50_ms_after_it_was_told_to_shut() {
        let mut brake = Brake::default();
        assert!(brake.holds(), "before the motor was ever on");
        brake.tick(true, false);
        assert!(brake.is_open() && !brake.holds());
        for tick in 0..1_000 {
            brake.tick(true, true);
            assert!(!brake.is_open() && !brake.holds(), "{tick}");
        }
        brake.tick(true, true);
        assert!(brake.holds());
    }

    #[test]
    fn it_opens_again_when_the_motor_stays_on_and_shuts_with_a_motor_that_goes_off() {
        let mut brake = Brake::default();
        brake.tick(true, false);
        brake.tick(true, true);
        brake.tick(true, false);
        assert!(brake.is_open());
        brake.tick(false, false);
        assert!(brake.holds());
    }
}
