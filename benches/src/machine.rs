//! One line about the machine, without which no figure means anything.

use std::fs;
use std::thread;

/// CPU model, number of CPUs, kernel and the load right now.
pub fn describe() -> String {
    let cpus = thread::available_parallelism().map_or(1, usize::from);
    let kernel = read("/proc/sys/kernel/osrelease").unwrap_or_else(|| std::env::consts::OS.into());
    let load = read("/proc/loadavg").and_then(|line| line.split_whitespace().next().map(str::to_owned));
    let load = load.map_or_else(String::new, |load| format!(", load {load}"));
    format!(
        "machine: {} x {cpus}, {kernel}{load}",
        model().unwrap_or_else(|| "unknown CPU".into())
    )
}

fn model() -> Option<String> {
    let text = read("/proc/cpuinfo")?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    line.split_once(':').map(|(_, model)| model.trim().to_owned())
}

fn read(path: &str) -> Option<String> {
    fs::read_to_string(path).ok().map(|text| text.trim().to_owned())
}
