//! Motions as a machine's program makes them, and as it changes its mind.

use crate::Simulation;
use crate::invariants::Verdict;

/// The largest speed chosen, in pulses/s.
const FASTEST: u64 = 2_000_000;
/// The largest acceleration chosen, in pulses/s^2.
const HARDEST: u64 = 50_000_000;
const MODES: [i8; 4] = [1, 3, 6, 8];

impl Simulation {
    /// PP: one set-point after the other, with all bits of the controlword.
    pub(crate) fn move_by_set_points(&mut self) -> Verdict {
        if !self.prepare(1)? {
            return Ok(());
        }
        for _ in 0..self.random.within(1, 5) {
            self.choose_ramp();
            self.master.commands.target = self.any_target();
            let bits = self.random.pick(&[0x00, 0x00, 0x20, 0x40, 0x60, 0x200, 0x220, 0x240]);
            let commands = self.master.commands;
            self.note(|| format!("set-point {} with bits {bits:03X}, {} pulses/s", commands.target, commands.speed));
            self.master.commands.controlword = 0x0F | bits;
            self.command()?;
            self.master.commands.controlword = 0x1F | bits;
            self.command()?;
            let cycles = self.cycles_of(20);
            self.until(cycles, |simulation| simulation.status(12))?;
            match self.random.below(10) {
                0..4 => {
                    let cycles = self.cycles_of(2500);
                    if self.until(cycles, |simulation| simulation.status(10))? {
                        self.coverage.count("target reached in PP");
                    }
                }
                4..8 => self.pause(400)?,
                _ => self.halt()?,
            }
        }
        self.end_motion()
    }

    /// PV: speeds, reversals, halts.
    pub(crate) fn turn_at_speeds(&mut self) -> Verdict {
        if !self.prepare(3)? {
            return Ok(());
        }
        for _ in 0..self.random.within(1, 5) {
            self.choose_ramp();
            let speed = self.random.scaled(FASTEST) as i32;
            self.master.commands.velocity = speed * self.random.pick(&[1, -1, 0]);
            let commands = self.master.commands;
            self.note(|| format!("{} pulses/s with {} pulses/s^2", commands.velocity, commands.acceleration));
            self.master.commands.controlword = 0x0F;
            self.command()?;
            if self.random.chance(20) {
                self.halt()?;
            } else {
                self.pause(800)?;
            }
        }
        self.end_motion()
    }

    /// CSP: a walk of chance with jumps and missing frames.
    pub(crate) fn follow_targets(&mut self) -> Verdict {
        self.master.commands.target = self.objects().position;
        if !self.prepare(8)? {
            return Ok(());
        }
        let cycles = self.random.within(20, 800);
        let step = self.random.scaled(50) as i64;
        let jumps = self.random.pick(&[0, 0, 1, 5]);
        self.master.loss = self.random.pick(&[0, 0, 1, 10]);
        let loss = self.master.loss;
        self.note(|| format!("{cycles} targets, {step} pulses, {jumps} % jumps, {loss} % of frames lost"));
        let mut speed = 0;
        self.master.commands.target = self.objects().position;
        for _ in 0..cycles {
            speed = (speed + self.random.within(-step, step)).clamp(-40 * step, 40 * step);
            let jump = if self.random.chance(jumps) {
                self.random.within(-20_000, 20_000)
            } else {
                0
            };
            let target = self.master.commands.target;
            self.master.commands.target = target.wrapping_add((speed + jump) as i32);
            self.command()?;
        }
        self.master.loss = 0;
        self.end_motion()
    }

    /// Homing with any method.
    pub(crate) fn home(&mut self) -> Verdict {
        if !self.prepare(6)? {
            return Ok(());
        }
        let method = self
            .random
            .pick(&[17, 17, 18, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 35, 35]);
        let [fast, slow, acceleration] = match self.random.below(3) {
            0 => [FASTEST / 10, FASTEST / 50, HARDEST].map(|most| self.random.scaled(most) as i64),
            _ => [100_000, 5_000, 2_000_000].map(|most| self.random.within(most / 20, most)),
        };
        self.note(|| format!("homing by method {method} at {fast} and {slow} pulses/s"));
        for (index, sub, value) in [
            (0x6098, 0, method),
            (0x6099, 1, fast),
            (0x6099, 2, slow),
            (0x609A, 0, acceleration),
            (0x607C, 0, self.random.pick(&[0, 0, 100, -5000, i64::from(i32::MAX)])),
            (0x204C, 0, self.random.pick(&[0, 0, 0, 1])),
        ] {
            self.download(index, sub, value)?;
        }
        self.master.commands.controlword = 0x0F;
        self.command()?;
        self.master.commands.controlword = 0x1F;
        self.command()?;
        self.pause(20)?;
        if self.random.chance(15) {
            self.pause(1000)?;
            return self.end_motion();
        }
        let cycles = self.cycles_of(6000);
        self.until(cycles, |simulation| simulation.status(10) || simulation.status(13))?;
        if self.status(13) {
            self.coverage.count("homing failed");
        }
        self.end_motion()
    }

    /// One mode after the other while the motor turns.
    pub(crate) fn change_modes(&mut self) -> Verdict {
        if !self.prepare(3)? {
            return Ok(());
        }
        self.choose_ramp();
        self.master.commands.velocity = self.random.within(-100_000, 100_000) as i32;
        self.command()?;
        self.pause(300)?;
        for _ in 0..self.random.within(1, 6) {
            self.master.commands.mode = self.random.pick(&MODES);
            self.master.commands.controlword = self.random.pick(&[0x0F, 0x1F, 0x2F, 0x3F, 0x10F, 0x5F]);
            let commands = self.master.commands;
            self.note(|| format!("mode {} with controlword {:04X}", commands.mode, commands.controlword));
            self.command()?;
            self.pause(150)?;
        }
        self.end_motion()
    }

    /// Probes on any input, with edges by hand or by a motion to come.
    pub(crate) fn arm_probes(&mut self) -> Verdict {
        let function = (self.random.bits() as u16) & 0x3333;
        let inputs = [self.random.within(1, 6), self.random.within(1, 6)];
        self.note(|| format!("probes armed by {function:04X} on IN{} and IN{}", inputs[0], inputs[1]));
        self.download(0x60B8, 0, 0)?;
        self.milliseconds(2)?;
        self.download(0x2007, inputs[0] as u8, 7)?;
        self.download(0x2007, inputs[1] as u8, 8)?;
        self.download(0x60B8, 0, function.into())?;
        if self.random.chance(60) {
            for _ in 0..self.random.within(1, 4) {
                let levels = self.random.below(64) as u8;
                self.set_inputs(levels);
                self.pause(15)?;
            }
            self.set_inputs(0);
        }
        Ok(())
    }

    /// 0x2010, also while it is not allowed.
    pub(crate) fn clear_position(&mut self) -> Verdict {
        let moving = self.bus.drive().device().drive().is_moving();
        let taken = self.download(0x2010, 0, 1)?;
        self.note(|| format!("position cleared: {taken}, moving: {moving}"));
        self.cycle()
    }

    /// Nothing, long enough for standby.
    pub(crate) fn stand_idle(&mut self) -> Verdict {
        self.note(|| "idle".into());
        self.pause(1500)
    }

    /// A ramp of a machine, any ramp, or the one before.
    fn choose_ramp(&mut self) {
        let values = match self.random.below(5) {
            0 | 1 => [100_000, 2_000_000, 2_000_000].map(|most| self.random.within(most / 20, most) as i32),
            2 | 3 => [FASTEST, HARDEST, HARDEST].map(|most| self.random.scaled(most) as i32),
            _ => return,
        };
        let commands = &mut self.master.commands;
        [commands.speed, commands.acceleration, commands.deceleration] = values;
    }

    fn any_target(&mut self) -> i32 {
        match self.random.below(10) {
            0..2 => self.random.within(-110_000, 110_000) as i32,
            2..6 => self.objects().position.wrapping_add(self.random.within(-40_000, 40_000) as i32),
            6 => self.random.within(-3, 3) as i32,
            7 => self.random.bits() as i32,
            8 => self.objects().position.wrapping_add(self.random.within(-500, 500) as i32),
            _ => self.random.pick(&[0, i32::MIN, i32::MAX]),
        }
    }

    fn halt(&mut self) -> Verdict {
        self.note(|| "halt".into());
        self.master.commands.controlword |= 0x100;
        self.command()?;
        self.pause(200)?;
        self.master.commands.controlword &= !0x100;
        self.command()
    }

    /// Up to so many milliseconds.
    pub(crate) fn pause(&mut self, most: u64) -> Verdict {
        let span = self.random.scaled(most);
        self.milliseconds(span)
    }

    /// Stays enabled, or leaves Operation Enabled one way or the other.
    fn end_motion(&mut self) -> Verdict {
        let controlword = self.random.pick(&[0x0F, 0x0F, 0x0F, 0x0F, 0x0F, 0x07, 0x06, 0x02, 0x00, 0x8F]);
        if controlword != 0x0F {
            self.note(|| format!("motion ended by controlword {controlword:04X}"));
        }
        self.master.commands.controlword = controlword;
        self.command()?;
        self.pause(50)
    }
}
