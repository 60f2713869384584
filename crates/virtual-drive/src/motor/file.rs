//! A motor as a TOML file.
//!
//! The file is what somebody typed off a data sheet, so all of its mistakes are told at once, each with its line, and with what to do.

mod reader;

use std::fs::File;
use std::io::Read;
use std::path::Path;

use anyhow::{Context, bail, ensure};
use toml::de::DeTable;

use super::Motor;
use super::mistake::{Mistake, Mistakes};
use reader::Reader;

/// The largest file that is read.
const SIZE_LIMIT: u64 = 64 * 1024;

/// Reads a motor's file.
///
/// # Errors
/// The file cannot be read, or there are mistakes in it: see [`Mistakes`].
pub fn read(path: &Path) -> anyhow::Result<Motor> {
    let place = || format!("the motor's file {}", path.display());
    let file = File::open(path).with_context(|| format!("cannot open {}", place()))?;
    let mut bytes = Vec::new();
    file.take(SIZE_LIMIT + 1)
        .read_to_end(&mut bytes)
        .with_context(|| format!("cannot read {}", place()))?;
    ensure!(
        bytes.len() as u64 <= SIZE_LIMIT,
        "{} has more than {} KiB; a motor takes less than one",
        place(),
        SIZE_LIMIT / 1024
    );
    let Ok(text) = String::from_utf8(bytes) else {
        bail!("{} is no text in UTF-8; save it as such", place());
    };
    let mut motor = parse(&text).with_context(|| format!("mistakes in {}", place()))?;
    if motor.name.is_empty() {
        motor.name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    }
    Ok(motor)
}

/// A motor from the text of a file. Without a name in it, the name is empty.
///
/// # Errors
/// All mistakes there are.
pub fn parse(text: &str) -> Result<Motor, Mistakes> {
    let document = DeTable::parse(text).map_err(|error| {
        let at = error.span().map_or(0, |span| span.start);
        Mistakes(vec![syntax(text, at, error.message())])
    })?;
    Reader::new(text).read(document.get_ref()).map_err(Mistakes)
}

/// A mistake that leaves no document.
fn syntax(text: &str, at: usize, reason: &str) -> Mistake {
    let line = line_of(text, at);
    let shown = text.lines().nth(line - 1).unwrap_or_default();
    let is_comma = |part: &[u8]| part[0].is_ascii_digit() && part[1] == b',' && part[2].is_ascii_digit();
    let remedy = if shown.as_bytes().windows(3).any(is_comma) {
        "decimals are written with a point, as in 0.9"
    } else if reason.contains("duplicate") {
        "each key and each section can be there once"
    } else {
        "lines are `key = number`, `key = \"text\"`, [section], or a comment after #"
    };
    Mistake {
        line,
        reason: reason.to_owned(),
        remedy: remedy.to_owned(),
    }
}

/// The line of a byte, counted from 1.
fn line_of(text: &str, at: usize) -> usize {
    1 + text.bytes().take(at).filter(|byte| *byte == b'\n').count()
}

#[cfg(test)]
mod tests;
