//! The design's arrows: which crate may depend on which, and whether the README names every dependency from outside.

use std::ops::Range;

use toml::de::DeTable;

use super::{File, Finding};

/// Every crate of the house, from the contracts up, with the crates of the house that it may use.
///
/// Tests may use more: development dependencies are free.
const ARROWS: [(&str, &[&str]); 9] = [
    ("board", &[]),
    ("dictionary", &[]),
    ("wire", &[]),
    ("esc", &["wire"]),
    ("slave", &["wire", "dictionary"]),
    ("drive", &["board", "dictionary"]),
    ("device", &["drive", "slave", "board", "dictionary", "wire"]),
    ("plant", &["board"]),
    (TOP, &["board", "dictionary", "wire", "esc", "slave", "drive", "device", "plant"]),
];

/// The one crate that has the standard library.
const TOP: &str = "virtual-drive";

/// What the board support for a microcontroller may use.
const FIRMWARE: (&str, &[&str]) = ("firmware", &["device"]);

const README: &str = "README.md";

/// The crates below `virtual-drive`.
pub fn core_crates() -> impl Iterator<Item = &'static str> {
    ARROWS.iter().map(|(name, _)| *name).filter(|name| *name != TOP)
}

/// Checks every manifest below `crates/`, and `firmware`'s.
pub fn check(files: &[File]) -> Vec<Finding> {
    let readme = files
        .iter()
        .find(|file| file.path == README)
        .map(|file| named_dependencies(&file.text));
    let mut findings = Vec::new();
    for file in files {
        let folder = file.path.strip_suffix("/Cargo.toml").unwrap_or_default();
        let name = folder.strip_prefix("crates/").unwrap_or(folder);
        if folder != FIRMWARE.0 && (name == folder || name.contains('/')) {
            continue;
        }
        let dependencies = match dependencies(&file.text) {
            Ok(dependencies) => dependencies,
            Err(line) => {
                findings.push(Finding::new(&file.path, line, "not TOML", "make cargo read it first"));
                continue;
            }
        };
        match ARROWS.iter().chain([&FIRMWARE]).find(|(known, _)| *known == name) {
            Some((_, allowed)) => findings.extend(check_arrows(file, name, allowed, &dependencies)),
            None => findings.push(Finding::new(
                &file.path,
                1,
                format!("{name} is not in the design"),
                "give it a row in the design and in xtask's table",
            )),
        }
        if let Some(named) = &readme {
            findings.extend(check_readme(file, named, &dependencies));
        }
    }
    findings
}

/// A dependency as a manifest states it.
struct Dependency {
    name: String,
    line: usize,
    for_tests: bool,
}

fn check_arrows(file: &File, name: &str, allowed: &[&str], dependencies: &[Dependency]) -> Vec<Finding> {
    let remedy = match allowed {
        [] => "it may use no crate of the house".to_string(),
        some => format!("it may use only {}", some.join(", ")),
    };
    let forbidden =
        |dependency: &&Dependency| !dependency.for_tests && is_own(&dependency.name) && !allowed.contains(&dependency.name.as_str());
    let finding = |dependency: &Dependency| {
        Finding::new(
            &file.path,
            dependency.line,
            format!("{name} depends on {}", dependency.name),
            remedy.clone(),
        )
    };
    dependencies.iter().filter(forbidden).map(finding).collect()
}

fn check_readme(file: &File, named: &[String], dependencies: &[Dependency]) -> Vec<Finding> {
    let missing = |dependency: &&Dependency| !is_own(&dependency.name) && !named.contains(&dependency.name);
    let finding = |dependency: &Dependency| {
        let what = format!("{} is not in the README's table of dependencies", dependency.name);
        Finding::new(
            &file.path,
            dependency.line,
            what,
            "add a row that says what it is for, or do without",
        )
    };
    dependencies.iter().filter(missing).map(finding).collect()
}

fn is_own(name: &str) -> bool {
    ARROWS.iter().any(|(own, _)| *own == name) || ["usr2556e", "xtask", FIRMWARE.0].contains(&name)
}

/// All dependencies of a manifest, those for one platform and for builds and tests too; the error is a line.
fn dependencies(manifest: &str) -> Result<Vec<Dependency>, usize> {
    let table = DeTable::parse(manifest).map_err(|error| line_of(manifest, error.span().unwrap_or_default()))?;
    let mut found = Vec::new();
    let platforms = table.get_ref().get("target").and_then(|targets| targets.get_ref().as_table());
    let platforms = platforms
        .into_iter()
        .flat_map(|targets| targets.iter())
        .filter_map(|(_, target)| target.get_ref().as_table());
    for table in std::iter::once(table.get_ref()).chain(platforms) {
        for (section, for_tests) in [("dependencies", false), ("build-dependencies", false), ("dev-dependencies", true)] {
            let Some(section) = table.get(section).and_then(|section| section.get_ref().as_table()) else {
                continue;
            };
            for (key, value) in section {
                let renamed = value
                    .get_ref()
                    .as_table()
                    .and_then(|table| table.get("package"))
                    .and_then(|name| name.get_ref().as_str());
                let name = renamed.unwrap_or(key.get_ref().as_ref()).to_string();
                found.push(Dependency {
                    name,
                    line: line_of(manifest, key.span()),
                    for_tests,
                });
            }
        }
    }
    Ok(found)
}

fn line_of(text: &str, span: Range<usize>) -> usize {
    text.as_bytes().iter().take(span.start).filter(|byte| **byte == b'\n').count() + 1
}

/// The names in back quotes in the first column of tables below a heading that speaks of dependencies.
fn named_dependencies(readme: &str) -> Vec<String> {
    let mut inside = false;
    let mut names = Vec::new();
    for line in readme.lines() {
        if line.starts_with('#') {
            inside = line.to_lowercase().contains("dependenc");
        } else if inside && let Some(row) = line.strip_prefix('|') {
            let first = row.split('|').next().unwrap_or_default();
            names.extend(first.split('`').skip(1).step_by(2).map(String::from));
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    fn whats(files: &[(&str, &str)]) -> Vec<(usize, String)> {
        let files: Vec<File> = files
            .iter()
            .map(|(path, text)| File {
                path: (*path).into(),
                text: (*text).into(),
            })
            .collect();
        check(&files).into_iter().map(|finding| (finding.line, finding.what)).collect()
    }

    #[test]
    fn an_arrow_of_the_design_passes_and_any_other_is_found_with_its_line() {
        let manifest = "[package]\nname = \"slave\"\n\n[dependencies]\nwire.workspace = true\nesc = { path = \"../esc\" }\n";
        assert_eq!(
            whats(&[("crates/slave/Cargo.toml", manifest)]),
            [(6, "slave depends on esc".into())]
        );
    }

    #[test]
    fn tests_may_depend_on_any_crate() {
        assert_eq!(
            whats(&[("crates/slave/Cargo.toml", "[dev-dependencies]\nesc.workspace = true\n")]),
            []
        );
    }

    #[test]
    fn dependencies_by_another_name_for_a_platform_or_for_the_build_count() {
        let manifest = "[target.'cfg(unix)'.dependencies]\nchip = { package = \"esc\" }\n[build-dependencies]\ndrive.workspace = true\n";
        let found = whats(&[("crates/slave/Cargo.toml", manifest)]);
        assert_eq!(found, [(4, "slave depends on drive".into()), (2, "slave depends on esc".into())]);
    }

    #[test]
    fn firmware_uses_the_device_only_and_other_folders_are_free() {
        let manifest = "[dependencies]\ndevice = { path = \"../crates/device\" }\nesc = { path = \"../crates/esc\" }\n";
        assert_eq!(whats(&[("firmware/Cargo.toml", manifest)]), [(3, "firmware depends on esc".into())]);
        assert_eq!(whats(&[("fuzz/Cargo.toml", manifest)]), []);
    }

    #[test]
    fn a_crate_that_the_design_does_not_know_is_found() {
        assert_eq!(
            whats(&[("crates/motor/Cargo.toml", "")]),
            [(1, "motor is not in the design".into())]
        );
    }

    #[test]
    fn a_dependency_from_outside_needs_a_row_in_the_readme() {
        let readme = "# USR2556E\n\n## Dependencies\n\n| crate | for |\n|---|---|\n| `heapless` | queues |\n\n## More\n| `toml` | x |\n";
        let manifest = "[dependencies]\nheapless.workspace = true\nwire.workspace = true\n\n[dev-dependencies]\ntoml = \"1\"\n";
        let found = whats(&[(README, readme), ("crates/slave/Cargo.toml", manifest)]);
        assert_eq!(found, [(6, "toml is not in the README's table of dependencies".into())]);
        assert_eq!(whats(&[("crates/slave/Cargo.toml", manifest)]), []);
    }

    #[test]
    fn a_broken_manifest_gives_its_line() {
        assert_eq!(
            whats(&[("crates/slave/Cargo.toml", "[package]\nname = \n")]),
            [(2, "not TOML".into())]
        );
    }
}
