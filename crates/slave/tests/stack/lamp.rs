//! A small device: a few objects of every width, and commands it can refuse.

use dictionary::{AbortCode, Entry, MAX_VALUE_SIZE, Objects, object_dictionary};
use slave::Application;
use slave::files::{File, FileError, Line};
use wire::coe::Emergency;
use wire::foe::ErrorCode;

object_dictionary! {
    /// Objects of every width and right.
    pub struct LampObjects in slots {
        /// Writable everywhere.
        0x2000:0 brightness: u16 = 50, RW | RX_PDO | TX_PDO | SAVED, in 0..=100, "Brightness";
        /// Writable in PREOP.
        0x2001:0 address: u16 = 1, RW_PREOP, "Address";
        /// Vetoed while locked.
        0x2002:0 guarded: u8 = 7, RW | RX_PDO, "Guarded";
        /// Part.
        0x2005:1 red: u8 = 1, RW | RX_PDO | TX_PDO, "Red" of "Colour";
        /// Part.
        0x2005:2 green: i32 = -2, RW | RX_PDO | TX_PDO, "Green" of "Colour";
        /// One bit.
        0x2006:0 on: bool = false, RW | RX_PDO | TX_PDO, "On";
        /// Eight bytes.
        0x2007:0 wide: u64 = 0x1122_3344_5566_7788, RW | RX_PDO | TX_PDO, "Wide";
        /// Writable everywhere.
        0x2008:1 mixed_first: u16 = 1, RW | RX_PDO, in 0..=10, "First" of "Mixed";
        /// Read only, between entries that are not.
        0x2008:2 mixed_fixed: u8 = 2, RO, "Fixed" of "Mixed";
        /// One bit.
        0x2008:3 mixed_bit: bool = true, RW, "Bit" of "Mixed";
        /// Starts in the middle of a byte, vetoed while locked.
        0x2008:4 mixed_last: i16 = -3, RW, in -10..=10, "Last" of "Mixed";
        /// Read only.
        0x2009:1 sealed: u16 = 9, RO, "Seal" of "Sealed";
        /// Writable in PREOP.
        0x200A:1 preop_only: u16 = 5, RW_PREOP, "Address" of "Station";
        /// Read only.
        0x6041:0 status: u16 = 0x1234, RO | TX_PDO, "Statusword";
        /// Read only, not mappable.
        0x6502:0 modes: u32 = 0x55, RO, "Modes";
    }
}

/// The device.
pub struct Lamp {
    pub objects: LampObjects,
    pub locked: bool,
    pub stored: u32,
    pub restored: u32,
    pub refusal: Option<AbortCode>,
    pub fault: u16,
    /// What `note.txt` holds, in lines of any length up to that of [`Line`].
    pub note: Vec<String>,
    /// What was written of it.
    pub draft: Vec<u8>,
    /// What `note.txt` is refused with when it is finished.
    pub note_refusal: Option<&'static str>,
}

impl Lamp {
    pub fn new() -> Self {
        Self {
            objects: LampObjects::new(),
            locked: false,
            stored: 0,
            restored: 0,
            refusal: None,
            fault: 0,
            note: vec![],
            draft: vec![],
            note_refusal: None,
        }
    }
}

impl Objects for Lamp {
    fn entries(&self) -> &'static [Entry] {
        LampObjects::ENTRIES
    }

    fn load(&self, slot: usize, out: &mut [u8; MAX_VALUE_SIZE]) -> usize {
        self.objects.load(slot, out)
    }

    fn store(&mut self, slot: usize, data: &[u8]) -> Result<(), AbortCode> {
        self.objects.store(slot, data)
    }
}

impl Application for Lamp {
    fn error_register(&self) -> u8 {
        0x21
    }

    fn emergency(&self) -> Emergency {
        Emergency {
            code: self.fault,
            register: if self.fault == 0 { 0 } else { 0x21 },
            vendor: [4, 0, 0, 0, 9],
        }
    }

    fn store_parameters(&mut self) -> Result<(), AbortCode> {
        self.stored += 1;
        self.refusal.map_or(Ok(()), Err)
    }

    fn restore_defaults(&mut self) -> Result<(), AbortCode> {
        self.restored += 1;
        self.refusal.map_or(Ok(()), Err)
    }

    fn may_write(&self, slot: usize) -> Result<(), AbortCode> {
        if self.locked && [slots::guarded, slots::mixed_last].contains(&slot) {
            Err(AbortCode::DeviceState)
        } else {
            Ok(())
        }
    }

    fn files(&self) -> &'static [File] {
        &[
            File {
                name: "fixed.txt",
                writable: false,
            },
            File {
                name: "note.txt",
                writable: true,
            },
        ]
    }

    fn file_line(&self, file: usize, line: usize, out: &mut Line) -> bool {
        let text = match file {
            0 => ["fixed\n"].get(line).copied(),
            _ => self.note.get(line).map(String::as_str),
        };
        text.is_some_and(|text| out.push_str(text).is_ok())
    }

    fn begin_file(&mut self, file: usize) -> Result<(), FileError> {
        assert_eq!(file, 1);
        self.draft.clear();
        if self.locked {
            return Err(FileError::new(ErrorCode::AccessDenied, format_args!("locked")));
        }
        Ok(())
    }

    fn write_file(&mut self, _: usize, data: &[u8]) -> Result<(), FileError> {
        self.draft.extend_from_slice(data);
        Ok(())
    }

    fn finish_file(&mut self, _: usize) -> Result<(), FileError> {
        if let Some(reason) = self.note_refusal {
            return Err(FileError::new(ErrorCode::NotDefined, format_args!("{reason}")));
        }
        self.note = vec![String::from_utf8_lossy(&self.draft).into_owned()];
        Ok(())
    }
}
