//! Runs each case in a process of its own, because a namespace can only be entered by a process with a single thread, and a test harness has more.
//!
//! Where the system forbids namespaces, a case is reported as ignored, with the reason, not as passed.
use libtest_mimic::{Arguments, Completion, Failed, Trial};
use std::process::{Command, ExitCode};

/// In this variable, a process finds the case that it is to run.
const CASE: &str = "USR2556E_TEST_CASE";

/// Ends a process whose case could not be run here; the reason is the last line it printed.
const SKIPPED: i32 = 77;

/// What the lines begin with that a case wants to be seen though it passed.
const REMARK: &str = "measured: ";

/// A test that gets a process for itself.
pub type Case = (&'static str, fn());

/// Runs `cases` as a test program, or the one case that this process was started for.
pub fn main(cases: &[Case]) -> ExitCode {
    if let Ok(wanted) = std::env::var(CASE) {
        let (_, case) = cases.iter().find(|(name, _)| *name == wanted).expect("a case of that name");
        case();
        return ExitCode::SUCCESS;
    }
    let trials = cases
        .iter()
        .map(|&(name, _)| Trial::ignorable_test(name, move || run(name)))
        .collect();
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}

fn run(name: &str) -> Result<Completion, Failed> {
    let output = Command::new(std::env::current_exe()?).env(CASE, name).output()?;
    let printed = String::from_utf8_lossy(&output.stdout);
    for line in printed.lines().filter(|line| line.starts_with(REMARK)) {
        println!("{name}: {line}");
    }
    match output.status.code() {
        Some(0) => Ok(Completion::Completed),
        Some(SKIPPED) => Ok(Completion::ignored_with(printed.lines().last().unwrap_or_default())),
        _ => Err(format!("{}\n{printed}\n{}", output.status, String::from_utf8_lossy(&output.stderr)).into()),
    }
}

/// Ends this case as not run.
pub fn skip(reason: impl std::fmt::Display) -> ! {
    println!("{}", reason.to_string().replace('\n', " "));
    std::process::exit(SKIPPED)
}

/// Enters a namespace, or skips the case where that is forbidden.
pub fn enter() {
    match usr2556e::namespace::enter() {
        Ok(()) => {}
        Err(error @ usr2556e::namespace::EnterError::Forbidden { .. }) => skip(error),
        Err(error) => panic!("{error}"),
    }
}

/// Gives root's rights up for good, if this process has them.
pub fn become_nobody() {
    use nix::unistd::{Gid, Uid, geteuid, setgid, setgroups, setuid};
    if geteuid().is_root() {
        setgroups(&[]).expect("setgroups");
        setgid(Gid::from_raw(65534)).expect("setgid");
        setuid(Uid::from_raw(65534)).expect("setuid");
        // A process that changed its user may otherwise not write its own maps.
        nix::sys::prctl::set_dumpable(true).expect("set_dumpable");
    }
}
