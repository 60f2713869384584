//! The identification of the motor: how long, and how often.

use drive::current_loop::identification::Winding;

use super::{Verdict, View, must};
use crate::coverage::Coverage;

/// The identification takes this many ticks at the most: 105 ms (issue of the manual's 2.2.11), with the offsets before it.
const MOST_TICKS: u32 = 2_100;

/// What the drive has to know of the motor.
#[derive(Clone, Debug, Default)]
pub struct Identification {
    /// Ticks of the one under way.
    ticks: u32,
    known: bool,
    /// What was found before: an identification that finds nothing leaves it.
    winding: Option<Winding>,
    /// 0x200B:01 and 0x200C:01.
    settings: (u16, u16),
}

impl Identification {
    /// Looks at a tick.
    ///
    /// # Errors
    /// What does not hold.
    pub fn tick(&mut self, view: &View, coverage: &mut Coverage) -> Verdict {
        let drive = view.drive.device().drive();
        let settings = (view.objects.auto_pi, view.objects.motor_type);
        if drive.is_identifying() {
            must(self.ticks > 0 || !self.known, || "a known motor is identified again".into())?;
            if self.ticks == 0 {
                self.winding = drive.winding();
            }
            self.ticks += 1;
            must(self.ticks <= MOST_TICKS, || format!("identifies for {} ticks", self.ticks))?;
        } else {
            if self.ticks > 0 && view.is_powered() {
                coverage.count("motor identified");
                self.known = drive.winding() != self.winding && drive.winding().is_some_and(|winding| winding.settled);
            }
            self.ticks = 0;
        }
        // Another kind of motor, or a fault of the windings after which it may be another one.
        let doubtful = settings != self.settings || matches!(view.objects.error_code, 0x2211 | 0x3150 | 0x3151 | 0x7122);
        self.known &= !doubtful;
        self.settings = settings;
        Ok(())
    }
}
