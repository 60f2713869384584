//! What breaks while the drive works, and is mended again.

use board::Millivolts;
use plant::Faults;

use crate::Simulation;
use crate::invariants::Verdict;

impl Simulation {
    /// Something breaks, in motion or not; the machine goes on, is enabled again, or waits until it is mended.
    pub(crate) fn break_down(&mut self) -> Verdict {
        if self.random.chance(80) && self.prepare(3)? && self.random.chance(70) {
            self.turn()?;
        }
        let faults = self.any_faults();
        self.note(|| format!("{faults:?}"));
        self.set_faults(faults);
        self.pause(300)?;
        for _ in 0..self.random.below(3) {
            self.master.commands.mode = 3;
            self.enable()?;
            self.turn()?;
        }
        if self.random.chance(90) {
            self.note(|| "mended".into());
            self.set_faults(Faults::default());
            self.pause(100)?;
        }
        Ok(())
    }

    fn any_faults(&mut self) -> Faults {
        let mut faults = Faults::default();
        let winding = self.random.below(2) as usize;
        let what = match self.random.below(6) {
            0 | 1 => {
                faults.open[winding] = true;
                ["broken: open A", "broken: open B"][winding]
            }
            2 => {
                faults.shorted[winding] = true;
                ["broken: shorted A", "broken: shorted B"][winding]
            }
            3 => {
                faults.stuck_rotor = true;
                "broken: stuck rotor"
            }
            4 => {
                faults.supply_offset = Millivolts(-self.random.within(1_000, 40_000) as i32);
                "broken: supply sags"
            }
            _ => {
                faults.supply_offset = Millivolts(self.random.within(1_000, 45_000) as i32);
                "broken: supply surges"
            }
        };
        self.coverage.count(what);
        faults
    }
}
