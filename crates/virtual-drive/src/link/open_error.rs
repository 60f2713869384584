//! Why a network interface could not be opened, and what to type about it.
use std::fmt;
use std::io;

/// Why [`RawLink::open`](super::raw::RawLink::open) failed. `Display` gives the reason in the first line and the remedies, ready to type, below it.
#[derive(Debug)]
pub enum OpenError {
    /// There is no interface of that name.
    Missing {
        /// The name asked for.
        interface: String,
        /// The names there are.
        existing: Vec<String>,
    },
    /// Packet sockets need the capability `CAP_NET_RAW`.
    NoPermission {
        /// The interface asked for.
        interface: String,
    },
    /// The interface is there but switched off.
    Down {
        /// The interface asked for.
        interface: String,
    },
    /// Another drive server answers on this interface.
    AlreadyServed {
        /// The interface asked for.
        interface: String,
        /// The other server's process, where the system tells.
        process: Option<i32>,
    },
    /// This operating system has no packet sockets.
    OnlyOnLinux {
        /// The interface asked for.
        interface: String,
    },
    /// Anything else the system refused.
    System {
        /// The interface asked for.
        interface: String,
        /// What was asked for, to complete "could not ...".
        doing: &'static str,
        /// The system's answer.
        source: io::Error,
    },
}

impl fmt::Display for OpenError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            OpenError::Missing { interface, existing } => missing(f, interface, existing),
            OpenError::NoPermission { interface } => no_permission(f, interface),
            OpenError::Down { interface } => {
                writeln!(f, "network interface {interface:?} is down. To switch it on:")?;
                write!(f, "  sudo ip link set {interface} up")
            }
            OpenError::AlreadyServed { interface, process } => already_served(f, interface, *process),
            OpenError::OnlyOnLinux { interface } => {
                writeln!(
                    f,
                    "cannot open network interface {interface:?}: raw Ethernet works only on Linux so far."
                )?;
                write!(
                    f,
                    "Without a network, the demonstration works here as well: start this program without arguments."
                )
            }
            OpenError::System { interface, doing, source } => write!(f, "could not {doing} on network interface {interface:?}: {source}"),
        }
    }
}

impl std::error::Error for OpenError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            OpenError::System { source, .. } => Some(source),
            _ => None,
        }
    }
}

fn missing(f: &mut fmt::Formatter<'_>, interface: &str, existing: &[String]) -> fmt::Result {
    let names = if existing.is_empty() { "none".into() } else { existing.join(", ") };
    writeln!(f, "there is no network interface {interface:?}. Existing ones: {names}.")?;
    writeln!(
        f,
        "To make a virtual cable, the drives on veth-drive and the master on veth-master:"
    )?;
    writeln!(f, "  sudo ip link add veth-drive type veth peer name veth-master")?;
    writeln!(f, "  sudo ip link set veth-drive up")?;
    write!(f, "  sudo ip link set veth-master up")
}

fn no_permission(f: &mut fmt::Formatter<'_>, interface: &str) -> fmt::Result {
    let program = std::env::current_exe().map_or_else(|_| "usr2556e".into(), |path| path.display().to_string());
    let program = quoted(&program);
    let arguments: String = std::env::args_os()
        .skip(1)
        .map(|argument| format!(" {}", quoted(&argument.to_string_lossy())))
        .collect();
    writeln!(
        f,
        "no permission to send and receive raw Ethernet frames on {interface:?}. Either run it as root:"
    )?;
    writeln!(f, "  sudo {program}{arguments}")?;
    writeln!(f, "or give the program the right to, again after each build:")?;
    writeln!(f, "  sudo setcap cap_net_raw+ep {program}")?;
    writeln!(
        f,
        "or, without any privilege, run the master together with the drives in a network of their own:"
    )?;
    write!(f, "  {program} exec --drives 1 -- COMMAND...")
}

fn already_served(f: &mut fmt::Formatter<'_>, interface: &str, process: Option<i32>) -> fmt::Result {
    let (who, stop) = match process {
        Some(pid) => (format!(" (process {pid})"), format!("kill {pid}")),
        None => (String::new(), "pkill -x usr2556e".into()),
    };
    writeln!(
        f,
        "another drive server{who} is already running on network interface {interface:?};"
    )?;
    writeln!(
        f,
        "with two of them the master would get every frame back twice. Stop the other one:"
    )?;
    writeln!(f, "  {stop}")?;
    write!(f, "or serve these drives elsewhere, with --interface and another name.")
}

/// `word` as a shell takes it for one word.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-./:=+,@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.into()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_reach_the_shell_as_one_word() {
        assert_eq!(quoted("--drives=3"), "--drives=3");
        assert_eq!(quoted("a b"), "'a b'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
        assert_eq!(quoted("$HOME"), "'$HOME'");
        assert_eq!(quoted(""), "''");
    }

    #[test]
    fn a_missing_privilege_names_all_three_ways_out() {
        let text = OpenError::NoPermission { interface: "eth0".into() }.to_string();
        let program = std::env::current_exe().unwrap();
        let program = program.to_str().unwrap();
        assert!(text.contains("\"eth0\""), "{text}");
        assert!(text.contains(&format!("\n  sudo {program}")), "{text}");
        assert!(text.contains(&format!("\n  sudo setcap cap_net_raw+ep {program}")), "{text}");
        assert!(text.contains(&format!("\n  {program} exec --drives 1 -- COMMAND")), "{text}");
    }

    #[test]
    fn a_missing_interface_lists_the_others_and_the_veth_recipe() {
        let text = OpenError::Missing {
            interface: "eth7".into(),
            existing: vec!["lo".into(), "eth0".into()],
        }
        .to_string();
        assert!(
            text.starts_with("there is no network interface \"eth7\". Existing ones: lo, eth0."),
            "{text}"
        );
        assert!(text.contains("ip link add veth-drive type veth peer name veth-master"), "{text}");
    }
}
