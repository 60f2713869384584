//! The checks on a small manual.

use super::*;

const TOML: &str = "\
[[section]]
number = \"2.2.9\"
title = \"Filter\"
statements = [[\"lag\", \"The motor lags\"]]
not-yet = [[\"hum\", \"It hums\", \"humming\"]]

[[section]]
number = \"2.2.10\"
title = \"Lock\"
unobservable = [[\"size\", \"It is small\", \"a size\"]]
";

const README: &str = "# Drive\n\n## What is missing\n\n- humming\n\n## More\n";

fn test_file(names: &str) -> String {
    format!("// manual: {names}\n/// Doc.\n#[test]\n#[should_panic]\nfn it_lags() {{}}\n")
}

/// The workspace with this list and these sources, and the page that belongs to them.
fn workspace(toml: &str, source: &str) -> Vec<File> {
    let file = |path: &str, text: &str| File {
        path: path.into(),
        text: text.into(),
    };
    let mut files = vec![
        file("README.md", README),
        file("crates/drive/tests/lag.rs", source),
        file(TABLE, toml),
    ];
    if let Ok(text) = page(&files) {
        files.push(file(PAGE, &text));
    }
    files
}

fn whats(files: &[File]) -> Vec<(String, usize, String)> {
    let place = |finding: Finding| (finding.file, finding.line, finding.what);
    check(files).into_iter().map(place).collect()
}

fn assert_found(files: &[File], file: &str, line: usize, word: &str) {
    let found = whats(files);
    assert!(
        matches!(&found[..], [(at, on, what)] if at == file && *on == line && what.contains(word)),
        "{found:?}"
    );
}

#[test]
fn a_page_names_each_statement_with_its_test_or_reason() {
    let files = workspace(TOML, &test_file("2.2.9/lag"));
    assert_eq!(whats(&files), []);
    let page = text_of(&files, PAGE).unwrap_or_default();
    for line in [
        "1 statements are proven by tests, 1 wait for what is not built yet, 1 cannot be seen in software.",
        "| 2.2.9/lag | The motor lags | crates/drive/tests/lag.rs: `it_lags` |",
        "| 2.2.9/hum | It hums | not yet: humming |",
        "| 2.2.10/size | It is small | not observable: a size |",
    ] {
        assert!(page.lines().any(|other| other == line), "{line} in {page}");
    }
}

#[test]
fn a_statement_without_a_test_is_found_and_so_is_a_name_without_a_statement() {
    assert_found(&workspace(TOML, ""), TABLE, 4, "no test names 2.2.9/lag");
    let source = test_file("2.2.9/lag 2.2.9/leg");
    assert_found(&workspace(TOML, &source), "crates/drive/tests/lag.rs", 1, "no statement 2.2.9/leg");
}

#[test]
fn names_above_anything_but_a_test_that_runs_are_found() {
    let good = test_file("2.2.9/lag");
    for (source, line) in [
        (format!("{good}// manual: 2.2.9/lag\nfn no_test() {{}}\n"), 6),
        (format!("{good}// manual: 2.2.9/lag\n#[test]\n#[ignore]\nfn never() {{}}\n"), 6),
        (format!("{good}// manual: 2.2.9/lag\n\n#[test]\nfn apart() {{}}\n"), 6),
        (format!("{good}// manual: 2.2.9/lag\n"), 6),
    ] {
        assert_found(&workspace(TOML, &source), "crates/drive/tests/lag.rs", line, "no test that runs");
    }
}

#[test]
fn what_is_not_yet_must_be_among_what_is_missing_and_have_no_test() {
    let unannounced = TOML.replace("\"humming\"", "\"whistling\"");
    assert_found(&workspace(&unannounced, &test_file("2.2.9/lag")), TABLE, 5, "whistling");
    assert_found(
        &workspace(TOML, &test_file("2.2.9/lag 2.2.9/hum")),
        TABLE,
        5,
        "2.2.9/hum has a test",
    );
}

#[test]
fn an_old_page_is_found_with_the_command_that_renews_it() {
    let mut files = workspace(TOML, &test_file("2.2.9/lag"));
    files.retain(|file| file.path != PAGE);
    let findings = check(&files);
    assert_eq!((findings.len(), findings[0].remedy.as_str()), (1, RENEW));
}

#[test]
fn a_list_of_another_form_is_refused_with_its_line() {
    for (from, to, line, word) in [
        ("\"2.2.10\"", "\"2.2.8\"", 7, "out of order"),
        ("[\"lag\", \"The motor lags\"]", "[\"lag\"]", 4, "no row"),
        ("not-yet", "later", 5, "no row"),
        ("title = \"Lock\"", "", 7, "needs number and title"),
        ("\"hum\"", "\"lag\"", 5, "twice"),
        ("[[\"lag\"", "[\"lag\"", 4, ""),
    ] {
        assert_found(&workspace(&TOML.replace(from, to), &test_file("2.2.9/lag")), TABLE, line, word);
    }
    assert!(check(&[]).iter().any(|finding| finding.what == "missing"));
}
