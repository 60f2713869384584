//! Runs the command of `usr2556e exec` and passes on how it ended, by the conventions of shells.
use std::ffi::{OsStr, OsString};
use std::fmt;
use std::io;
use std::process::{Command, ExitStatus};

/// Why a command could not be started.
#[derive(Debug)]
pub struct CommandError {
    program: OsString,
    source: io::Error,
}

impl CommandError {
    /// What a shell would end with: 127 for a command that was not found, 126 for one that is there but cannot be run.
    pub fn exit_code(&self) -> u8 {
        if self.not_found() { 127 } else { 126 }
    }

    /// Where the search path holds a folder that this user may not look into, the system reports that instead.
    fn not_found(&self) -> bool {
        let searched = std::path::Path::new(&self.program).components().count() == 1;
        match self.source.kind() {
            io::ErrorKind::NotFound => true,
            io::ErrorKind::PermissionDenied if searched => {
                let path = std::env::var_os("PATH").unwrap_or_default();
                !std::env::split_paths(&path).any(|folder| folder.join(&self.program).is_file())
            }
            _ => false,
        }
    }
}

impl fmt::Display for CommandError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let program = self.program.display();
        match self.source.kind() {
            io::ErrorKind::NotFound if std::path::Path::new(&self.program).is_file() => {
                write!(f, "cannot run {program}: the interpreter that its first line names is missing")
            }
            _ if self.not_found() => write!(f, "command not found: {program}"),
            io::ErrorKind::PermissionDenied => {
                write!(f, "cannot run {program}: it is not executable\n  chmod +x {program}")
            }
            _ => write!(f, "cannot run {program}: {}", self.source),
        }
    }
}

impl std::error::Error for CommandError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.source)
    }
}

/// Runs `command` (program and arguments) with `environment` added to this process's own, and waits for its end.
///
/// Returns its exit code, or 128 + the signal that ended it.
///
/// Ctrl-C at the terminal reaches the command directly; this process only waits for what the command makes of it. Signals that reach this process alone
/// (SIGTERM, SIGHUP) are handed to the command.
///
/// # Panics
/// If `command` is empty.
pub fn run(command: &[OsString], environment: &[(&str, &OsStr)]) -> Result<u8, CommandError> {
    let [program, arguments @ ..] = command else {
        panic!("a command without a program")
    };
    let failed = |source| CommandError {
        program: program.clone(),
        source,
    };
    let mut command = Command::new(program);
    command.args(arguments).envs(environment.iter().copied());
    wait(&mut command).map(code).map_err(failed)
}

/// Signals are caught from before the command starts until after its end, so that none of them ends this process and orphans the command.
/// A caught signal, unlike an ignored one, is not inherited: the command starts with the system's defaults.
#[cfg(target_os = "linux")]
fn wait(command: &mut Command) -> io::Result<ExitStatus> {
    use nix::sys::signal::{Signal, kill};
    use nix::sys::wait::{Id, WaitPidFlag, waitid};
    use nix::unistd::Pid;
    use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};

    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGQUIT, SIGTERM, SIGHUP])?;
    let catching = signals.handle();
    let mut child = command.spawn()?;
    let pid = i32::try_from(child.id()).map(Pid::from_raw).map_err(io::Error::other)?;
    let forwarder = std::thread::spawn(move || {
        for signal in signals.forever() {
            if let (SIGTERM | SIGHUP, Ok(signal)) = (signal, Signal::try_from(signal)) {
                let _ = kill(pid, signal);
            }
        }
    });
    // The process number stays the child's until `child.wait`, so that no signal can reach a stranger.
    while waitid(Id::Pid(pid), WaitPidFlag::WEXITED | WaitPidFlag::WNOWAIT) == Err(nix::errno::Errno::EINTR) {}
    catching.close();
    let _ = forwarder.join();
    child.wait()
}

#[cfg(not(target_os = "linux"))]
fn wait(command: &mut Command) -> io::Result<ExitStatus> {
    command.status()
}

fn code(status: ExitStatus) -> u8 {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return 128_u8.wrapping_add(signal.to_le_bytes()[0]);
    }
    status.code().map_or(u8::MAX, |code| code.to_le_bytes()[0])
}
