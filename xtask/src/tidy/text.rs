//! White space and line ends.

use super::{File, Finding};

/// Trailing white space, tabs in Rust, carriage returns, and a last line that does not end.
pub fn check(file: &File) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut report = |line, what: &str, remedy: &str| findings.push(Finding::new(&file.path, line, what, remedy));
    for (index, line) in file.text.split('\n').enumerate() {
        let bare = line.strip_suffix('\r').unwrap_or(line);
        if bare.len() != line.len() {
            report(index + 1, "line ends with a carriage return", "save the file with LF line ends");
        }
        if bare.ends_with([' ', '\t']) {
            report(index + 1, "trailing white space", "remove it");
        }
        if file.path.ends_with(".rs") && bare.contains('\t') {
            report(index + 1, "tab", "indent with spaces; write \\t inside a string");
        }
    }
    if !file.text.is_empty() && !file.text.ends_with('\n') {
        report(file.text.split('\n').count(), "no newline at the end of the file", "add one");
    }
    if file.text.ends_with("\n\n") {
        report(file.text.lines().count(), "empty line at the end of the file", "remove it");
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(path: &str, text: &str) -> Vec<(usize, String)> {
        check(&File {
            path: path.into(),
            text: text.into(),
        })
        .into_iter()
        .map(|finding| (finding.line, finding.what))
        .collect()
    }

    #[test]
    fn clean_text_and_an_empty_file_pass() {
        assert_eq!(lines("a.rs", "fn f() {}\n"), []);
        assert_eq!(lines("a.toml", ""), []);
    }

    #[test]
    fn each_blemish_is_named_with_its_line() {
        assert_eq!(
            lines("a.md", "one \ntwo\r\nthree"),
            [
                (1, "trailing white space".into()),
                (2, "line ends with a carriage return".into()),
                (3, "no newline at the end of the file".into()),
            ]
        );
        assert_eq!(lines("a.md", "one\n\n"), [(2, "empty line at the end of the file".into())]);
    }

    #[test]
    fn tabs_are_refused_in_rust_only() {
        assert_eq!(lines("a.rs", "\tf();\n"), [(1, "tab".into())]);
        assert_eq!(lines("a.sh", "\tf\n"), []);
    }
}
