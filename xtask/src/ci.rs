//! Everything a change must pass, one step after the other; a failed step does not hide the ones after it.

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use crate::{no_std, tidy};

/// A step's outcome, with what failed.
type Outcome = Result<(), String>;

/// A step's name, and what it does in the workspace's root.
type Step = (&'static str, fn(&Path) -> Outcome);

/// The steps in the order in which they run: the quick ones first.
const STEPS: [Step; 6] = [
    ("tidy", tidy::check),
    ("fmt", |root| cargo(root, &["fmt", "--all", "--check"], &[])),
    ("clippy", |root| {
        cargo(
            root,
            &["clippy", "--workspace", "--all-targets", "--keep-going", "--", "-D", "warnings"],
            &[],
        )
    }),
    ("doc", |root| {
        cargo(
            root,
            &["doc", "--workspace", "--no-deps", "--keep-going"],
            &[("RUSTDOCFLAGS", "-D warnings")],
        )
    }),
    ("test", |root| cargo(root, &["test", "--workspace"], &[])),
    ("no-std", no_std::build),
];

/// Reads `--without STEP`, any number of times.
pub fn without<'a>(arguments: &[&'a str]) -> Result<Vec<&'a str>, String> {
    arguments
        .chunks(2)
        .map(|pair| match pair {
            ["--without", step] if STEPS.iter().any(|(name, _)| name == step) => Ok(*step),
            ["--without", step] => Err(format!(
                "no step named {step}; there are {}",
                STEPS.map(|(name, _)| name).join(", ")
            )),
            ["--without"] => Err("--without needs the name of a step".into()),
            other => Err(format!("unknown argument: {}", other[0])),
        })
        .collect()
}

/// Runs all steps but the `skipped` ones; an error names every step that failed.
pub fn run(root: &Path, skipped: &[&str]) -> Outcome {
    let mut summary = String::new();
    let mut failed = Vec::new();
    for (name, step) in STEPS {
        if skipped.contains(&name) {
            summary += &format!("  left out  {name}\n");
            continue;
        }
        println!("\n=== {name} ===");
        let started = Instant::now();
        let outcome = step(root);
        let seconds = started.elapsed().as_secs_f32();
        match outcome {
            Ok(()) => summary += &format!("  ok        {name}, {seconds:.1} s\n"),
            Err(error) => {
                eprintln!("{error}");
                summary += &format!("  FAILED    {name}, {seconds:.1} s\n");
                failed.push(name);
            }
        }
    }
    println!("\n=== summary ===\n{summary}");
    if failed.is_empty() {
        Ok(())
    } else {
        Err(format!("failed: {}", failed.join(", ")))
    }
}

/// Runs the same cargo that started this program.
pub fn cargo(root: &Path, arguments: &[&str], environment: &[(&str, &str)]) -> Outcome {
    let program = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(program)
        .args(arguments)
        .envs(environment.iter().copied())
        .current_dir(root)
        .status()
        .map_err(|error| format!("cargo does not start: {error}"))?;
    if status.success() {
        Ok(())
    } else {
        Err(format!("cargo {} failed", arguments.join(" ")))
    }
}

#[cfg(test)]
mod tests {
    use super::without;

    #[test]
    fn steps_to_leave_out_are_read_from_the_command_line() {
        assert_eq!(without(&[]), Ok(vec![]));
        assert_eq!(without(&["--without", "test", "--without", "doc"]), Ok(vec!["test", "doc"]));
    }

    #[test]
    fn an_unknown_step_or_flag_is_refused_by_name() {
        assert!(without(&["--without", "tests"]).is_err_and(|error| error.contains("tests") && error.contains("clippy")));
        assert!(without(&["--without"]).is_err_and(|error| error.contains("needs")));
        assert!(without(&["--fast", "x"]).is_err_and(|error| error.contains("--fast")));
    }
}
