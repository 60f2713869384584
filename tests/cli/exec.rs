//! `usr2556e exec`: commands in a network of their own.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;

use libtest_mimic::Completion;
use tempfile::tempdir;

use super::Case;
use super::program::{Outcome, beside_drives, end_of, forbidden, is_installed, path, run, with_exec};

pub const CASES: &[Case] = &[
    ("the_exit_status_is_passed_on", || with_exec(the_exit_status_is_passed_on)),
    ("a_command_that_is_not_there_is_127", || {
        with_exec(a_command_that_is_not_there_is_127)
    }),
    ("a_file_that_cannot_be_run_is_126", || with_exec(a_file_that_cannot_be_run_is_126)),
    ("a_signal_is_128_and_its_number", || with_exec(a_signal_is_128_and_its_number)),
    ("the_command_finds_its_interface", || with_exec(the_command_finds_its_interface)),
    ("input_and_output_are_the_commands", || with_exec(input_and_output_are_the_commands)),
    ("nothing_is_left_behind", || with_exec(nothing_is_left_behind)),
    ("a_user_without_rights_needs_none", a_user_without_rights_needs_none),
];

fn the_exit_status_is_passed_on() {
    for code in [0, 1, 3, 255] {
        beside_drives(&[], &format!("exit {code}")).with(code);
    }
}

fn a_command_that_is_not_there_is_127() {
    run(["exec", "--", "usr2556e-no-such-command"])
        .with(127)
        .says(&["command not found: usr2556e-no-such-command"]);
}

fn a_file_that_cannot_be_run_is_126() {
    let folder = tempdir().unwrap();
    let file = folder.path().join("script");
    fs::write(&file, "#!/bin/sh\n").unwrap();
    let file = file.to_str().unwrap();
    run(["exec", "--", file]).with(126).says(&["not executable", "chmod +x", file]);
}

fn a_signal_is_128_and_its_number() {
    beside_drives(&[], "kill -TERM $$").with(128 + 15);
    beside_drives(&[], "kill -KILL $$").with(128 + 9);
}

fn the_command_finds_its_interface() {
    let script = r#"echo "$USR2556E_INTERFACE"; grep "$USR2556E_INTERFACE:" /proc/net/dev"#;
    let ended = beside_drives(&[], script).with(0);
    assert_eq!(ended.out.lines().next(), Some("usr2556e1"));
}

fn input_and_output_are_the_commands() {
    let folder = tempdir().unwrap();
    let file = folder.path().join("input");
    fs::write(&file, "through\n").unwrap();
    let ended = end_of(
        Command::new(path())
            .args(["exec", "--", "cat"])
            .stdin(fs::File::open(file).unwrap()),
    )
    .with(0);
    assert_eq!((ended.out.as_str(), ended.err.as_str()), ("through\n", ""));
}

fn nothing_is_left_behind() {
    beside_drives(&["--drives", "3"], r#""$USR2556E" scan >/dev/null"#).with(0);
    let left: Vec<_> = fs::read_to_string("/proc/net/dev")
        .unwrap()
        .lines()
        .filter(|line| line.trim_start().starts_with("usr2556e"))
        .map(str::to_owned)
        .collect();
    assert_eq!(left, [""; 0]);
}

/// A user may be allowed what root of a container is not, and the other way round, so this is tried separately.
fn a_user_without_rights_needs_none() -> Outcome {
    if end_of(Command::new("id").arg("-u")).out.trim() != "0" {
        return with_exec(|| drop(beside_drives(&[], r#""$USR2556E" scan"#).with(0).prints(&["USR2556E"])));
    }
    if !is_installed("setpriv") {
        return Ok(Completion::ignored_with(
            "needs setpriv (package util-linux) to give root's rights up",
        ));
    }
    // The program may be where only root can look.
    let folder = tempdir()?;
    let program = folder.path().join("usr2556e");
    fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o755))?;
    fs::copy(path(), &program)?;
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755))?;
    let as_nobody = |arguments: &[&str]| {
        let nobody = ["--reuid=65534", "--regid=65534", "--clear-groups", "--"];
        end_of(
            Command::new("setpriv")
                .args(nobody)
                .arg(&program)
                .args(arguments)
                .current_dir(Path::new("/")),
        )
    };
    if let Some(reason) = forbidden(&as_nobody(&["exec", "--", "true"])) {
        return Ok(Completion::ignored_with(reason));
    }
    let scan = format!("{} scan; exit $((7 + $?))", program.display());
    as_nobody(&["exec", "--drives", "2", "--", "sh", "-c", &scan])
        .with(7)
        .prints(&["  1  USR2556E", "  2  USR2556E"]);
    Ok(Completion::Completed)
}
