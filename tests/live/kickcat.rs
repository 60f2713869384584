//! KickCAT through its Python bindings: `tests/python/kickcat_session.py` checks what the drives answer.

use super::Case;
use super::python::{check, exec, outcome, script};

pub const CASES: &[Case] = &[("kickcat_holds_a_session_with_two_drives", || outcome(a_session_with_two_drives()))];

fn a_session_with_two_drives() -> Result<(), String> {
    let script = script("kickcat", "kickcat_session.py", &["--drives", "2"])?;
    // Two times the EEPROM and some 500 cycles of process data, in both directions.
    check(exec(&["--drives", "2"], script, 4000)?, 2);
    Ok(())
}
