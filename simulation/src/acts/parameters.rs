//! Parameters: changed, saved, restored, and found again at power-on.

use dictionary::{MAX_VALUE_SIZE, Objects};
use drive::DriveObjects;

use crate::Simulation;
use crate::invariants::{Verdict, must};

/// Parameters that change how motions and inputs behave, with values that let the drive go on working.
const LIVELY: [(u16, u8, i64, i64); 16] = [
    (0x2001, 0, 200, 65_535),
    (0x2000, 0, 100, 6000),
    (0x2002, 0, 200, 1000),
    (0x2003, 0, 0, 100),
    (0x2005, 1, 0, 3),
    (0x2005, 2, 0, 3),
    (0x2006, 0, 0, 3),
    (0x2009, 0, 0, 25_600),
    (0x200A, 0, 0, 2000),
    (0x200D, 0, 0, 1),
    (0x204B, 0, 0, 200),
    (0x605A, 0, 0, 6),
    (0x605B, 0, 0, 1),
    (0x605C, 0, 0, 1),
    (0x605E, 0, 0, 2),
    (0x6085, 0, 10_000, 50_000_000),
];

/// The station alias.
const ALIAS: u16 = 0x2150;

/// The values that the next power-on must find: those of delivery until something is saved.
#[derive(Clone, Debug, Default)]
pub struct Kept(Option<Vec<[u8; MAX_VALUE_SIZE]>>);

impl Simulation {
    /// The value of one of the drive's objects, with zeros behind it.
    pub(crate) fn present(&self, index: u16, sub: u8) -> [u8; MAX_VALUE_SIZE] {
        let mut value = [0; MAX_VALUE_SIZE];
        if let Some(slot) = slot(index, sub) {
            self.objects().load(slot, &mut value);
        }
        value
    }

    /// A few parameters changed, in motion or not.
    pub(crate) fn change_parameters(&mut self) -> Verdict {
        for _ in 0..self.random.within(1, 5) {
            let (index, sub, first, last) = self.random.pick(&LIVELY);
            let value = self.random.within(first, last);
            let taken = self.download(index, sub, value)?;
            self.note(|| format!("{index:04X}:{sub} = {value}, taken: {taken}"));
            self.pause(5)?;
        }
        Ok(())
    }

    /// 0x1010 or 0x1011.
    pub(crate) fn save_parameters(&mut self) -> Verdict {
        let index = self.random.pick(&[0x1010, 0x1010, 0x1011]);
        let taken = self.download(index, 1, 1)?;
        self.note(|| format!("{index:04X}:1 = 1, taken: {taken}"));
        self.cycle()
    }

    /// Sees what a download to `index` has done to the memory, which was written `before` times.
    pub(crate) fn follow_memory(&mut self, index: u16, sub: u8, before: u32, taken: Option<bool>) -> Verdict {
        let written = self.bus.drive().memory().writes() != before;
        let asked_for = matches!((index, sub), (0x1010 | 0x1011, 1));
        let may = asked_for && taken != Some(false);
        must(!written || may, || format!("memory written by {index:04X}:{sub}"))?;
        must(written || !asked_for || taken != Some(true), || {
            format!("{index:04X}:{sub} wrote nothing")
        })?;
        if written {
            let save = index == 0x1010;
            self.kept = Kept(save.then(|| values(self.objects())));
            self.coverage.count(if save { "parameters saved" } else { "parameters restored" });
        }
        Ok(())
    }

    /// Compares all objects right after power-on with what was saved.
    pub(crate) fn check_parameters(&mut self) -> Verdict {
        let delivery = values(&DriveObjects::new());
        let kept = self.kept.0.as_ref().unwrap_or(&delivery);
        let found = values(self.objects());
        for (slot, entry) in DriveObjects::ENTRIES.iter().enumerate() {
            let expected = if entry.access.is_saved() { kept[slot] } else { delivery[slot] };
            // The alias is the EEPROM's as soon as the drive has read that.
            must(found[slot] == expected || entry.index == ALIAS, || {
                format!(
                    "{:04X}:{} is {:X?} after power-on, not {expected:X?}",
                    entry.index, entry.sub, found[slot]
                )
            })?;
        }
        Ok(())
    }
}

/// Where an object of the drive is in its table.
pub(crate) fn slot(index: u16, sub: u8) -> Option<usize> {
    DriveObjects::ENTRIES
        .binary_search_by_key(&(index, sub), |entry| (entry.index, entry.sub))
        .ok()
}

/// The values of all the drive's objects, in the order of its table.
pub(crate) fn values(objects: &DriveObjects) -> Vec<[u8; MAX_VALUE_SIZE]> {
    (0..DriveObjects::ENTRIES.len())
        .map(|slot| {
            let mut value = [0; MAX_VALUE_SIZE];
            objects.load(slot, &mut value);
            value
        })
        .collect()
}
