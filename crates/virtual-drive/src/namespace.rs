//! A network of its own, without privileges, for `usr2556e exec`: a user and network namespace that holds nothing but a virtual cable, with the
//! drives on [`DRIVE_INTERFACE`] and the command on [`MASTER_INTERFACE`], and for a ring a second one. It is gone with the last process in it.
//!
//! | module | what it holds |
//! |---|---|
//! | here | [`enter`]: makes the namespaces for this process; [`close_ring`]: the second cable |
//! | `cable` | the virtual cable (veth pair), made over netlink |
//! | [`obstacle`] | why the system forbids all this, and what to type |
//! | [`command`] | [`command::run`]: the command, its signals and its exit status |
pub mod command;
pub mod obstacle;

#[cfg(target_os = "linux")]
mod cable;

pub use obstacle::EnterError;

/// The end of the virtual cable that the drives are on.
pub const DRIVE_INTERFACE: &str = "usr2556e0";

/// The end of the virtual cable that is for the master.
pub const MASTER_INTERFACE: &str = "usr2556e1";

/// The environment variable in which a command finds the name of its end of the cable.
pub const INTERFACE_VARIABLE: &str = "USR2556E_INTERFACE";

/// As [`DRIVE_INTERFACE`], of the cable that closes a ring.
pub const REDUNDANT_DRIVE_INTERFACE: &str = "usr2556e2";

/// As [`MASTER_INTERFACE`], of the cable that closes a ring.
pub const REDUNDANT_MASTER_INTERFACE: &str = "usr2556e3";

/// As [`INTERFACE_VARIABLE`], of the cable that closes a ring.
pub const REDUNDANT_INTERFACE_VARIABLE: &str = "USR2556E_REDUNDANT_INTERFACE";

/// Works only on Linux: always [`EnterError::OnlyOnLinux`] here.
#[cfg(not(target_os = "linux"))]
pub fn enter() -> Result<(), EnterError> {
    Err(EnterError::OnlyOnLinux)
}

/// Works only on Linux: always [`EnterError::OnlyOnLinux`] here.
#[cfg(not(target_os = "linux"))]
pub fn close_ring() -> Result<(), EnterError> {
    Err(EnterError::OnlyOnLinux)
}

#[cfg(target_os = "linux")]
pub use linux::{close_ring, enter};

#[cfg(target_os = "linux")]
mod linux {
    use super::{DRIVE_INTERFACE, EnterError, MASTER_INTERFACE, REDUNDANT_DRIVE_INTERFACE, REDUNDANT_MASTER_INTERFACE, cable};
    use nix::errno::Errno;
    use nix::sched::{CloneFlags, unshare};
    use nix::unistd::{getegid, geteuid};
    use std::fs;
    use std::io;

    /// Moves this process into a network namespace of its own with both interfaces in it, and `lo`, up.
    ///
    /// Who is not root gets a user namespace as well, in which they are root (and elsewhere still themselves). Root needs none, and keeps
    /// its rights to other users' files that way; where root is forbidden to make a network namespace, as in a container, it gets one too.
    ///
    /// Only the calling thread would move, so this must come before any other thread is started; [`EnterError::Threads`] otherwise. After another
    /// error, the process may be in a namespace without a cable and should end.
    pub fn enter() -> Result<(), EnterError> {
        let threads = fs::read_dir("/proc/self/task").map_err(|source| EnterError::System {
            doing: "count this process's threads",
            source,
        })?;
        if threads.count() != 1 {
            return Err(EnterError::Threads);
        }
        if !(geteuid().is_root() && unshare(CloneFlags::CLONE_NEWNET).is_ok()) {
            become_root_of_a_user_namespace()?;
        }
        cable::lay(DRIVE_INTERFACE, MASTER_INTERFACE).map_err(|(doing, source)| EnterError::from_system(doing, source))
    }

    /// Lays the second cable, of a ring, once this process is in a network of its own.
    pub fn close_ring() -> Result<(), EnterError> {
        cable::lay(REDUNDANT_DRIVE_INTERFACE, REDUNDANT_MASTER_INTERFACE).map_err(|(doing, source)| EnterError::from_system(doing, source))
    }

    fn become_root_of_a_user_namespace() -> Result<(), EnterError> {
        let (user, group) = (geteuid(), getegid());
        unshare(CloneFlags::CLONE_NEWUSER | CloneFlags::CLONE_NEWNET)
            .map_err(|error: Errno| EnterError::from_system("make a user and a network namespace", error.into()))?;
        // A group map of one's own needs setgroups switched off first (user_namespaces(7)); kernels before 3.19 do not have it.
        match fs::write("/proc/self/setgroups", "deny") {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(EnterError::from_system("give up setgroups", error)),
            _ => {}
        }
        for (map, id) in [("/proc/self/uid_map", user.as_raw()), ("/proc/self/gid_map", group.as_raw())] {
            fs::write(map, format!("0 {id} 1\n")).map_err(|error| EnterError::from_system("become root in a user namespace", error))?;
        }
        Ok(())
    }
}
