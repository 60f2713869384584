//! EEPROM contents that outlast the program: a folder with one file a drive.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use device::sii;

use crate::segment::VirtualSegment;

/// The folder, and what of the drives' contents is in it already.
pub struct EepromFolder {
    folder: PathBuf,
    /// Writes that each drive's EEPROM had seen when its file was last written.
    saved: Vec<u32>,
    /// Writes that each drive's EEPROM had seen at the last look.
    seen: Vec<u32>,
}

impl EepromFolder {
    /// Opens the folder for `drives` drives; makes it if it does not exist.
    ///
    /// # Errors
    /// It cannot be made.
    pub fn open(folder: &Path, drives: usize) -> anyhow::Result<Self> {
        fs::create_dir_all(folder)
            .with_context(|| format!("cannot make the folder {}; choose another one with --eeprom DIR", folder.display()))?;
        Ok(Self {
            folder: folder.to_owned(),
            saved: vec![0; drives],
            seen: vec![0; drives],
        })
    }

    fn file(&self, position: usize) -> PathBuf {
        self.folder.join(format!("drive-{}.sii", position + 1))
    }

    /// The contents for the drive at `position`, counted from 0; `None` if it has no file yet.
    ///
    /// # Errors
    /// The file cannot be read, or is no intact image. It is left as it is.
    pub fn load(&self, position: usize) -> anyhow::Result<Option<[u8; sii::SIZE]>> {
        let file = self.file(position);
        let bytes = match fs::read(&file) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(error).with_context(|| format!("cannot read the EEPROM file {}", file.display())),
        };
        let remedy = format!(
            "nothing was changed; move it away to start with a new unit's contents, or write those with: usr2556e sii --output {}",
            file.display()
        );
        let Ok(image) = <[u8; sii::SIZE]>::try_from(bytes.as_slice()) else {
            bail!(
                "the EEPROM file {} is {} bytes long instead of {}; {remedy}",
                file.display(),
                bytes.len(),
                sii::SIZE
            );
        };
        if !wire::sii::is_intact(&image) {
            bail!(
                "the EEPROM file {} is corrupt: its checksum does not fit its configuration area; {remedy}",
                file.display()
            );
        }
        Ok(Some(image))
    }

    /// Writes the files of drives whose EEPROM has changed and then rested since the last call: masters write word by word.
    ///
    /// # Errors
    /// A file cannot be written; the one of before stays.
    pub fn save_rested(&mut self, segment: &VirtualSegment) -> anyhow::Result<()> {
        for position in 0..self.saved.len() {
            let writes = segment.drives()[position].chip().eeprom_writes();
            if writes == self.seen[position] && writes != self.saved[position] {
                self.save(segment, position)?;
            }
            self.seen[position] = writes;
        }
        Ok(())
    }

    /// Writes the files of all drives whose EEPROM has changed.
    ///
    /// # Errors
    /// A file cannot be written; the one of before stays.
    pub fn save_all(&mut self, segment: &VirtualSegment) -> anyhow::Result<()> {
        (0..self.saved.len())
            .filter(|&position| segment.drives()[position].chip().eeprom_writes() != self.saved[position])
            .collect::<Vec<_>>()
            .into_iter()
            .try_for_each(|position| self.save(segment, position))
    }

    fn save(&mut self, segment: &VirtualSegment, position: usize) -> anyhow::Result<()> {
        let chip = segment.drives()[position].chip();
        write_whole(&self.file(position), chip.eeprom())?;
        self.saved[position] = chip.eeprom_writes();
        Ok(())
    }
}

/// Replaces a file in one step: after a crash there is the old contents or the new, never a mixture.
pub fn write_whole(file: &Path, contents: &[u8]) -> anyhow::Result<()> {
    let mut beside = file.as_os_str().to_owned();
    beside.push(".new");
    let beside = PathBuf::from(beside);
    fs::write(&beside, contents).with_context(|| format!("cannot write {}", beside.display()))?;
    fs::rename(&beside, file).with_context(|| format!("cannot replace {}", file.display()))
}
