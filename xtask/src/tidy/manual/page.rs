//! The book's page of statements and tests.

use std::fmt::Write;

use super::names::Proof;
use super::table::{Kind, Section, Statement, Table};

const HEADING: &str = "\
# The manual, statement by statement

What the manual says of the drive, in short, and the tests that prove it, named by file and function. Made by `cargo xtask manual` from
`docs/manual.toml` and the lines `// manual: ...` above the tests; `cargo xtask tidy` fails where a statement has no test.
";

/// Writes the page.
pub fn write(table: &Table, proofs: &[Proof]) -> String {
    let mut page = HEADING.to_string();
    let count = |wanted: fn(&Kind) -> bool| table.statements().filter(|statement| wanted(&statement.kind)).count();
    let summary = writeln!(
        page,
        "\n{} statements are proven by tests, {} wait for what is not built yet, {} cannot be seen in software.",
        count(|kind| matches!(kind, Kind::Tested)),
        count(|kind| matches!(kind, Kind::NotYet(_))),
        count(|kind| matches!(kind, Kind::Unobservable(_))),
    );
    debug_assert!(summary.is_ok(), "text takes any length");
    for section in &table.sections {
        write_section(&mut page, section, proofs);
    }
    page
}

fn write_section(page: &mut String, section: &Section, proofs: &[Proof]) {
    *page += &format!(
        "\n## {} {}\n\n| statement | says | proven by |\n|---|---|---|\n",
        section.number, section.title
    );
    for statement in &section.statements {
        let proof = match &statement.kind {
            Kind::Tested => tests_of(statement, proofs),
            Kind::NotYet(words) => format!("not yet: {words}"),
            Kind::Unobservable(reason) => format!("not observable: {reason}"),
        };
        *page += &format!("| {} | {} | {proof} |\n", statement.id, statement.says);
    }
}

/// Files and functions, each file once.
fn tests_of(statement: &Statement, proofs: &[Proof]) -> String {
    let mut files: Vec<(&str, Vec<String>)> = Vec::new();
    for proof in proofs.iter().filter(|proof| proof.id == statement.id) {
        let test = format!("`{}`", proof.test);
        match files.iter_mut().find(|(file, _)| *file == proof.file) {
            Some((_, tests)) => tests.push(test),
            None => files.push((&proof.file, vec![test])),
        }
    }
    let files: Vec<String> = files.iter().map(|(file, tests)| format!("{file}: {}", tests.join(", "))).collect();
    files.join("; ")
}
