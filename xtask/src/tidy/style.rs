//! Names, sizes and words that are not wanted anywhere in the workspace.

use super::source::Source;
use super::{File, Finding};

/// A module of this many lines without tests wants splitting.
const MOST_LINES: usize = 400;

/// Names that say nothing of what lives there.
const EMPTY_NAMES: [&str; 6] = ["common", "helper", "helpers", "misc", "util", "utils"];

/// Promises in place of code; spelled in halves, so that this file does not find itself.
const PROMISES: [&str; 3] = [concat!("TO", "DO"), concat!("FIX", "ME"), concat!("XX", "X")];

/// Macros that stand for code not written, or for a debugging session not cleaned up.
const LEFTOVERS: [&str; 3] = ["todo", "unimplemented", "dbg"];

/// Checks names of inline modules, left-over macros and the size of a Rust file.
pub fn check(source: &Source) -> Vec<Finding> {
    let path = &source.path;
    let mut findings = Vec::new();
    for (name, line) in source.modules().filter(|(name, _)| EMPTY_NAMES.contains(name)) {
        findings.push(Finding::new(
            path,
            line,
            format!("module named {name}"),
            "name it after what it holds",
        ));
    }
    for leftover in LEFTOVERS {
        for line in source.find(&format!("{leftover} !")) {
            findings.push(Finding::new(
                path,
                line,
                format!("{leftover}! left in"),
                "write the code, or answer with the error a real device gives",
            ));
        }
    }
    let lines = source.lines_outside_tests();
    if lines > MOST_LINES {
        let what = format!("{lines} lines without tests, more than {MOST_LINES}");
        findings.push(Finding::new(path, source.lines, what, "split the module by what its parts know"));
    }
    findings
}

/// Checks for promises in code and comments alike.
pub fn check_words(file: &File) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (index, line) in file.text.lines().enumerate() {
        for promise in PROMISES.iter().filter(|promise| has_word(line, promise)) {
            findings.push(Finding::new(
                &file.path,
                index + 1,
                format!("{promise} in the text"),
                "do it now, or file an issue and remove the note",
            ));
        }
    }
    findings
}

/// Checks the names of a file and of the folders around it.
pub fn check_name(path: &str) -> Option<Finding> {
    let empty = path
        .split('/')
        .map(|part| part.split('.').next().unwrap_or(part))
        .find(|stem| EMPTY_NAMES.contains(stem))?;
    Some(Finding::new(
        path,
        1,
        format!("file or folder named {empty}"),
        "name it after what it holds",
    ))
}

fn has_word(line: &str, wanted: &str) -> bool {
    line.split(|character: char| !character.is_alphanumeric() && character != '_')
        .any(|word| word == wanted)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn whats(findings: Vec<Finding>) -> Vec<(usize, String)> {
        findings.into_iter().map(|finding| (finding.line, finding.what)).collect()
    }

    fn source(text: &str) -> Source {
        Source::parse("crates/esc/src/chip.rs", text).expect("small input is Rust")
    }

    #[test]
    fn promises_are_found_in_comments_and_only_as_whole_words() {
        let [first, second, third] = PROMISES;
        let text = format!("// {first}: later\n// {second}\nlet x = 0x60{third}; // {first}S\n# {third}\n");
        let found = whats(check_words(&File { path: "a.py".into(), text }));
        assert_eq!(
            found,
            [
                (1, format!("{first} in the text")),
                (2, format!("{second} in the text")),
                (4, format!("{third} in the text"))
            ]
        );
    }

    #[test]
    fn left_over_macros_are_found_in_code_but_not_in_comments() {
        let found = whats(check(&source(
            "// todo!() is not wanted\nfn f() { todo!() }\nfn g() { dbg!(1); }\n",
        )));
        assert_eq!(found, [(2, "todo! left in".into()), (3, "dbg! left in".into())]);
    }

    #[test]
    fn names_that_say_nothing_are_found_in_modules_files_and_folders() {
        assert_eq!(
            whats(check(&source("mod utils { }\nmod utilities;\n"))),
            [(1, "module named utils".into())]
        );
        assert!(check_name("tests/common/mod.rs").is_some());
        assert!(check_name("crates/esc/src/helpers.rs").is_some());
        assert!(check_name("crates/esc/src/common_parameters.rs").is_none());
    }

    #[test]
    fn a_module_may_have_four_hundred_lines_and_tests_besides() {
        let tests = format!("#[cfg(test)]\nmod tests {{\n{}}}\n", "\n".repeat(500));
        assert_eq!(whats(check(&source(&("\n".repeat(400) + &tests)))), []);
        assert_eq!(check(&source(&("\n".repeat(401) + &tests))).len(), 1);
    }
}
