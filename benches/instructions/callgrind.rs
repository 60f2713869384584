//! Valgrind's callgrind, which counts the instructions of each call of a function.

use std::io;
use std::path::Path;
use std::process::{Command, Stdio};

/// Whether callgrind is there, with its version; or why it is not.
///
/// # Errors
/// What the system says.
pub fn version() -> io::Result<String> {
    let output = Command::new("valgrind").arg("--version").stderr(Stdio::null()).output()?;
    Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

/// Runs this program again with `arguments` and counts the instructions of each call of `function`, and of what it calls.
///
/// # Errors
/// Callgrind does not run, or `file`, in which it leaves its figures, cannot be read.
pub fn count(function: &str, arguments: &[&str], file: &Path) -> io::Result<Vec<u64>> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--combine-dumps=yes", "--dump-instr=no", "--dump-line=no"])
        .arg(format!("--toggle-collect={function}"))
        .arg(format!("--dump-after={function}"))
        .arg(format!("--callgrind-out-file={}", file.display()))
        .arg(std::env::current_exe()?)
        .args(arguments)
        .output()?;
    if !output.status.success() {
        return Err(io::Error::other(String::from_utf8_lossy(&output.stderr).into_owned()));
    }
    let text = std::fs::read_to_string(file)?;
    Ok(totals(&text))
}

/// The instructions of each part of callgrind's figures. Each call ends a part; the last part is what came after the last call.
fn totals(text: &str) -> Vec<u64> {
    let mut totals: Vec<u64> = text
        .lines()
        .filter_map(|line| line.strip_prefix("totals: "))
        .filter_map(|total| total.trim().parse().ok())
        .collect();
    totals.pop();
    totals
}
