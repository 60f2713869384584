//! Builds every `#![no_std]` crate for a Cortex-M4F, where a dependency on the standard library cannot hide.
//!
//! Three ways, the first that is at hand: the target's ready-made core library; core built from source, which needs the `rust-src`
//! component of the toolchain in use; the same with the compiler and sources that Debian packages. With none, rustup is asked for the first.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::Command;

const TARGET: &str = "thumbv7em-none-eabihf";

/// `device` brings in everything below it; `esc` and `plant` are the other boxes that claim to need no std.
const CRATES: [&str; 3] = ["device", "esc", "plant"];

/// Debian's compiler, beside whatever rustup has.
const DEBIAN: (&str, &str) = ("/usr/bin/cargo", "/usr/bin/rustc");

const REMEDY: &str = "\
no core library for thumbv7em-none-eabihf; install one of:
  rustup target add thumbv7em-none-eabihf
  rustup component add rust-src
  apt-get install rustc-web cargo-web rust-web-src      (Debian, beside rustup's Rust)";

/// How the build gets a core library for the target.
#[derive(Debug, PartialEq)]
enum Way {
    /// The toolchain in use has it ready-made.
    Installed,
    /// The toolchain in use has the sources.
    OwnSource,
    /// Debian's toolchain has the sources.
    DebianSource,
}

/// Builds the crates in release mode in a target folder of its own, `target/no-std`.
pub fn build(root: &Path) -> Result<(), String> {
    let way = choose()?;
    println!("building {} for {TARGET} {}", CRATES.join(", "), describe(&way));
    let status = command(&way, root)
        .status()
        .map_err(|error| format!("cargo does not start: {error}"))?;
    if status.success() {
        Ok(())
    } else {
        Err(format!(
            "{} do not build for {TARGET} ({}); the compiler says why above",
            CRATES.join(", "),
            describe(&way)
        ))
    }
}

/// The first way at hand; what is on the machine already comes before a download.
fn choose() -> Result<Way, String> {
    if has_core(OsStr::new("rustc")) {
        return Ok(Way::Installed);
    }
    if has_source(OsStr::new("rustc")) {
        return Ok(Way::OwnSource);
    }
    if Path::new(DEBIAN.0).exists() && has_source(OsStr::new(DEBIAN.1)) {
        return Ok(Way::DebianSource);
    }
    println!("asking rustup for {TARGET}");
    let added = Command::new("rustup").args(["target", "add", TARGET]).status();
    if added.is_ok_and(|status| status.success()) && has_core(OsStr::new("rustc")) {
        return Ok(Way::Installed);
    }
    Err(REMEDY.into())
}

fn describe(way: &Way) -> &'static str {
    match way {
        Way::Installed => "with the installed target",
        Way::OwnSource => "with core from this toolchain's rust-src",
        Way::DebianSource => "with Debian's rustc and core from rust-web-src",
    }
}

fn command(way: &Way, root: &Path) -> Command {
    let mut command = match way {
        Way::Installed | Way::OwnSource => Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into())),
        Way::DebianSource => debian_cargo(),
    };
    command
        .current_dir(root)
        .args(["build", "--release", "--target", TARGET, "--target-dir"])
        .arg(target_folder(root));
    for name in CRATES {
        command.args(["--package", name]);
    }
    if *way != Way::Installed {
        // Building core from source is an unstable option of cargo; the variable lets a stable compiler take it.
        command.env("RUSTC_BOOTSTRAP", "1").arg("-Zbuild-std=core");
    }
    command
}

/// Debian's cargo, freed of what rustup's cargo left in the environment of this program.
fn debian_cargo() -> Command {
    let mut command = Command::new(DEBIAN.0);
    command.env("RUSTC", DEBIAN.1);
    for leftover in ["CARGO", "RUSTUP_TOOLCHAIN", "LD_LIBRARY_PATH", "RUSTC_WRAPPER"] {
        command.env_remove(leftover);
    }
    command
}

fn target_folder(root: &Path) -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| root.join("target"), PathBuf::from)
        .join("no-std")
}

fn has_core(rustc: &OsStr) -> bool {
    let folder = print(rustc, &["--print", "target-libdir", "--target", TARGET]);
    let Some(entries) = folder.and_then(|folder| std::fs::read_dir(folder).ok()) else {
        return false;
    };
    entries.flatten().any(|entry| is_core(&entry.file_name()))
}

/// Whether a file of the target's library folder is its core library, `libcore-<hash>.rlib`.
fn is_core(file: &OsStr) -> bool {
    file.to_str()
        .is_some_and(|name| name.starts_with("libcore-") && name.ends_with(".rlib"))
}

fn has_source(rustc: &OsStr) -> bool {
    let sysroot = print(rustc, &["--print", "sysroot"]);
    sysroot.is_some_and(|sysroot| PathBuf::from(sysroot).join("lib/rustlib/src/rust/library/core/Cargo.toml").exists())
}

/// What the compiler prints, without the line's end; nothing if it does not run or refuses.
fn print(rustc: &OsStr, arguments: &[&str]) -> Option<OsString> {
    let mut command = Command::new(rustc);
    if rustc == OsStr::new(DEBIAN.1) {
        command.env_remove("LD_LIBRARY_PATH");
    }
    let output = command.args(arguments).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim_end().into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_core_library_counts_as_an_installed_target() {
        assert!(is_core(OsStr::new("libcore-0123456789abcdef.rlib")));
        assert!(!is_core(OsStr::new("libcompiler_builtins-0123456789abcdef.rlib")));
        assert!(!is_core(OsStr::new("libcore-0123456789abcdef.rmeta")));
    }

    #[test]
    fn core_is_built_from_source_only_where_it_is_not_installed() {
        let arguments = |way: Way| {
            command(&way, Path::new("/"))
                .get_args()
                .map(|argument| argument.to_string_lossy().into_owned())
                .collect::<Vec<_>>()
        };
        let flag = String::from("-Zbuild-std=core");
        assert!(!arguments(Way::Installed).contains(&flag));
        assert!(arguments(Way::OwnSource).contains(&flag));
        assert!(arguments(Way::DebianSource).contains(&flag));
    }

    #[test]
    fn debians_cargo_runs_debians_compiler() {
        let command = command(&Way::DebianSource, Path::new("/"));
        assert_eq!(command.get_program(), DEBIAN.0);
        assert!(
            command
                .get_envs()
                .any(|(name, value)| name == "RUSTC" && value == Some(OsStr::new(DEBIAN.1)))
        );
        assert!(
            command
                .get_envs()
                .any(|(name, value)| name == "RUSTUP_TOOLCHAIN" && value.is_none())
        );
    }
}
