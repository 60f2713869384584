//! The program as its users have it: a process with arguments, output and an exit status.

use std::ffi::OsStr;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use libtest_mimic::{Completion, Failed};

/// How a test ends: an error is a failure.
pub type Outcome = Result<Completion, Failed>;

/// Where the program is.
pub fn path() -> &'static Path {
    Path::new(env!("CARGO_BIN_EXE_usr2556e-under-test"))
}

/// The program with arguments, to be started. What it starts finds the program in `$USR2556E`.
pub fn command<S: AsRef<OsStr>>(arguments: impl IntoIterator<Item = S>) -> Command {
    let mut command = Command::new(path());
    command.args(arguments).stdin(Stdio::null()).env("USR2556E", path());
    for variable in ["USR2556E_INTERFACE", "USR2556E_CONTROL"] {
        command.env_remove(variable);
    }
    command
}

/// What a process has left behind.
#[derive(Debug)]
pub struct Ended {
    /// Its exit status; `None` after a signal.
    pub code: Option<i32>,
    /// Its standard output.
    pub out: String,
    /// Its standard error.
    pub err: String,
}

impl From<Output> for Ended {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            out: String::from_utf8_lossy(&output.stdout).into_owned(),
            err: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }
}

impl Ended {
    /// Checks the exit status; shows all output if it is another.
    #[track_caller]
    pub fn with(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "\n{}{}", self.out, self.err);
        self
    }

    /// Checks that all of `texts` stand in standard error, and that it is no panic.
    #[track_caller]
    pub fn says(self, texts: &[&str]) -> Self {
        assert!(!self.err.contains("panicked"), "{}", self.err);
        for text in texts {
            assert!(self.err.contains(text), "{text:?} is missing in:\n{}", self.err);
        }
        self
    }

    /// Checks that all of `texts` stand in standard output.
    #[track_caller]
    pub fn prints(self, texts: &[&str]) -> Self {
        for text in texts {
            assert!(self.out.contains(text), "{text:?} is missing in:\n{}{}", self.out, self.err);
        }
        self
    }
}

/// Runs the program to its end.
pub fn run<S: AsRef<OsStr>>(arguments: impl IntoIterator<Item = S>) -> Ended {
    end_of(&mut command(arguments))
}

/// Runs a process to its end.
pub fn end_of(command: &mut Command) -> Ended {
    command.output().unwrap_or_else(|error| panic!("{command:?}: {error}")).into()
}

/// Runs a shell script beside virtual drives.
pub fn beside_drives(options: &[&str], script: &str) -> Ended {
    run(["exec"].iter().chain(options).chain(&["--", "sh", "-c", script]))
}

/// Why the system forbids networks of one's own, if that is what `usr2556e exec` has ended with.
pub fn forbidden(tried: &Ended) -> Option<String> {
    let forbidden = tried.code == Some(1) && tried.err.contains("As root (sudo), the same command may work as it is.");
    forbidden.then(|| tried.err.lines().next().unwrap_or_default().to_owned())
}

/// Whether a program is installed.
pub fn is_installed(program: &str) -> bool {
    Command::new(program).arg("--version").stdin(Stdio::null()).output().is_ok()
}

/// A test that needs `usr2556e exec`: ignored with the reason where the system forbids it.
pub fn with_exec(test: fn()) -> Outcome {
    match forbidden(&run(["exec", "--", "true"])) {
        Some(reason) => Ok(Completion::ignored_with(reason)),
        None => done(test),
    }
}

/// A test that needs nothing.
pub fn done(test: fn()) -> Outcome {
    test();
    Ok(Completion::Completed)
}
