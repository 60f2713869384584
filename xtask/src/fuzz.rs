//! Runs every fuzz target over its corpus and then for some time, two at once, on the stable compiler.
//!
//! `cargo fuzz` builds the programs; they are started directly here, so that what they find lands beside the corpus and not in it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use crate::ci;

/// How cargo-fuzz is to build: without a sanitizer, which would need a nightly compiler and finds nothing in safe code.
const BUILD: [&str; 4] = ["--sanitizer", "none", "--features", "libfuzzer"];
/// Optimisation across crates would take longer than the run of a minute.
const NO_LTO: (&str, &str) = ("CARGO_PROFILE_RELEASE_LTO", "off");

/// Targets that run at once.
const AT_ONCE: usize = 2;
/// An input that takes longer is a finding, in seconds.
const SLOW: u32 = 10;
/// Memory that a target may use, in MB.
const MEMORY: u32 = 1024;

/// Reads `--seconds N`; a minute each without it.
pub fn seconds(arguments: &[&str]) -> Result<u32, String> {
    match arguments {
        [] => Ok(60),
        ["--seconds", number] => number.parse().map_err(|_| format!("not a number of seconds: {number}")),
        other => Err(format!("unknown arguments: {}", other.join(" "))),
    }
}

/// Builds and runs all targets, each for `seconds`, and prints a line for each; an error names those that found something.
pub fn run(root: &Path, seconds: u32) -> Result<(), String> {
    let targets = targets(root)?;
    ci::cargo(root, &[&["fuzz", "build"][..], &BUILD].concat(), &[NO_LTO])?;
    let programs = programs(root)?;
    let mut failed = Vec::new();
    for names in targets.chunks(AT_ONCE) {
        let running: Vec<_> = names
            .iter()
            .map(|name| start(root, &programs, name, seconds).map(|running| (name, running)))
            .collect::<Result<_, _>>()?;
        for (name, (mut child, log)) in running {
            let status = child.wait().map_err(|error| format!("{name}: {error}"))?;
            let log = fs::read(&log).map_err(|error| format!("{}: {error}", log.display()))?;
            let log = String::from_utf8_lossy(&log);
            println!("{}", summary(name, &log));
            if !status.success() {
                println!("{}", finding(name, &log));
                failed.push(name.clone());
            }
        }
    }
    if failed.is_empty() {
        Ok(())
    } else {
        Err(format!("fuzz: something was found by {}", failed.join(", ")))
    }
}

/// The targets, as cargo-fuzz knows them.
fn targets(root: &Path) -> Result<Vec<String>, String> {
    let list = output(Command::new("cargo").args(["fuzz", "list"]).current_dir(root))
        .map_err(|error| format!("{error}; cargo install cargo-fuzz brings what is needed, with a C++ compiler"))?;
    Ok(list.lines().map(str::to_owned).collect())
}

/// The folder of the built programs.
fn programs(root: &Path) -> Result<PathBuf, String> {
    let compiler = output(Command::new("rustc").arg("-vV"))?;
    let host = compiler
        .lines()
        .find_map(|line| line.strip_prefix("host: "))
        .ok_or("rustc tells no host")?;
    let folder = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    Ok(folder.join(host).join("release"))
}

/// Starts a target over its corpus, and tells where its log is. What it finds new goes to a folder below the programs'.
fn start(root: &Path, programs: &Path, name: &str, seconds: u32) -> Result<(Child, PathBuf), String> {
    let new = programs.join("fuzz-new").join(name);
    let log = programs.join("fuzz-new").join(format!("{name}.log"));
    let artifacts = root.join("fuzz/artifacts").join(name);
    for folder in [&new, &artifacts] {
        fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    let file = fs::File::create(&log).map_err(|error| format!("{}: {error}", log.display()))?;
    let child = Command::new(programs.join(name))
        .args([&new, &root.join("fuzz/corpus").join(name)])
        .arg(format!("-artifact_prefix={}/", artifacts.display()))
        .arg(format!("-max_total_time={seconds}"))
        .arg(format!("-timeout={SLOW}"))
        .arg(format!("-rss_limit_mb={MEMORY}"))
        .arg("-print_final_stats=1")
        .stderr(file)
        .spawn()
        .map_err(|error| format!("{name} does not start: {error}"))?;
    Ok((child, log))
}

/// What libFuzzer's log says of a run, in a line.
fn summary(name: &str, log: &str) -> String {
    let statistic = |key: &str| {
        let line = log.lines().find_map(|line| line.strip_prefix("stat::")?.strip_prefix(key));
        line.map_or("?", |value| value.trim_start_matches(':').trim())
    };
    format!(
        "{name:<8} {:>9} executions, {:>6} a second, {:>5} new for the corpus",
        statistic("number_of_executed_units"),
        statistic("average_exec_per_sec"),
        statistic("new_units_added"),
    )
}

/// What a failed run found: the panic, the input, and how to see it again.
fn finding(name: &str, log: &str) -> String {
    let panic: Vec<_> = log.lines().skip_while(|line| !line.contains("panicked at")).take(4).collect();
    match log.lines().find_map(|line| line.split_once("Test unit written to ")) {
        Some((_, input)) => format!(
            "{}\n  input:  {input}\n  again:  {}={} cargo fuzz run {} {name} {input}",
            panic.join("\n"),
            NO_LTO.0,
            NO_LTO.1,
            BUILD.join(" ")
        ),
        None => log.to_owned(),
    }
}

/// Runs a command to its end; what it printed.
fn output(command: &mut Command) -> Result<String, String> {
    let name = format!("{command:?}");
    let output = command
        .stdin(Stdio::null())
        .output()
        .map_err(|error| format!("{name} does not start: {error}"))?;
    if output.status.success() {
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    } else {
        Err(format!("{name} failed: {}", String::from_utf8_lossy(&output.stderr).trim()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOG: &str = "\
INFO: seed corpus\n\
thread 'main' panicked at fuzz/src/bring_up.rs:94:9:\n\
assertion failed\n\
artifact_prefix='/x/'; Test unit written to /x/crash-1\n\
stat::number_of_executed_units: 1200\n\
stat::average_exec_per_sec:     600\n\
stat::new_units_added:          7\n";

    #[test]
    fn seconds_are_a_minute_unless_told() {
        assert_eq!(seconds(&[]), Ok(60));
        assert_eq!(seconds(&["--seconds", "600"]), Ok(600));
        assert!(seconds(&["--seconds", "x"]).is_err() && seconds(&["--fast"]).is_err());
    }

    #[test]
    fn a_run_is_summed_up_in_a_line() {
        let line = summary("sdo", LOG);
        let words: Vec<_> = line.split_whitespace().collect();
        assert_eq!(words[..6], ["sdo", "1200", "executions,", "600", "a", "second,"]);
        assert!(line.contains("7 new"));
        assert!(summary("sdo", "").contains('?'));
    }

    #[test]
    fn a_finding_comes_with_its_input_and_the_command_that_repeats_it() {
        let text = finding("sdo", LOG);
        assert!(text.starts_with("thread 'main' panicked at"));
        assert!(text.ends_with("LTO=off cargo fuzz run --sanitizer none --features libfuzzer sdo /x/crash-1"));
        assert_eq!(finding("sdo", "cannot open"), "cannot open");
    }
}
