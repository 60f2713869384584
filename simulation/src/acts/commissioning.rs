//! What the drive is told of its motor: mostly what is right.

use crate::Simulation;
use crate::invariants::Verdict;
use crate::machine::motor_type;

/// What whoever tries the current loop changes, with the values of delivery last: the current, and with 0x200B:01 at 0 the gains.
const CURRENT_LOOP: [(u16, u8, i64, i64, i64); 12] = [
    (0x2000, 0, 100, 6000, 3000),
    (0x2056, 0, 0, 0x80, 0x80),
    (0x2060, 0, 0, 1000, 0),
    (0x2061, 0, 0, 1024, 0),
    (0x2062, 0, 0, 1024, 0),
    (0x200C, 4, 0, 10_000, 1000),
    (0x200C, 5, 1, 10, 1),
    (0x200C, 6, 0, 1000, 256),
    (0x200B, 1, 0, 1, 1),
    (0x200B, 2, 100, 65_535, 1000),
    (0x200B, 3, 0, 10_000, 200),
    (0x200B, 4, 0, 1024, 256),
];

impl Simulation {
    /// Sets what motor there is and what current it bears, as whoever builds the machine does.
    pub(crate) fn commission(&mut self) -> Verdict {
        let motor = self.machine.motor;
        let current = ((motor.rated_current * 1000.0) as i64).min(6000);
        self.note(|| "commissioned".into());
        for (index, sub, value) in [
            (0x200C, 1, motor_type(motor.phases).into()),
            (0x2000, 0, current),
            (0x200C, 6, (motor.back_emf * 1000.0) as i64),
        ] {
            self.download(index, sub, value)?;
        }
        self.commissioned = true;
        Ok(())
    }

    /// Other gains, currents and harmonics, tried in a motion, and mostly given up again.
    pub(crate) fn tune_current_loop(&mut self) -> Verdict {
        if self.random.chance(70) {
            self.prepare(3)?;
        }
        self.coverage.count("current loop tuned");
        for _ in 0..self.random.within(1, 6) {
            let (index, sub, first, last, _) = self.random.pick(&CURRENT_LOOP);
            let value = match index {
                0x2056 => self.random.pick(&[first, last]),
                0x2060 => self.random.scaled(last as u64) as i64,
                _ => self.random.within(first, last),
            };
            let taken = self.download(index, sub, value)?;
            self.note(|| format!("{index:04X}:{sub} = {value}, taken: {taken}"));
            self.pause(50)?;
        }
        self.turn_at_speeds()?;
        if self.random.chance(80) {
            self.note(|| "the current loop as delivered".into());
            for (index, sub, _, _, delivery) in CURRENT_LOOP {
                self.download(index, sub, delivery)?;
            }
            self.commission()?;
        }
        Ok(())
    }

    /// Two phases for three, or three for two.
    pub(crate) fn mistake_the_motor(&mut self) -> Verdict {
        let wrong = 1 - motor_type(self.machine.motor.phases);
        self.note(|| "the wrong kind of motor".into());
        self.coverage.count("motor mistaken");
        self.download(0x200C, 1, wrong.into())?;
        self.master.commands.mode = 3;
        self.enable()?;
        self.turn()?;
        self.commission()
    }

    /// Some speed, whatever the drive makes of it.
    pub(crate) fn turn(&mut self) -> Verdict {
        self.master.commands.velocity = self.random.within(-100_000, 100_000) as i32;
        let velocity = self.master.commands.velocity;
        self.note(|| format!("{velocity} pulses/s"));
        self.command()?;
        self.pause(400)
    }
}
