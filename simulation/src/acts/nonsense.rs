//! What no program should do.

use dictionary::Entry;

use crate::Simulation;
use crate::invariants::Verdict;

/// Indices at which something could lie.
const INDICES: [u16; 5] = [0x1000, 0x1C00, 0x2000, 0x6000, 0x0000];

impl Simulation {
    /// Controlwords without sense, in any mode.
    pub(crate) fn send_any_controlwords(&mut self) -> Verdict {
        for _ in 0..self.random.within(1, 30) {
            let word = match self.random.below(3) {
                0 => self.random.bits() as u16,
                1 => self.random.pick(&[0x00, 0x02, 0x06, 0x07, 0x0F, 0x1F, 0x80, 0x10F, 0x3F, 0x5F]),
                _ => self.master.commands.controlword ^ 1 << self.random.below(16),
            };
            self.note(|| format!("controlword {word:04X}"));
            self.master.commands.controlword = word;
            if self.random.chance(5) {
                self.master.commands.mode = self.random.bits() as i8;
            }
            self.command()?;
            self.pause(10)?;
        }
        Ok(())
    }

    /// Downloads of any value and size to any object.
    pub(crate) fn download_anything(&mut self) -> Verdict {
        for _ in 0..self.random.within(1, 12) {
            let entry = self.any_entry();
            let (index, sub) = match self.random.below(10) {
                0 => (
                    self.random.pick(&INDICES) + self.random.below(0x200) as u16,
                    self.random.below(4) as u8,
                ),
                1 => (entry.index, self.random.bits() as u8),
                _ => (entry.index, entry.sub),
            };
            let value = self.any_value(&entry);
            let size = match self.random.below(8) {
                0 => self.random.below(9) as usize,
                _ => entry.size(),
            };
            // Without bytes it would be the begin of a transfer in segments.
            let size = if size == 0 { entry.size() } else { size };
            let answer = self.download_bytes(index, sub, &value.to_le_bytes()[..size])?;
            self.note(|| format!("{index:04X}:{sub} = {value:X} in {size} bytes: {answer:X?}"));
            if self.random.chance(30) {
                self.pause(5)?;
            }
        }
        if self.random.chance(60) {
            self.pause(500)?;
            self.restore_order()?;
        }
        Ok(())
    }

    fn any_value(&mut self, entry: &Entry) -> i64 {
        match self.random.below(6) {
            0 => self.random.bits() as i64,
            1 => self.random.pick(&[entry.min, entry.max]),
            2 => self.random.pick(&[entry.min.wrapping_sub(1), entry.max.wrapping_add(1)]),
            3 => self.random.pick(&[0, 1, -1, entry.default]),
            _ => entry
                .min
                .wrapping_add(self.random.below(entry.max.wrapping_sub(entry.min) as u64) as i64),
        }
    }

    /// Requests for any state, with or without acknowledgement.
    pub(crate) fn request_any_state(&mut self) -> Verdict {
        for _ in 0..self.random.within(1, 5) {
            let control = match self.random.below(3) {
                0 => self.random.bits() as u16,
                _ => self.random.pick(&[1, 2, 3, 4, 8, 0x11, 0x12, 0x14, 0x18]),
            };
            let answer = self.request(control);
            self.note(|| format!("AL control {control:04X}: {answer:04X?}"));
            self.pause(100)?;
        }
        Ok(())
    }

    /// Cycles with many lost frames.
    pub(crate) fn lose_frames(&mut self) -> Verdict {
        self.master.loss = self.random.within(1, 80) as u64;
        let loss = self.master.loss;
        self.note(|| format!("{loss} % of frames lost"));
        self.pause(800)?;
        self.master.loss = 0;
        Ok(())
    }

    /// No frames at all for a while: the watchdog's time, or less.
    pub(crate) fn fall_silent(&mut self) -> Verdict {
        let ticks = self.random.scaled(6000);
        self.note(|| format!("silent for {} us", ticks * 50));
        self.ticks(ticks)
    }

    /// Reads of any object, and of those that every tick decides.
    pub(crate) fn read_objects(&mut self) -> Verdict {
        let entry = self.any_entry();
        let expected = self.present(entry.index, entry.sub)[..entry.size()].to_vec();
        let read = self.upload(entry.index, entry.sub)?;
        if read.as_ref().is_some_and(|read| *read != expected) {
            return Err(format!("{:04X}:{} reads {read:X?}, not {expected:X?}", entry.index, entry.sub));
        }
        let register = self.upload(0x1001, 0)?;
        let fault = self.bus.drive().device().drive().fault();
        let expected = fault.map_or(0, |fault| fault.error_register());
        if register.as_ref().is_some_and(|register| *register != [expected]) {
            return Err(format!("1001 reads {register:X?}, not {expected:02X}"));
        }
        self.cycle()
    }
}
