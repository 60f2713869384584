//! The manual's statements and the tests that prove them.
//!
//! `docs/manual.toml` lists what the manual says, section by section. A test names the statements that it proves in a line above it,
//! `// manual: 2.2.24/time 2.3.23/inputs`. Every statement needs a test, and every name a statement; what software cannot show, or does
//! not do yet, has a reason in place of a test. The book's page [`PAGE`] is made from both.
//!
//! - [`table`]: the list
//! - [`names`]: the names in the sources
//! - [`mod@page`]: the page

mod names;
mod page;
mod table;

use super::{File, Finding};
use names::Proof;
use table::{Kind, Table};

/// The page that is made.
pub const PAGE: &str = "docs/src/manual.md";

const TABLE: &str = "docs/manual.toml";
const RENEW: &str = "run cargo xtask manual";

/// Checks names, statements and the page against one another.
pub fn check(files: &[File]) -> Vec<Finding> {
    let table = match read(files) {
        Ok(table) => table,
        Err(finding) => return vec![finding],
    };
    let (proofs, mut findings) = names::collect(files);
    findings.extend(unknown(&table, &proofs));
    findings.extend(unproven(&table, &proofs));
    findings.extend(unannounced(&table, files));
    if text_of(files, PAGE) != Some(page::write(&table, &proofs).as_str()) {
        findings.push(Finding::new(PAGE, 1, format!("not what {TABLE} and the tests make of it"), RENEW));
    }
    findings
}

/// The page as it should be.
pub fn page(files: &[File]) -> Result<String, Finding> {
    Ok(page::write(&read(files)?, &names::collect(files).0))
}

fn read(files: &[File]) -> Result<Table, Finding> {
    let text = text_of(files, TABLE).ok_or_else(|| Finding::new(TABLE, 1, "missing", "list the manual's statements there"))?;
    table::parse(text).map_err(|(line, what)| Finding::new(TABLE, line, what, "see the top of the file for its form"))
}

fn text_of<'a>(files: &'a [File], path: &str) -> Option<&'a str> {
    files.iter().find(|file| file.path == path).map(|file| file.text.as_str())
}

/// Names in tests that no statement has.
fn unknown(table: &Table, proofs: &[Proof]) -> Vec<Finding> {
    let unknown = |proof: &&Proof| table.statements().all(|statement| statement.id != proof.id);
    let finding = |proof: &Proof| {
        Finding::new(
            &proof.file,
            proof.line,
            format!("no statement {}", proof.id),
            format!("name one of {TABLE}"),
        )
    };
    proofs.iter().filter(unknown).map(finding).collect()
}

/// Statements whose tests are missing, or there against expectation.
fn unproven(table: &Table, proofs: &[Proof]) -> Vec<Finding> {
    let mut findings = Vec::new();
    for statement in table.statements() {
        let proven = proofs.iter().any(|proof| proof.id == statement.id);
        match (&statement.kind, proven) {
            (Kind::Tested, false) => findings.push(Finding::new(
                TABLE,
                statement.line,
                format!("no test names {}", statement.id),
                format!("write it, with the line // manual: {} above it", statement.id),
            )),
            (Kind::NotYet(_) | Kind::Unobservable(_), true) => findings.push(Finding::new(
                TABLE,
                statement.line,
                format!("{} has a test", statement.id),
                "move it to the statements of its section",
            )),
            _ => {}
        }
    }
    findings
}

/// What is not done yet must be named where the README says what is missing.
fn unannounced(table: &Table, files: &[File]) -> Vec<Finding> {
    let readme = text_of(files, "README.md").unwrap_or_default();
    let missing = readme
        .split("\n## ")
        .find(|part| part.starts_with("What is missing"))
        .unwrap_or_default();
    let mut findings = Vec::new();
    for statement in table.statements() {
        if let Kind::NotYet(words) = &statement.kind
            && !missing.contains(words.as_str())
        {
            let what = format!("the README does not name \"{words}\" among what is missing");
            findings.push(Finding::new(TABLE, statement.line, what, "tell users, or make it work"));
        }
    }
    findings
}

#[cfg(test)]
mod tests;
