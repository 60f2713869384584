//! Which tests name which statements.

use crate::tidy::{File, Finding};

/// What a line begins with that names statements.
const MARK: &str = "// manual:";

/// A statement named by a test.
#[derive(Debug, PartialEq)]
pub struct Proof {
    pub id: String,
    /// The test's name.
    pub test: String,
    /// Path from the workspace's root, with forward slashes.
    pub file: String,
    /// Where the test names it, counted from 1.
    pub line: usize,
}

/// Everything that tests name, in the order of files and lines, and the names that belong to no test.
pub fn collect(files: &[File]) -> (Vec<Proof>, Vec<Finding>) {
    let (mut proofs, mut findings) = (Vec::new(), Vec::new());
    for file in files.iter().filter(|file| file.path.ends_with(".rs")) {
        let lines: Vec<&str> = file.text.lines().map(str::trim).collect();
        for (index, line) in lines.iter().enumerate() {
            let Some(ids) = line.strip_prefix(MARK) else { continue };
            match test_below(&lines[index + 1..]) {
                Some(test) => proofs.extend(ids.split_whitespace().map(|id| Proof {
                    id: id.into(),
                    test: test.into(),
                    file: file.path.clone(),
                    line: index + 1,
                })),
                None => findings.push(Finding::new(
                    &file.path,
                    index + 1,
                    "no test that runs follows on these statements",
                    "put the line directly above a test",
                )),
            }
        }
    }
    (proofs, findings)
}

/// The name of the test that begins with the first line, comments and attributes before it included. One that is ignored proves nothing.
fn test_below<'a>(lines: &[&'a str]) -> Option<&'a str> {
    let function = lines.iter().position(|line| !line.starts_with("//") && !line.starts_with("#["))?;
    let attributes = &lines[..function];
    let runs = attributes.contains(&"#[test]") && !attributes.iter().any(|line| line.starts_with("#[ignore"));
    let name = lines[function].strip_prefix("fn ")?;
    runs.then(|| name.split('(').next().unwrap_or(name))
}
