//! SOEM, the master of another make, through Python: `tests/python/pysoem_session.py` checks what the drives answer.

use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

use tempfile::tempdir;

use super::Case;
use super::cable::Cable;
use super::program::{Ended, command, end_of};
use super::python::{check, exec, outcome, script};
use super::tshark;

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
    ("eight_drifting_clocks_are_aligned_by_pysoem", || {
        outcome(faults("align", 8, &["--clock-drift", "100"]))
    }),
    ("pysoem_leads_drives_out_of_a_watchdog", || outcome(faults("watchdog", 2, &[]))),
    ("pysoem_keeps_drives_in_op_over_a_wire_that_loses_frames", || {
        outcome(faults("loss", 3, &["--lose", "1", "--seed", "1"]))
    }),
];

fn two_sessions_with_one_drive() -> Result<(), String> {
    let script = script("pysoem", "pysoem_session.py", &["--sessions", "2"])?;
    check(exec(&[], script, 10_000)?, 1);
    Ok(())
}

fn a_session_with_three_drives() -> Result<(), String> {
    let script = script("pysoem", "pysoem_session.py", &["--drives", "3", "--sessions", "1"])?;
    check(exec(&["--drives", "3"], script, 5_000)?, 3);
    Ok(())
}

/// What goes wrong on a bus, a part of `tests/python/pysoem_faults.py`.
fn faults(part: &str, drives: usize, options: &[&str]) -> Result<(), String> {
    let count = drives.to_string();
    let script = script("pysoem", "pysoem_faults.py", &["--drives", &count, part])?;
    check(exec(&[&["--drives", &count], options].concat(), script, 1000)?, drives);
    Ok(())
}

fn files() -> Result<(), String> {
    let script = script("pysoem", "files.py", &[])?;
    exec(&[], script, 100)?.with(0).prints(&["OK   everything"]);
    Ok(())
}

/// `usr2556e run` at one end of a cable between two interfaces of this machine, pysoem at the other.
fn drives_at_the_other_end_of_a_cable() -> Result<(), String> {
    let script = script(
        "pysoem",
        "pysoem_session.py",
        &["--drives", "2", "--sessions", "1", "--distance", "1000"],
    )?;
    let cable = Cable::lay()?;
    let folder = tempdir().expect("a folder");
    let capture = folder.path().join("run.pcapng");
    let mut drives = command(["run", "--drives", "2", "--interface", &cable.one, "--record"])
        .arg(&capture)
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
    if tshark::is_here() {
        tshark::check(&capture, 5_000);
    }
    Ok(())
}

/// The alias is in the drive's file when the program has ended, and the next one starts with it.
fn an_alias_that_outlasts_the_program() -> Result<(), String> {
    let folder = tempdir().expect("a folder");
    let kept = folder.path().join("kept").display().to_string();
    let options = ["--drives", "2", "--keep", &kept];
    exec(&options, script("pysoem", "set_alias.py", &["77"])?, 100)?.with(0);
    assert_eq!(
        fs::read(folder.path().join("kept/drive-1.sii")).expect("a file"),
        device::sii::image(1, 77)
    );
    assert!(!folder.path().join("kept/drive-2.sii").exists());

    let program = super::program::path().display().to_string();
    let scanned = exec(&options, vec![program, "scan".into()], 100)?.with(0);
    let aliases: Vec<_> = scanned.out.lines().filter(|line| line.contains("alias")).collect();
    assert!(aliases[0].contains("alias 77,") && aliases[1].contains("alias 0,"), "{aliases:?}");
    Ok(())
}
