//! What of the drives outlasts the program: a folder with two files a drive, its EEPROM and the flash memory of its parameters.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use device::sii;

use crate::drive::{DriveConfig, VirtualDrive};
use crate::segment::VirtualSegment;

/// A memory of a drive.
#[derive(Clone, Copy)]
enum Memory {
    Eeprom,
    Parameters,
}

impl Memory {
    const ALL: [Self; 2] = [Self::Eeprom, Self::Parameters];

    /// What messages call its file.
    const fn name(self) -> &'static str {
        match self {
            Self::Eeprom => "EEPROM file",
            Self::Parameters => "parameter file",
        }
    }

    const fn extension(self) -> &'static str {
        match self {
            Self::Eeprom => "sii",
            Self::Parameters => "flash",
        }
    }

    /// The contents, and how often they were written.
    fn of(self, drive: &VirtualDrive) -> (&[u8], u32) {
        match self {
            Self::Eeprom => (drive.chip().eeprom(), drive.chip().eeprom_writes()),
            Self::Parameters => (drive.memory().cells(), drive.memory().writes()),
        }
    }

    /// What to do about a file that is of no use.
    fn remedy(self, file: &Path) -> String {
        match self {
            Self::Eeprom => format!(
                "nothing was changed; move it away to start with a new unit's contents, or write those with: usr2556e sii --output {}",
                file.display()
            ),
            Self::Parameters => "nothing was changed; move it away to start with the parameters of delivery".into(),
        }
    }
}

/// The writes that a memory had seen.
#[derive(Clone, Copy, Default)]
struct Progress {
    /// When its file was last written.
    saved: u32,
    /// At the last look.
    seen: u32,
}

/// The folder, and what of the drives' memories is in it already.
pub struct KeptFolder {
    folder: PathBuf,
    progress: Vec<[Progress; Memory::ALL.len()]>,
}

impl KeptFolder {
    /// Opens the folder for `drives` drives; makes it if it does not exist.
    ///
    /// # Errors
    /// It cannot be made.
    pub fn open(folder: &Path, drives: usize) -> anyhow::Result<Self> {
        fs::create_dir_all(folder)
            .with_context(|| format!("cannot make the folder {}; choose another one with --keep DIR", folder.display()))?;
        Ok(Self {
            folder: folder.to_owned(),
            progress: vec![Default::default(); drives],
        })
    }

    fn file(&self, position: usize, memory: Memory) -> PathBuf {
        self.folder.join(format!("drive-{}.{}", position + 1, memory.extension()))
    }

    /// The drive at `position`, counted from 0: a new unit, but for the memories that have a file.
    ///
    /// # Errors
    /// A file cannot be read, or its contents can be no drive's. It is left as it is.
    pub fn load(&self, position: usize) -> anyhow::Result<DriveConfig> {
        Ok(DriveConfig {
            eeprom: self.load_eeprom(position)?,
            parameters: self.load_memory(position, Memory::Parameters)?,
            ..DriveConfig::numbered(position)
        })
    }

    fn load_eeprom(&self, position: usize) -> anyhow::Result<Option<[u8; sii::SIZE]>> {
        let image = self.load_memory(position, Memory::Eeprom)?;
        if image.is_some_and(|image| !wire::sii::is_intact(&image)) {
            let file = self.file(position, Memory::Eeprom);
            let remedy = Memory::Eeprom.remedy(&file);
            bail!(
                "the EEPROM file {} is corrupt: its checksum does not fit its configuration area; {remedy}",
                file.display()
            );
        }
        Ok(image)
    }

    /// A file as a whole; `None` if there is none yet.
    fn load_memory<const SIZE: usize>(&self, position: usize, memory: Memory) -> anyhow::Result<Option<[u8; SIZE]>> {
        let file = self.file(position, memory);
        let bytes = match fs::read(&file) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(error).with_context(|| format!("cannot read the {} {}", memory.name(), file.display())),
        };
        let Ok(contents) = bytes.as_slice().try_into() else {
            bail!(
                "the {} {} is {} bytes long instead of {}; {}",
                memory.name(),
                file.display(),
                bytes.len(),
                SIZE,
                memory.remedy(&file)
            );
        };
        Ok(Some(contents))
    }

    /// Writes the files of memories that have changed and then rested since the last call: masters write EEPROMs word by word.
    ///
    /// # Errors
    /// A file cannot be written; the one of before stays.
    pub fn save_rested(&mut self, segment: &VirtualSegment) -> anyhow::Result<()> {
        self.save(segment, |progress, writes| progress.seen == writes)
    }

    /// Writes the files of all memories that have changed.
    ///
    /// # Errors
    /// A file cannot be written; the one of before stays.
    pub fn save_all(&mut self, segment: &VirtualSegment) -> anyhow::Result<()> {
        self.save(segment, |_, _| true)
    }

    fn save(&mut self, segment: &VirtualSegment, is_due: impl Fn(Progress, u32) -> bool) -> anyhow::Result<()> {
        for (position, drive) in segment.drives().iter().enumerate() {
            for memory in Memory::ALL {
                let (contents, writes) = memory.of(drive);
                let file = self.file(position, memory);
                let progress = &mut self.progress[position][memory as usize];
                if writes != progress.saved && is_due(*progress, writes) {
                    write_whole(&file, contents)?;
                    progress.saved = writes;
                }
                progress.seen = writes;
            }
        }
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
