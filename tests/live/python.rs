//! Masters written for Python, as scripts of `tests/python` run them.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use libtest_mimic::Completion;
use tempfile::tempdir;

use super::program::{Ended, Outcome, forbidden, run};
use super::tshark;

/// An error of a test here is the reason why it cannot be run.
pub fn outcome(ended: Result<(), String>) -> Outcome {
    Ok(ended.map_or_else(Completion::ignored_with, |()| Completion::Completed))
}

/// A Python that has a module: the workspace's own, or the machine's.
fn python(root: &Path, module: &str) -> Option<PathBuf> {
    let own = root.join("target/python/bin/python");
    let knows_module = |python: &PathBuf| {
        let tried = Command::new(python)
            .args(["-c", &format!("import {module}")])
            .stdin(Stdio::null())
            .output();
        tried.is_ok_and(|output| output.status.success())
    };
    [own, "python3".into()].into_iter().find(knows_module)
}

/// The command line of a script of `tests/python` that needs a module.
pub fn script(module: &str, name: &str, options: &[&str]) -> Result<Vec<String>, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("tests has a parent");
    let python = python(root, module).ok_or_else(|| {
        format!(
            "needs {module}: python3 -m venv target/python && target/python/bin/pip install --requirement tests/python/requirements.txt"
        )
    })?;
    let words = [python, root.join("tests/python").join(name)].map(|path| path.display().to_string());
    Ok(words.into_iter().chain(options.iter().map(|&option| option.to_owned())).collect())
}

/// Runs a command line in a network of its own, and lets Wireshark's dissector see at least so many frames of it.
pub fn exec(options: &[&str], command: Vec<String>, least_frames: usize) -> Result<Ended, String> {
    let folder = tempdir().expect("a folder");
    exec_recorded(&folder.path().join("session.pcapng"), options, command, least_frames)
}

/// Like [`exec`], with the frames in `capture`.
pub fn exec_recorded(capture: &Path, options: &[&str], command: Vec<String>, least_frames: usize) -> Result<Ended, String> {
    let words = ["exec", "--record", &capture.display().to_string()]
        .iter()
        .chain(options)
        .chain(&["--"])
        .map(|&word| word.to_owned())
        .chain(command)
        .collect::<Vec<_>>();
    let ended = run(words);
    if let Some(reason) = forbidden(&ended) {
        return Err(reason);
    }
    if ended.code == Some(0) && tshark::is_here() {
        tshark::check(capture, least_frames);
    }
    Ok(ended)
}

/// Checks how a session has ended.
pub fn check(session: Ended, drives: usize) {
    session.with(0).prints(&["OK   everything", &format!("drives: {drives})")]);
}
