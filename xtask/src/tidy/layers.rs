//! What a crate below `virtual-drive` must declare and must not call, and where `unsafe` may stand.

use super::Finding;
use super::arrows;
use super::source::Source;

/// The one file that may say `unsafe`: the raw socket's system calls.
const UNSAFE_FILE: &str = "crates/virtual-drive/src/link/sys.rs";

/// What every crate below `virtual-drive` declares at the top of its `lib.rs`.
const DECLARATIONS: [(&str, &str); 2] = [("no_std", "#![no_std]"), ("forbid ( unsafe_code )", "#![forbid(unsafe_code)]")];

/// Calls that need an operating system, with what to do instead.
const FORBIDDEN: [(&str, &str, &str); 7] = [
    ("print !", "print!", "return the value; only virtual-drive talks to people"),
    ("println !", "println!", "return the value; only virtual-drive talks to people"),
    ("eprint !", "eprint!", "return the error; only virtual-drive talks to people"),
    ("eprintln !", "eprintln!", "return the error; only virtual-drive talks to people"),
    ("std : : time", "std::time", "take the time as an argument, board::Nanos or u64"),
    ("SystemTime", "SystemTime", "take the time as an argument, board::Nanos or u64"),
    ("Instant", "Instant", "take the time as an argument, board::Nanos or u64"),
];

/// Checks one Rust file.
pub fn check(source: &Source) -> Vec<Finding> {
    let path = &source.path;
    let mut findings = Vec::new();
    if path != UNSAFE_FILE {
        for line in source.find("unsafe") {
            findings.push(Finding::new(
                path,
                line,
                "unsafe",
                format!("find a safe way, or a system call's wrapper in {UNSAFE_FILE}"),
            ));
        }
    }
    let Some(file) = arrows::core_crates().find_map(|name| path.strip_prefix(&format!("crates/{name}/src/"))) else {
        return findings;
    };
    if file == "lib.rs" {
        let attributes = source.inner_attributes();
        for (attribute, spelled) in DECLARATIONS {
            if !attributes.iter().any(|declared| declared == attribute) {
                findings.push(Finding::new(
                    path,
                    1,
                    format!("{spelled} is missing"),
                    "add it below the module's description",
                ));
            }
        }
    }
    for (pattern, spelled, remedy) in FORBIDDEN {
        for line in source.find_outside_tests(pattern) {
            findings.push(Finding::new(path, line, format!("{spelled} below virtual-drive"), remedy));
        }
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "#![no_std]\n#![forbid(unsafe_code)]\n";

    fn whats(path: &str, text: &str) -> Vec<(usize, String)> {
        let source = Source::parse(path, text).expect("small input is Rust");
        check(&source).into_iter().map(|finding| (finding.line, finding.what)).collect()
    }

    #[test]
    fn a_core_crate_declares_that_it_needs_no_std_and_no_unsafe() {
        assert_eq!(whats("crates/esc/src/lib.rs", HEAD), []);
        assert_eq!(
            whats("crates/esc/src/lib.rs", "#![cfg_attr(not(test), no_std)]\n"),
            [
                (1, "#![no_std] is missing".into()),
                (1, "#![forbid(unsafe_code)] is missing".into()),
            ]
        );
        assert_eq!(whats("crates/virtual-drive/src/lib.rs", ""), []);
        assert_eq!(whats("crates/esc/src/chip.rs", ""), []);
    }

    #[test]
    fn unsafe_stands_in_one_file_only() {
        let text = "fn f() { unsafe { g() } }\n";
        assert_eq!(whats("crates/virtual-drive/src/link/sys.rs", text), []);
        assert_eq!(whats("crates/virtual-drive/src/link/raw.rs", text), [(1, "unsafe".into())]);
        assert_eq!(whats("tests/masters/soem.rs", text), [(1, "unsafe".into())]);
    }

    #[test]
    fn core_crates_read_no_clock_and_print_nothing() {
        let text = "use std::time::Duration;\nfn f() { println!(); let t = Instant::now(); }\n";
        let found = whats("crates/slave/src/mailbox.rs", text);
        assert_eq!(
            found,
            [
                (2, "println! below virtual-drive".into()),
                (1, "std::time below virtual-drive".into()),
                (2, "Instant below virtual-drive".into()),
            ]
        );
        assert_eq!(whats("crates/virtual-drive/src/clock.rs", text), []);
    }

    #[test]
    fn tests_of_core_crates_may_print() {
        assert_eq!(
            whats(
                "crates/slave/src/mailbox.rs",
                "#[cfg(test)]\nmod tests {\n    fn f() { println!(); }\n}\n"
            ),
            []
        );
        assert_eq!(whats("crates/slave/tests/mailbox.rs", "fn f() { println!(); }\n"), []);
    }
}
