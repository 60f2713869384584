//! Why the system forbids namespaces to a user, and what to type about it.
use std::fmt;
use std::io;
use std::path::Path;

/// Why `enter` failed. `Display` gives the reason in the first line and the remedies, ready to type, below it.
#[derive(Debug)]
pub enum EnterError {
    /// The system does not let this user make namespaces.
    Forbidden {
        /// What was asked for, to complete "could not ...".
        doing: &'static str,
        /// The system's answer.
        source: io::Error,
        /// The settings found to stand in the way; none, if something else does.
        obstacles: Vec<Obstacle>,
    },
    /// The process has more than one thread already.
    Threads,
    /// This operating system has no namespaces.
    OnlyOnLinux,
    /// Anything else the system refused.
    System {
        /// What was asked for, to complete "could not ...".
        doing: &'static str,
        /// The system's answer.
        source: io::Error,
    },
}

/// A kernel setting that forbids namespaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Obstacle {
    /// Its name for `sysctl`.
    pub setting: &'static str,
    /// A value that forbids.
    pub forbids: &'static str,
    /// A value that allows.
    pub allows: &'static str,
    /// What it does.
    pub meaning: &'static str,
}

/// All settings known to forbid namespaces to a user: Debian's, Ubuntu's and the kernel's own.
const KNOWN: [Obstacle; 4] = [
    Obstacle {
        setting: "kernel.unprivileged_userns_clone",
        forbids: "0",
        allows: "1",
        meaning: "only root may make user namespaces",
    },
    Obstacle {
        setting: "kernel.apparmor_restrict_unprivileged_userns",
        forbids: "1",
        allows: "0",
        meaning: "AppArmor takes the rights away that a user has in a namespace of their own",
    },
    Obstacle {
        setting: "user.max_user_namespaces",
        forbids: "0",
        allows: "15000",
        meaning: "there may be no user namespaces",
    },
    Obstacle {
        setting: "user.max_net_namespaces",
        forbids: "0",
        allows: "15000",
        meaning: "there may be no network namespaces",
    },
];

impl EnterError {
    /// Sorts the system's refusals into those that a setting explains and others.
    #[cfg(target_os = "linux")]
    pub(super) fn from_system(doing: &'static str, source: io::Error) -> Self {
        // ENOSPC: a limit on the number of namespaces, which the manual page says of no other cause.
        match source.kind() {
            io::ErrorKind::PermissionDenied | io::ErrorKind::StorageFull => EnterError::Forbidden {
                doing,
                source,
                obstacles: obstacles(Path::new("/proc/sys")),
            },
            _ => EnterError::System { doing, source },
        }
    }
}

/// Those of the known settings that forbid, below `settings` (`/proc/sys`).
#[cfg_attr(not(target_os = "linux"), allow(dead_code, reason = "only Linux has these settings"))]
fn obstacles(settings: &Path) -> Vec<Obstacle> {
    let forbids = |obstacle: &Obstacle| {
        let file = settings.join(obstacle.setting.replace('.', "/"));
        std::fs::read_to_string(file).is_ok_and(|value| value.trim() == obstacle.forbids)
    };
    KNOWN.into_iter().filter(forbids).collect()
}

impl fmt::Display for EnterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            EnterError::Forbidden { doing, source, obstacles } => forbidden(f, doing, source, obstacles),
            EnterError::Threads => write!(f, "a namespace must be entered before any thread is started"),
            EnterError::OnlyOnLinux => {
                writeln!(f, "a network for the drives and a command alone works only on Linux.")?;
                write!(
                    f,
                    "Without a network, the demonstration works here as well: start this program without arguments."
                )
            }
            EnterError::System { doing, source } => write!(f, "could not {doing}: {source}"),
        }
    }
}

impl std::error::Error for EnterError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            EnterError::Forbidden { source, .. } | EnterError::System { source, .. } => Some(source),
            EnterError::Threads | EnterError::OnlyOnLinux => None,
        }
    }
}

fn forbidden(f: &mut fmt::Formatter<'_>, doing: &str, source: &io::Error, obstacles: &[Obstacle]) -> fmt::Result {
    writeln!(f, "could not {doing}: {source}.")?;
    for Obstacle {
        setting,
        forbids,
        allows,
        meaning,
    } in obstacles
    {
        writeln!(
            f,
            "The setting {setting} is {forbids}: {meaning}. To allow it until the next start of the system:"
        )?;
        writeln!(f, "  sudo sysctl -w {setting}={allows}")?;
    }
    if obstacles.is_empty() {
        writeln!(
            f,
            "No setting of the kernel explains it; a container (Docker: add --privileged) or a chroot may forbid it."
        )?;
    }
    write!(f, "As root (sudo), the same command may work as it is.")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn settings(values: &[(&str, &str)]) -> Vec<&'static str> {
        let name = std::thread::current().name().unwrap_or_default().replace(':', "_");
        let root = std::env::temp_dir().join(format!("usr2556e-{}-{name}", std::process::id()));
        for (setting, value) in values {
            let file = root.join(setting);
            fs::create_dir_all(file.parent().unwrap()).unwrap();
            fs::write(file, value).unwrap();
        }
        let found = obstacles(&root);
        let _ = fs::remove_dir_all(&root);
        found.into_iter().map(|obstacle| obstacle.setting).collect()
    }

    #[test]
    fn a_setting_that_forbids_is_found() {
        assert_eq!(
            settings(&[("kernel/unprivileged_userns_clone", "0\n")]),
            ["kernel.unprivileged_userns_clone"]
        );
        assert_eq!(
            settings(&[
                ("kernel/apparmor_restrict_unprivileged_userns", "1\n"),
                ("user/max_user_namespaces", "0\n")
            ]),
            ["kernel.apparmor_restrict_unprivileged_userns", "user.max_user_namespaces"]
        );
    }

    #[test]
    fn settings_that_allow_or_are_not_there_are_not_named() {
        assert_eq!(
            settings(&[("kernel/unprivileged_userns_clone", "1\n"), ("user/max_user_namespaces", "96365\n")]),
            [""; 0]
        );
    }

    #[test]
    fn the_text_names_the_setting_and_the_command_that_changes_it() {
        let error = EnterError::Forbidden {
            doing: "become root in a user namespace",
            source: io::ErrorKind::PermissionDenied.into(),
            obstacles: vec![KNOWN[1]],
        };
        let text = error.to_string();
        assert!(
            text.contains("\n  sudo sysctl -w kernel.apparmor_restrict_unprivileged_userns=0\n"),
            "{text}"
        );
    }

    #[test]
    fn without_a_known_setting_the_text_still_says_what_to_do() {
        let text = EnterError::Forbidden {
            doing: "x",
            source: io::ErrorKind::PermissionDenied.into(),
            obstacles: vec![],
        }
        .to_string();
        assert!(text.contains("--privileged") && text.contains("root"), "{text}");
    }
}
