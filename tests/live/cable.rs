//! A virtual cable between two network interfaces of this machine.

use std::fs;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use super::program::end_of;

/// Long enough for any machine; waited out only where something is wrong.
const PATIENCE: Duration = Duration::from_secs(20);

/// A veth pair, gone when dropped.
pub struct Cable {
    /// The name of one end.
    pub one: String,
    /// The name of the other end.
    pub other: String,
}

impl Cable {
    /// Makes a cable whose both ends are on. An error is the reason why that cannot be done here.
    pub fn lay() -> Result<Self, String> {
        // At most 15 letters, and of nobody else.
        let names = ["d", "m"].map(|end| format!("u2556e{end}{}", std::process::id() % 10_000_000));
        let [one, other] = names;
        ip(&["link", "add", &one, "type", "veth", "peer", "name", &other])?;
        let cable = Self { one, other };
        for end in [&cable.one, &cable.other] {
            ip(&["link", "set", end, "up"]).expect("an interface of one's own");
        }
        cable.await_carrier();
        Ok(cable)
    }

    /// What is sent before the kernel has connected both ends is lost.
    fn await_carrier(&self) {
        let deadline = Instant::now() + PATIENCE;
        let is_up = |end| fs::read_to_string(format!("/sys/class/net/{end}/operstate")).is_ok_and(|state| state.trim() == "up");
        while !(is_up(&self.one) && is_up(&self.other)) {
            assert!(Instant::now() < deadline, "the cable does not come up");
            thread::sleep(Duration::from_millis(10));
        }
    }
}

impl Drop for Cable {
    fn drop(&mut self) {
        // Its other end goes with it.
        let _ = ip(&["link", "del", &self.one]);
    }
}

fn ip(arguments: &[&str]) -> Result<(), String> {
    if Command::new("ip").arg("-Version").stdout(Stdio::null()).status().is_err() {
        return Err("needs ip (package iproute2) to make a virtual cable".into());
    }
    let ended = end_of(Command::new("ip").args(arguments));
    match ended.code {
        Some(0) => Ok(()),
        _ => Err(format!(
            "needs root to make a virtual cable: ip {}: {}",
            arguments.join(" "),
            ended.err.trim()
        )),
    }
}
