//! SOEM, the master of another make, through Python: `tests/python/pysoem_session.py` checks what the drives answer.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use libtest_mimic::Completion;
use tempfile::tempdir;

use super::Case;
use super::cable::Cable;
use super::program::{Ended, Outcome, command, end_of, forbidden, run};

pub const CASES: &[Case] = &[
    (
        "pysoem_holds_two_sessions_with_one_drive",
        || outcome(two_sessions_with_one_drive()),
    ),
    (
        "pysoem_holds_a_session_with_three_drives",
        || outcome(a_session_with_three_drives()),
    ),
    ("pysoem_finds_drives_at_the_other_end_of_a_cable", || {
        outcome(drives_at_the_other_end_of_a_cable())
    }),
    (
        "pysoem_reads_the_event_log_and_restores_parameters_from_a_file",
        || outcome(files()),
    ),
    ("an_alias_that_pysoem_writes_outlasts_the_program", || {
        outcome(an_alias_that_outlasts_the_program())
    }),
];

/// Why there is no master, and what to do about it.
const MISSING: &str =
    "needs pysoem: python3 -m venv target/python && target/python/bin/pip install --requirement tests/python/requirements.txt";

/// An error of a test here is the reason why it cannot be run.
fn outcome(ended: Result<(), String>) -> Outcome {
    Ok(ended.map_or_else(Completion::ignored_with, |()| Completion::Completed))
}

/// A Python that has pysoem: the workspace's own, or the machine's.
fn python(root: &Path) -> Option<PathBuf> {
    let own = root.join("target/python/bin/python");
    let knows_pysoem = |python: &PathBuf| {
        let tried = Command::new(python).args(["-c", "import pysoem"]).stdin(Stdio::null()).output();
        tried.is_ok_and(|output| output.status.success())
    };
    [own, "python3".into()].into_iter().find(knows_pysoem)
}

/// The command line of a script of `tests/python`.
fn script(name: &str, options: &[&str]) -> Result<Vec<String>, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("tests has a parent");
    let python = python(root).ok_or(MISSING)?;
    let words = [python, root.join("tests/python").join(name)].map(|path| path.display().to_string());
    Ok(words.into_iter().chain(options.iter().map(|&option| option.to_owned())).collect())
}

/// Runs a command line in a network of its own.
fn exec(options: &[&str], command: Vec<String>) -> Result<Ended, String> {
    let words = ["exec"].iter().chain(options).chain(&["--"]).map(|&word| word.to_owned());
    let ended = run(words.chain(command));
    forbidden(&ended).map_or(Ok(ended), Err)
}

fn check(session: Ended, drives: usize) {
    session.with(0).prints(&["OK   everything", &format!("drives: {drives})")]);
}

fn two_sessions_with_one_drive() -> Result<(), String> {
    let script = script("pysoem_session.py", &["--sessions", "2"])?;
    check(exec(&[], script)?, 1);
    Ok(())
}

fn a_session_with_three_drives() -> Result<(), String> {
    let script = script("pysoem_session.py", &["--drives", "3", "--sessions", "1"])?;
    check(exec(&["--drives", "3"], script)?, 3);
    Ok(())
}

fn files() -> Result<(), String> {
    let script = script("files.py", &[])?;
    exec(&[], script)?.with(0).prints(&["OK   everything"]);
    Ok(())
}

/// A session with two drives, every frame of it in `capture`.
pub fn recorded_session(capture: &Path) -> Result<(), String> {
    let script = script("pysoem_session.py", &["--drives", "2", "--sessions", "1", "--distance", "1000"])?;
    let ended = exec(&["--drives", "2", "--record", &capture.display().to_string()], script)?;
    check(ended, 2);
    Ok(())
}

/// `usr2556e run` at one end of a cable between two interfaces of this machine, pysoem at the other.
fn drives_at_the_other_end_of_a_cable() -> Result<(), String> {
    let script = script("pysoem_session.py", &["--drives", "2", "--sessions", "1", "--distance", "1000"])?;
    let cable = Cable::lay()?;
    let mut drives = command(["run", "--drives", "2", "--interface", &cable.one])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program");
    let mut out = BufReader::new(drives.stdout.take().expect("piped"))
        .lines()
        .map(|line| line.expect("text"));
    let first = out.next();
    let session = end_of(Command::new(&script[0]).args(&script[1..]).arg(&cable.other));
    // Ctrl-C.
    end_of(Command::new("kill").args(["-INT", &drives.id().to_string()])).with(0);
    let lines: Vec<_> = out.collect();
    let ended = Ended::from(drives.wait_with_output().expect("an end")).with(0);
    check(session, 2);

    assert_eq!(
        first,
        Some(format!("Serving 2 drives on {}; Ctrl-C ends.", cable.one)),
        "{}",
        ended.err
    );
    assert_eq!(ended.err, "");
    // Not on a terminal, so there is a line for each change of state.
    for start in ["   1 OP ", "   2 OP ", "   1 INIT ", "   2 INIT "] {
        assert!(lines.iter().any(|line| line.starts_with(start)), "{start:?}: {lines:#?}");
    }
    Ok(())
}

/// The alias is in the drive's file when the program has ended, and the next one starts with it.
fn an_alias_that_outlasts_the_program() -> Result<(), String> {
    let folder = tempdir().expect("a folder");
    let eeproms = folder.path().join("eeproms").display().to_string();
    let options = ["--drives", "2", "--eeprom", &eeproms];
    exec(&options, script("set_alias.py", &["77"])?)?.with(0);
    assert_eq!(
        fs::read(folder.path().join("eeproms/drive-1.sii")).expect("a file"),
        device::sii::image(1, 77)
    );
    assert!(!folder.path().join("eeproms/drive-2.sii").exists());

    let program = super::program::path().display().to_string();
    let scanned = exec(&options, vec![program, "scan".into()])?.with(0);
    let aliases: Vec<_> = scanned.out.lines().filter(|line| line.contains("alias")).collect();
    assert!(aliases[0].contains("alias 77,") && aliases[1].contains("alias 0,"), "{aliases:?}");
    Ok(())
}
