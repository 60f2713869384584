//! `esi` and `sii`.

use std::io::{self, Write};
use std::path::Path;

use super::arguments::{Esi, Sii};
use crate::esi::document;
use crate::kept_folder::write_whole;

pub(super) fn esi(options: &Esi) -> anyhow::Result<()> {
    write(options.output.as_deref(), document()?.as_bytes())
}

pub(super) fn sii(options: &Sii) -> anyhow::Result<()> {
    write(options.output.as_deref(), &device::sii::image(options.serial, options.alias))
}

fn write(file: Option<&Path>, contents: &[u8]) -> anyhow::Result<()> {
    match file {
        Some(file) => write_whole(file, contents),
        None => Ok(io::stdout().lock().write_all(contents)?),
    }
}
