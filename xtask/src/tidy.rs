//! The design's rules as tests: each check reads files and returns findings, none of them changes anything.
//!
//! - [`source`]: a Rust file as tokens with line numbers, and which of its lines are tests.
//! - [`arrows`]: which crate may depend on which, and the README's table of dependencies.
//! - [`layers`]: what a crate below `virtual-drive` must declare and must not call; where `unsafe` may stand.
//! - [`manual`]: every statement of the drive's manual has a test that names it.
//! - [`style`]: names, sizes and words that are not wanted anywhere.
//! - [`text`]: white space and line ends.

mod arrows;
mod layers;
mod manual;
mod source;
mod style;
mod text;

use std::fmt;
use std::fs;
use std::path::Path;

use source::Source;

/// Something to mend.
#[derive(Debug, PartialEq)]
pub struct Finding {
    /// Path from the workspace's root, with forward slashes.
    file: String,
    /// Counted from 1.
    line: usize,
    what: String,
    remedy: String,
}

impl Finding {
    fn new(file: &str, line: usize, what: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self {
            file: file.into(),
            line,
            what: what.into(),
            remedy: remedy.into(),
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}; {}", self.file, self.line, self.what, self.remedy)
    }
}

/// A text file of the workspace.
struct File {
    /// Path from the workspace's root, with forward slashes.
    path: String,
    text: String,
}

/// Runs every check over the workspace and prints what it finds.
pub fn check(root: &Path) -> Result<(), String> {
    let files = read(root)?;
    let mut findings = findings(&files);
    findings.extend(manual::check(&files));
    for finding in &findings {
        eprintln!("{finding}");
    }
    if findings.is_empty() {
        println!("tidy: {} files checked", files.len());
        Ok(())
    } else {
        Err(format!("tidy: {} to mend in {} files", findings.len(), files.len()))
    }
}

/// Writes the book's page of the manual's statements anew.
pub fn renew_manual(root: &Path) -> Result<(), String> {
    let page = manual::page(&read(root)?).map_err(|finding| finding.to_string())?;
    fs::write(root.join(manual::PAGE), page).map_err(|error| format!("{}: {error}", manual::PAGE))
}

fn findings(files: &[File]) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut sources = Vec::new();
    for file in files {
        findings.extend(text::check(file));
        if file.path.ends_with(".rs") {
            match Source::parse(&file.path, &file.text) {
                Ok(source) => sources.push(source),
                Err(line) => findings.push(Finding::new(&file.path, line, "not Rust", "make it compile first")),
            }
        }
    }
    source::mark_test_files(&mut sources);
    for source in &sources {
        findings.extend(layers::check(source));
        findings.extend(style::check(source));
    }
    findings.extend(files.iter().flat_map(style::check_words));
    findings.extend(files.iter().filter_map(|file| style::check_name(&file.path)));
    findings.extend(arrows::check(files));
    findings.sort_by(|a, b| (&a.file, a.line).cmp(&(&b.file, b.line)));
    findings
}

/// Endings of the files that people write; generated and recorded ones are not held to these rules.
const ENDINGS: [&str; 7] = [".rs", ".toml", ".md", ".py", ".sh", ".yml", ".yaml"];

/// Every text file below the root but what builds, fuzzers and Python leave behind.
fn read(root: &Path) -> Result<Vec<File>, String> {
    let mut files = Vec::new();
    let mut folders = vec![root.to_path_buf()];
    while let Some(folder) = folders.pop() {
        let entries = fs::read_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        for entry in entries {
            let entry = entry.map_err(|error| format!("{}: {error}", folder.display()))?;
            let path = entry.path();
            let name = entry.file_name().to_string_lossy().into_owned();
            let kind = entry.file_type().map_err(|error| format!("{}: {error}", path.display()))?;
            if kind.is_dir() {
                if !["target", ".git", "corpus", "artifacts", "__pycache__"].contains(&name.as_str()) {
                    folders.push(path);
                }
            } else if kind.is_file() && (ENDINGS.iter().any(|ending| name.ends_with(ending)) || path.ends_with(".ci/run")) {
                let text = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
                let below = path.strip_prefix(root).unwrap_or(&path);
                files.push(File {
                    path: below.to_string_lossy().replace('\\', "/"),
                    text,
                });
            }
        }
    }
    files.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(path: &str, text: &str) -> File {
        File {
            path: path.into(),
            text: text.into(),
        }
    }

    #[test]
    fn a_finding_says_where_what_and_what_to_do() {
        let finding = Finding::new("crates/esc/src/lib.rs", 7, "trailing white space", "run cargo fmt");
        assert_eq!(finding.to_string(), "crates/esc/src/lib.rs:7: trailing white space; run cargo fmt");
    }

    #[test]
    fn a_clean_crate_has_no_findings() {
        let files = [
            file("crates/wire/Cargo.toml", "[package]\nname = \"wire\"\n"),
            file(
                "crates/wire/src/lib.rs",
                "//! Codecs.\n#![no_std]\n#![forbid(unsafe_code)]\n\npub fn length(bytes: &[u8]) -> usize {\n    bytes.len()\n}\n",
            ),
        ];
        assert_eq!(findings(&files), []);
    }

    #[test]
    fn every_check_reports_into_one_list_sorted_by_place() {
        let files = [
            file(
                "crates/wire/Cargo.toml",
                "[package]\nname = \"wire\"\n[dependencies]\nesc.workspace = true\n",
            ),
            file(
                "crates/wire/src/lib.rs",
                "#![no_std]\n#![forbid(unsafe_code)]\nmod utils;\nfn later() { unimplemented!() } \n",
            ),
            file("crates/wire/src/utils.rs", "fn broken( {}\n"),
        ];
        let places: Vec<_> = findings(&files)
            .iter()
            .map(|finding| (finding.file.clone(), finding.line))
            .collect();
        let expected = [
            ("crates/wire/Cargo.toml", 4),
            ("crates/wire/src/lib.rs", 3),
            ("crates/wire/src/lib.rs", 4),
            ("crates/wire/src/lib.rs", 4),
            ("crates/wire/src/utils.rs", 1),
            ("crates/wire/src/utils.rs", 1),
        ];
        assert_eq!(places, expected.map(|(file, line)| (file.to_string(), line)));
    }
}
