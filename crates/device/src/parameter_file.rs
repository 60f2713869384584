//! The saved parameters as a file of text: a backup when it is read, restored when it is written.
//!
//! A line sets one object: `2000:00 = 3000`, with index and sub-index in hexadecimal and the value in decimal or `0x`. What follows a `#`
//! is a comment. Lines may come in any order and be left out. A file takes effect as a whole when all of it is there and right, or not at
//! all; it changes the values in effect, as SDO downloads do, and not those in flash memory.

use core::fmt::{self, Arguments, Write};

use dictionary::{Entry, Lookup, MAX_VALUE_SIZE, Objects, lookup};
use drive::{Drive, DriveObjects};
use heapless::Vec;
use slave::files::{File, FileError, Line};
use wire::foe::ErrorCode;

use crate::identity;

/// The device's files.
pub(crate) const FILES: &[File] = &[File {
    name: "parameters.txt",
    writable: true,
}];

const ENTRIES: &[Entry] = DriveObjects::ENTRIES;

/// The longest line before its comment, in bytes.
const MAX_TEXT: usize = 48;
/// What some editors put before a text.
const BYTE_ORDER_MARK: &[u8] = "\u{FEFF}".as_bytes();

/// Lines before the first object.
const HEADING: usize = 2;

/// Appends line number `line` of the file to `out`; false if there is no such line.
pub(crate) fn line(objects: &DriveObjects, line: usize, out: &mut Line) -> bool {
    // A line that does not fit is cut off: with the longest name it has some eighty bytes.
    let Some(position) = line.checked_sub(HEADING) else {
        _ = match line {
            0 => writeln!(
                out,
                "# Parameters of {} ({}, hardware {}, firmware {})",
                identity::NAME,
                identity::DEVICE_NAME,
                identity::HARDWARE_VERSION,
                identity::SOFTWARE_VERSION
            ),
            _ => writeln!(out, "# index:sub-index = value # name, unit"),
        };
        return true;
    };
    let mut saved = ENTRIES.iter().enumerate().filter(|(_, entry)| entry.access.is_saved());
    let Some((slot, entry)) = saved.nth(position) else {
        return false;
    };
    _ = write_line(out, entry, value(objects, slot, entry));
    true
}

/// Writes the line that gives an object a value, for a file of one's own.
///
/// # Errors
/// Those of `out`.
pub fn write_line(out: &mut impl Write, entry: &Entry, value: i64) -> fmt::Result {
    write!(out, "{:04X}:{:02X} = {value} # {}", entry.index, entry.sub, entry.name)?;
    match entry.unit {
        "" => writeln!(out),
        unit => writeln!(out, ", {unit}"),
    }
}

/// The value of an entry of at most 32 bits, as all parameters are.
fn value(objects: &DriveObjects, slot: usize, entry: &Entry) -> i64 {
    let mut bytes = [0; MAX_VALUE_SIZE];
    let size = objects.load(slot, &mut bytes);
    let number = i64::from_le_bytes(bytes);
    if entry.data_type.is_signed() {
        let unused = 64 - 8 * size as u32;
        number << unused >> unused
    } else {
        number
    }
}

/// A file on its way in.
#[derive(Clone, Debug)]
pub(crate) struct ParameterFile {
    /// The objects as they will be.
    staged: DriveObjects,
    /// For each slot the line that sets it; 0 if none does.
    lines: [u32; ENTRIES.len()],
    /// The present line as far as it has come, without its comment.
    text: Vec<u8, MAX_TEXT>,
    in_comment: bool,
    /// Lines that are complete.
    complete: u32,
}

impl ParameterFile {
    pub(crate) const fn new() -> Self {
        Self {
            staged: DriveObjects::new(),
            lines: [0; ENTRIES.len()],
            text: Vec::new(),
            in_comment: false,
            complete: 0,
        }
    }

    /// Begins a file and forgets the last one.
    ///
    /// # Errors
    /// 0x8002 while the motor moves: 0x1011 too restores at standstill only (manual 2.1.6).
    pub(crate) fn begin(&mut self, drive: &Drive, objects: &DriveObjects) -> Result<(), FileError> {
        refuse_while_moving(drive)?;
        *self = Self::new();
        self.staged.clone_from(objects);
        Ok(())
    }

    /// Takes the next bytes.
    ///
    /// # Errors
    /// The first line that is wrong, and why.
    pub(crate) fn take(&mut self, data: &[u8]) -> Result<(), FileError> {
        for &byte in data {
            match byte {
                b'\n' => self.end_line()?,
                _ if self.in_comment => {}
                b'#' => self.in_comment = true,
                _ => self.text.push(byte).map_err(|_| self.wrong(format_args!("is too long")))?,
            }
        }
        Ok(())
    }

    /// Ends the file and sets all objects.
    ///
    /// A file is refused only if no order of SDO downloads could do the same. The current loop's gains are checked as if the drive did not
    /// set them itself: it takes a backup with gains and 0x200B:01 = 1.
    ///
    /// # Errors
    /// The last line if it is wrong; 0x8002 while the motor moves; the first object that the drive refuses. Nothing is set then.
    pub(crate) fn finish(&mut self, drive: &Drive, objects: &mut DriveObjects) -> Result<(), FileError> {
        self.end_line()?;
        refuse_while_moving(drive)?;
        let free = DriveObjects {
            auto_pi: 0,
            ..self.staged.clone()
        };
        for (slot, line, data) in self.values() {
            drive
                .check_write(&free, slot, &data)
                .map_err(|code| wrong(line, format_args!("{}", code.text())))?;
        }
        for (slot, line, data) in self.values() {
            // The staged objects have taken the same value.
            objects
                .store(slot, &data)
                .map_err(|code| wrong(line, format_args!("{}", code.text())))?;
        }
        Ok(())
    }

    /// The objects that the file sets: slot, line and value.
    fn values(&self) -> impl Iterator<Item = (usize, u32, Vec<u8, MAX_VALUE_SIZE>)> {
        let given = self.lines.iter().copied().enumerate().filter(|(_, line)| *line != 0);
        given.map(|(slot, line)| {
            let mut bytes = [0; MAX_VALUE_SIZE];
            let size = self.staged.load(slot, &mut bytes);
            (slot, line, bytes.into_iter().take(size).collect())
        })
    }

    fn end_line(&mut self) -> Result<(), FileError> {
        let text = core::mem::take(&mut self.text);
        let text = match self.complete {
            0 => text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(&text),
            _ => &text,
        };
        if !text.trim_ascii().is_empty() {
            self.set(text)?;
        }
        self.in_comment = false;
        self.complete = self.complete.saturating_add(1);
        Ok(())
    }

    /// Sets the object that a line names.
    fn set(&mut self, text: &[u8]) -> Result<(), FileError> {
        let (index, sub, number) = parse(text).ok_or_else(|| self.wrong(format_args!("is not of the form 2000:00 = 3000")))?;
        let Ok(Lookup::Slot(slot)) = lookup(ENTRIES, index, sub) else {
            return Err(self.wrong(format_args!("there is no object {index:04X}:{sub:02X}")));
        };
        let entry = &ENTRIES[slot];
        if !entry.access.is_saved() {
            return Err(self.wrong(format_args!("{index:04X}:{sub:02X} is no saved parameter")));
        }
        if self.lines[slot] != 0 {
            return Err(self.wrong(format_args!("{index:04X}:{sub:02X} was set in line {}", self.lines[slot])));
        }
        if !(entry.min..=entry.max).contains(&number) {
            let (min, max) = (entry.min, entry.max);
            return Err(self.wrong(format_args!("{index:04X}:{sub:02X} = {number} is not in {min} to {max}")));
        }
        let stored = self.staged.store(slot, &number.to_le_bytes()[..entry.size()]);
        stored.map_err(|code| self.wrong(format_args!("{}", code.text())))?;
        self.lines[slot] = self.complete.saturating_add(1);
        Ok(())
    }

    /// The error of the present line.
    fn wrong(&self, reason: Arguments<'_>) -> FileError {
        wrong(self.complete.saturating_add(1), reason)
    }
}

fn wrong(line: u32, reason: Arguments<'_>) -> FileError {
    FileError::new(ErrorCode::NotDefined, format_args!("line {line}: {reason}"))
}

fn refuse_while_moving(drive: &Drive) -> Result<(), FileError> {
    if drive.is_moving() {
        Err(FileError::new(ErrorCode::AccessDenied, format_args!("the motor moves")))
    } else {
        Ok(())
    }
}

/// Index, sub-index and value of a line that is not empty.
fn parse(text: &[u8]) -> Option<(u16, u8, i64)> {
    let (address, value) = core::str::from_utf8(text).ok()?.split_once('=')?;
    let (index, sub) = address.split_once(':')?;
    Some((
        hexadecimal(index)?.try_into().ok()?,
        hexadecimal(sub)?.try_into().ok()?,
        number(value)?,
    ))
}

/// A number in hexadecimal digits, with or without `0x`.
fn hexadecimal(text: &str) -> Option<u32> {
    let text = text.trim();
    let digits = text.strip_prefix("0x").or(text.strip_prefix("0X")).unwrap_or(text);
    // The library's function takes a sign, which is none here.
    digits.bytes().all(|digit| digit.is_ascii_hexdigit()).then_some(())?;
    u32::from_str_radix(digits, 16).ok()
}

/// A number, decimal or `0x`.
fn number(text: &str) -> Option<i64> {
    let text = text.trim();
    match text.starts_with("0x") || text.starts_with("0X") {
        true => hexadecimal(text).map(i64::from),
        false => text.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use std::format;
    use std::string::String;

    use board::{Millivolts, Sensors};
    use proptest::prelude::*;

    use super::*;

    fn text(objects: &DriveObjects) -> String {
        let mut text = String::new();
        let mut out = Line::new();
        for number in 0.. {
            out.clear();
            if !line(objects, number, &mut out) {
                break;
            }
            assert!(out.ends_with('\n'), "{out}");
            text.push_str(&out);
        }
        text
    }

    /// Writes a file to a drive that stands, in pieces of this size.
    fn write(objects: &mut DriveObjects, text: &[u8], piece: usize) -> Result<(), FileError> {
        let drive = Drive::new();
        let mut file = ParameterFile::new();
        file.begin(&drive, objects)?;
        text.chunks(piece).try_for_each(|data| file.take(data))?;
        file.finish(&drive, objects)
    }

    fn refusal(text: &str) -> String {
        let mut objects = DriveObjects::new();
        let error = write(&mut objects, text.as_bytes(), 7).unwrap_err();
        assert_eq!(objects, DriveObjects::new(), "nothing is set: {text}");
        error.text.as_str().into()
    }

    #[test]
    fn a_backup_names_every_saved_parameter_and_restores_all_of_them() {
        let mut objects = DriveObjects::new();
        (objects.peak_current, objects.input_6_function, objects.homing_speed_fast) = (2500, 8, 4_000_000_000);
        (objects.auto_pi, objects.current_loop_kp) = (1, 1234);
        let backup = text(&objects);
        assert!(
            backup.starts_with("# Parameters of USR2556E (ECR60, hardware A1, firmware 101B)\n"),
            "{backup}"
        );
        assert!(backup.contains("\n2000:00 = 2500 # Peak Current, mA\n"), "{backup}");
        assert!(backup.contains("\n2007:06 = 8 # Input 6 Function\n"), "{backup}");
        let saved = ENTRIES.iter().filter(|entry| entry.access.is_saved());
        assert_eq!(backup.lines().filter(|line| !line.starts_with('#')).count(), saved.count());

        for piece in [1, 24, 116, 10_000] {
            let mut other = DriveObjects::new();
            write(&mut other, backup.as_bytes(), piece).unwrap();
            assert_eq!(other, objects, "in pieces of {piece}");
        }
    }

    #[test]
    fn lines_may_be_written_as_people_do() {
        for (text, peak_current, idle_current) in [
            ("2000:00 = 200", 200, 50),
            ("2000:00=200\r\n2003:0=7\r\n", 200, 7),
            (
                "\u{FEFF}# made on Windows\r\n\r\n 0x2003:00 = 0x10 # comment = # more\r\n\t2000:0 = 0xC8",
                200,
                16,
            ),
            ("\u{FEFF}2000:00 = +200\n", 200, 50),
            ("", 3000, 50),
            ("# \u{FC}\n\n\n", 3000, 50),
        ] {
            let mut objects = DriveObjects::new();
            write(&mut objects, text.as_bytes(), 5).unwrap_or_else(|error| panic!("{text:?}: {error:?}"));
            assert_eq!(
                (objects.peak_current, objects.idle_current),
                (peak_current, idle_current),
                "{text:?}"
            );
        }
    }

    #[test]
    fn a_file_with_a_wrong_line_is_refused_as_a_whole_and_the_line_is_named() {
        let ahead = "2003:00 = 7\n";
        for (line, reason) in [
            ("2000:00 = 99", "line 2: 2000:00 = 99 is not in 100 to 6000"),
            ("2000:00 = 6001\n2003:00", "line 2: 2000:00 = 6001 is not in 100 to 6000"),
            ("2000:00 = -1", "line 2: 2000:00 = -1 is not in 100 to 6000"),
            ("\n\n7777:00 = 1", "line 4: there is no object 7777:00"),
            ("2005:00 = 2", "line 2: there is no object 2005:00"),
            ("6040:00 = 15", "line 2: 6040:00 is no saved parameter"),
            ("2003:00 = 8", "line 2: 2003:00 was set in line 1"),
            ("2000:00 3000", "line 2: is not of the form 2000:00 = 3000"),
            ("2000 = 3000", "line 2: is not of the form 2000:00 = 3000"),
            ("2000:00 = 3000 mA", "line 2: is not of the form 2000:00 = 3000"),
            ("2000:00 = 0x", "line 2: is not of the form 2000:00 = 3000"),
            ("2000:00 = 0x-1", "line 2: is not of the form 2000:00 = 3000"),
            ("2000:00 = 99999999999999999999", "line 2: is not of the form 2000:00 = 3000"),
            ("12000:00 = 1", "line 2: is not of the form 2000:00 = 3000"),
            ("2000:00 = 3000;\u{FC}", "line 2: is not of the form 2000:00 = 3000"),
            ("2000:00 =                                            3000", "line 2: is too long"),
        ] {
            assert_eq!(refusal(&format!("{ahead}{line}")), reason);
        }
    }

    #[test]
    fn a_file_that_was_begun_anew_leaves_nothing_of_the_one_before() {
        let (drive, mut objects) = (Drive::new(), DriveObjects::new());
        let mut file = ParameterFile::new();
        file.begin(&drive, &objects).unwrap();
        file.take(b"2000:00 = 200\n2003:0").unwrap();
        file.begin(&drive, &objects).unwrap();
        file.take(b"2001:00 = 400").unwrap();
        file.finish(&drive, &mut objects).unwrap();
        assert_eq!((objects.peak_current, objects.resolution), (3000, 400));
    }

    #[test]
    fn what_the_drive_has_changed_meanwhile_stays() {
        let (drive, mut objects) = (Drive::new(), DriveObjects::new());
        let mut file = ParameterFile::new();
        file.begin(&drive, &objects).unwrap();
        file.take(b"2000:00 = 200\n").unwrap();
        (objects.position, objects.idle_current) = (77, 9);
        file.finish(&drive, &mut objects).unwrap();
        assert_eq!((objects.peak_current, objects.position, objects.idle_current), (200, 77, 9));
    }

    #[test]
    fn a_moving_motor_refuses_a_file_at_its_begin_and_at_its_end() {
        let (mut drive, mut objects) = (Drive::new(), DriveObjects::new());
        let mut file = ParameterFile::new();
        file.begin(&drive, &objects).unwrap();
        file.take(b"2000:00 = 200").unwrap();
        drive.set_network(true);
        (objects.mode, objects.target_velocity, objects.controlword) = (3, 10_000, 0x0F);
        // There is no motor to identify, and none to miss.
        (objects.auto_pi, objects.error_detection) = (0, 0);
        let sensors = Sensors {
            bus_voltage: Millivolts(24_000),
            ..Sensors::default()
        };
        for _ in 0..20_000 {
            drive.tick(&sensors, &mut objects);
        }
        assert!(drive.is_moving());
        let refusal = FileError::new(ErrorCode::AccessDenied, format_args!("the motor moves"));
        assert_eq!(file.finish(&drive, &mut objects), Err(refusal.clone()));
        assert_eq!(objects.peak_current, 3000);
        assert_eq!(file.begin(&drive, &objects), Err(refusal));
    }

    proptest! {
        #[test]
        fn any_file_is_taken_or_refused_as_a_whole(
            text in "([0-9A-F]{1,4}:[0-9]{1,2} ?= ?(0x)?[0-9]{1,6}|2000:00 = [0-9]{1,5}|.{0,60})(\r?\n([0-9A-F#x:= -]{0,50}|2003:00 = 5))*",
            piece in 1..130_usize,
        ) {
            let mut objects = DriveObjects::new();
            if write(&mut objects, text.as_bytes(), piece).is_err() {
                prop_assert_eq!(objects, DriveObjects::new());
            }
        }
    }
}
