//! Inputs, supply, cable, axis, power.

use board::{InputLevels, Millivolts};
use plant::{Faults, Turns};
use wire::register as reg;

use crate::Simulation;
use crate::invariants::Verdict;

impl Simulation {
    pub(crate) fn set_inputs(&mut self, levels: u8) {
        self.bus.drive_mut().plant_mut().hold_inputs(InputLevels(levels));
    }

    fn set_supply(&mut self, supply: Millivolts) {
        self.bus.drive_mut().plant_mut().set_supply(supply);
    }

    pub(crate) fn set_faults(&mut self, faults: Faults) {
        self.bus.drive_mut().plant_mut().set_faults(faults);
        self.invariants.axis_moved_by_hand();
    }

    pub(crate) fn place_axis(&mut self, place: Turns) {
        self.bus.drive_mut().plant_mut().place(place);
        self.invariants.axis_moved_by_hand();
    }

    pub(crate) fn release_surroundings(&mut self) {
        self.set_inputs(0);
        self.set_supply(self.machine.supply);
        self.set_faults(Faults::default());
        self.bus.set_connected(true);
        self.master.loss = 0;
    }

    /// Inputs held on: limit switches, home, motor offline, whatever their functions are now.
    pub(crate) fn hold_inputs(&mut self) -> Verdict {
        for _ in 0..self.random.within(1, 6) {
            let levels = match self.random.below(3) {
                0 => self.random.below(64) as u8,
                _ => 1 << self.random.below(6),
            };
            self.note(|| format!("inputs {levels:06b} held on"));
            self.set_inputs(levels);
            self.pause(300)?;
            if self.random.chance(50) {
                self.set_inputs(0);
                self.pause(50)?;
            }
        }
        if self.random.chance(80) {
            self.set_inputs(0);
        }
        Ok(())
    }

    /// Too little supply, or too much.
    pub(crate) fn disturb_supply(&mut self) -> Verdict {
        let supply = Millivolts(self.random.within(0, 70_000) as i32);
        self.note(|| format!("supply of {} mV", supply.0));
        self.set_supply(supply);
        self.pause(100)?;
        self.set_supply(self.machine.supply);
        Ok(())
    }

    /// The cable cut for a while.
    pub(crate) fn cut_cable(&mut self) -> Verdict {
        self.note(|| "cable cut".into());
        self.coverage.count("cable cut");
        self.bus.set_connected(false);
        self.pause(500)?;
        self.bus.set_connected(true);
        self.note(|| "cable repaired".into());
        self.pause(20)
    }

    /// The axis pushed by hand, near a switch or anywhere.
    pub(crate) fn push_axis(&mut self) -> Verdict {
        let near = self.random.pick(&[-10.0, 0.0, 1.0, 1.5, 10.0]);
        let place = near + self.random.within(-1500, 1500) as f64 / 1000.0;
        self.note(|| format!("axis pushed to {place} turns"));
        self.place_axis(Turns(place));
        self.cycle()
    }

    /// Off and on again.
    pub(crate) fn cycle_power(&mut self) -> Verdict {
        self.note(|| "power cycle".into());
        self.coverage.count("power cycle");
        self.bus.drive_mut().power_cycle();
        self.follow_restart()?;
        self.milliseconds(3)
    }

    /// The slave controller reset by three letters, which restarts the drive as power-on does.
    pub(crate) fn reset_controller(&mut self) -> Verdict {
        self.note(|| "reset of the slave controller".into());
        let mut taken = true;
        for letter in b"RES" {
            taken &= self.write(reg::RESET, &[*letter]);
        }
        if taken {
            self.coverage.count("reset of the slave controller");
            self.follow_restart()?;
        }
        self.milliseconds(3)
    }

    /// What is known of a drive that has just begun anew.
    fn follow_restart(&mut self) -> Verdict {
        self.invariants.power_cycled();
        self.master.set_up = false;
        self.commissioned = self.random.chance(10);
        self.check_parameters()
    }
}
