//! No object leaves its declared range, whichever way a value came in.

use dictionary::{MAX_VALUE_SIZE, Objects};
use drive::DriveObjects;

use super::{Verdict, View, must};

/// Ticks from one look to the next: a prime, so that it falls everywhere in cycles.
const PERIOD: u32 = 997;

/// Looks at all objects now and then.
#[derive(Clone, Debug, Default)]
pub struct Ranges {
    ticks: u32,
}

impl Ranges {
    /// Looks at a tick.
    ///
    /// # Errors
    /// What does not hold.
    pub fn tick(&mut self, view: &View) -> Verdict {
        self.ticks += 1;
        if self.ticks < PERIOD {
            return Ok(());
        }
        self.ticks = 0;
        check(view.objects)
    }
}

/// Looks at all objects.
///
/// # Errors
/// The first one out of range.
pub fn check(objects: &DriveObjects) -> Verdict {
    for (slot, entry) in DriveObjects::ENTRIES.iter().enumerate() {
        let mut bytes = [0; MAX_VALUE_SIZE];
        let size = objects.load(slot, &mut bytes);
        let unused = 64 - 8 * size as u32;
        let raw = u64::from_le_bytes(bytes) << unused;
        let value = if entry.data_type.is_signed() {
            raw as i64 >> unused
        } else {
            (raw >> unused) as i64
        };
        must((entry.min..=entry.max).contains(&value), || {
            format!("{:04X}:{} = {value} out of {}..={}", entry.index, entry.sub, entry.min, entry.max)
        })?;
    }
    Ok(())
}
