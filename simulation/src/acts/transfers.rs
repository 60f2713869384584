//! Transfers in segments and by complete access, which have to do what single ones do.

use crate::Simulation;
use crate::invariants::{Verdict, must};

/// Objects of several entries.
const RECORDS: [u16; 8] = [0x2005, 0x2007, 0x200B, 0x200C, 0x6099, 0x60FE, 0x1600, 0x1C12];

impl Simulation {
    /// A value in segments; what is there afterwards is that value or the one before.
    pub(crate) fn download_segments(&mut self) -> Verdict {
        let entry = self.any_entry();
        let value = self.random.within(entry.min, entry.max.min(i64::MAX - 1)).to_le_bytes();
        let value = &value[..entry.size()];
        // Of what the drive obeys at once nothing would be left to see.
        if [0x2010, 0x6040].contains(&entry.index) {
            return Ok(());
        }
        let before = self.present(entry.index, entry.sub);
        let step = self.random.within(1, 10) as usize;
        let answer = self.download_in_segments((entry.index, entry.sub, false), value, step)?;
        let after = self.present(entry.index, entry.sub);
        self.note(|| format!("{:04X}:{} = {value:X?} in segments of {step}: {answer:X?}", entry.index, entry.sub));
        if answer == Some(Ok(())) {
            self.coverage.count("segments taken");
            must(after[..value.len()] == *value, || {
                format!("{:04X}:{} is {after:X?} after segments", entry.index, entry.sub)
            })?;
        } else {
            must(after == before, || {
                format!("{:04X}:{} changed by refused segments", entry.index, entry.sub)
            })?;
        }
        self.restore_order()
    }

    /// All entries of an object at once: what is read is what single uploads read, and written back it changes nothing.
    pub(crate) fn access_completely(&mut self) -> Verdict {
        let index = self.random.pick(&RECORDS);
        let answer = self.upload_of(index, 0, true)?;
        self.note(|| format!("all of {index:04X}: {answer:X?}"));
        let Some(Ok(image)) = answer else {
            return must(answer.is_none(), || format!("all of {index:04X} is refused: {answer:X?}"));
        };
        self.coverage.count("complete access");
        let mut at = 2;
        for sub in 1..=image[0] {
            let Some(value) = self.upload(index, sub)? else { continue };
            let there = image.get(at..at + value.len());
            must(there == Some(&value[..]), || {
                format!("{index:04X}:{sub} is {value:X?}, all of it {image:X?}")
            })?;
            at += value.len();
        }
        let before = self.upload_of(index, 0, true)?;
        let step = self.random.within(1, 20) as usize;
        let written = self.download_in_segments((index, 0, true), &image, step)?;
        self.note(|| format!("all of {index:04X} written back: {written:X?}"));
        let after = self.upload_of(index, 0, true)?;
        must(before == after, || format!("{index:04X} written back as {before:X?} is {after:X?}"))?;
        self.cycle()
    }
}
