//! A Rust file as a flat list of tokens with line numbers: comments and the inside of strings cannot be mistaken for code.

use std::ops::RangeInclusive;
use std::str::FromStr;

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// One token; literals are kept only as place holders.
#[derive(Clone, Debug, PartialEq)]
pub enum Token {
    Word(String),
    Sign(char),
    Literal,
}

/// A Rust file.
pub struct Source {
    /// Path from the workspace's root, with forward slashes.
    pub path: String,
    /// Lines of the whole file.
    pub lines: usize,
    tokens: Vec<(Token, usize)>,
    test_lines: Vec<RangeInclusive<usize>>,
    /// Modules that are compiled for tests only and live in files of their own.
    test_modules: Vec<String>,
    all_tests: bool,
}

impl Source {
    /// Splits `text` into tokens; the error is the line that cannot be split.
    pub fn parse(path: &str, text: &str) -> Result<Self, usize> {
        let stream = TokenStream::from_str(text).map_err(|error| error.span().start().line)?;
        let mut tokens = Vec::new();
        flatten(stream, &mut tokens);
        let lines = text.lines().count();
        let all_tests = path.split('/').any(|part| part == "tests" || part == "tests.rs");
        let mut source = Self {
            path: path.into(),
            lines,
            tokens,
            test_lines: Vec::new(),
            test_modules: Vec::new(),
            all_tests,
        };
        source.find_test_modules();
        Ok(source)
    }

    /// The lines on which `pattern` starts, in tests too.
    ///
    /// A pattern is words and signs divided by spaces, as in `std : : time`.
    pub fn find(&self, pattern: &str) -> Vec<usize> {
        let pattern: Vec<&str> = pattern.split(' ').collect();
        self.tokens
            .windows(pattern.len())
            .filter(|window| window.iter().zip(&pattern).all(|(token, part)| is(token, part)))
            .map(|window| window[0].1)
            .collect()
    }

    /// As [`find`](Self::find), but not in tests.
    pub fn find_outside_tests(&self, pattern: &str) -> Vec<usize> {
        self.find(pattern).into_iter().filter(|line| !self.is_test(*line)).collect()
    }

    /// The names of modules declared here, with their lines.
    pub fn modules(&self) -> impl Iterator<Item = (&str, usize)> {
        self.tokens.windows(2).filter_map(|pair| match pair {
            [(Token::Word(keyword), _), (Token::Word(name), line)] if keyword == "mod" => Some((name.as_str(), *line)),
            _ => None,
        })
    }

    /// Attributes of the file itself, as `no_std` or `forbid ( unsafe_code )`.
    pub fn inner_attributes(&self) -> Vec<String> {
        let mut attributes = Vec::new();
        let mut rest = self.tokens.as_slice();
        while let [hash, bang, open, inside @ ..] = rest
            && is(hash, "#")
            && is(bang, "!")
            && is(open, "[")
        {
            let end = closing(inside);
            attributes.push(inside[..end].iter().map(|(token, _)| spelling(token)).collect::<Vec<_>>().join(" "));
            rest = inside.get(end + 1..).unwrap_or_default();
        }
        attributes
    }

    /// Lines that are no test's.
    pub fn lines_outside_tests(&self) -> usize {
        (1..=self.lines).filter(|line| !self.is_test(*line)).count()
    }

    fn is_test(&self, line: usize) -> bool {
        self.all_tests || self.test_lines.iter().any(|range| range.contains(&line))
    }

    fn find_test_modules(&mut self) {
        for start in 0..self.tokens.len() {
            let [hash, open, inside @ ..] = &self.tokens[start..] else {
                continue;
            };
            if !is(hash, "#") || !is(open, "[") {
                continue;
            }
            let end = closing(inside);
            if !is_test_condition(&inside[..end]) {
                continue;
            }
            let item = skip_to_keyword(inside.get(end + 1..).unwrap_or_default());
            let [keyword, (Token::Word(name), _), opening, body @ ..] = item else {
                continue;
            };
            if !is(keyword, "mod") {
                continue;
            }
            if is(opening, "{") {
                let last = body.get(closing(body)).map_or(self.lines, |(_, line)| *line);
                self.test_lines.push(hash.1..=last);
            } else {
                self.test_modules.push(name.clone());
            }
        }
    }
}

/// Marks the files of modules that another file declares for tests only.
pub fn mark_test_files(sources: &mut [Source]) {
    let stems: Vec<String> = sources
        .iter()
        .flat_map(|source| {
            source
                .test_modules
                .iter()
                .map(|name| format!("{}/{name}", module_folder(&source.path)))
        })
        .collect();
    for source in sources {
        let path = &source.path;
        source.all_tests |= stems.iter().any(|stem| {
            path.strip_prefix(stem.as_str())
                .is_some_and(|rest| rest == ".rs" || rest.starts_with('/'))
        });
    }
}

/// The folder in which the modules of a file live.
fn module_folder(path: &str) -> &str {
    let (folder, name) = path.rsplit_once('/').unwrap_or(("", path));
    if ["lib.rs", "main.rs", "mod.rs"].contains(&name) {
        folder
    } else {
        path.trim_end_matches(".rs")
    }
}

fn flatten(stream: TokenStream, tokens: &mut Vec<(Token, usize)>) {
    for tree in stream {
        let line = tree.span().start().line;
        match tree {
            TokenTree::Ident(word) => tokens.push((Token::Word(word.to_string()), line)),
            TokenTree::Punct(sign) => tokens.push((Token::Sign(sign.as_char()), line)),
            TokenTree::Literal(_) => tokens.push((Token::Literal, line)),
            TokenTree::Group(group) => {
                let (open, close) = match group.delimiter() {
                    Delimiter::Parenthesis => ('(', ')'),
                    Delimiter::Brace => ('{', '}'),
                    Delimiter::Bracket => ('[', ']'),
                    Delimiter::None => (' ', ' '),
                };
                tokens.push((Token::Sign(open), line));
                flatten(group.stream(), tokens);
                tokens.push((Token::Sign(close), group.span_close().start().line));
            }
        }
    }
}

fn is((token, _): &(Token, usize), part: &str) -> bool {
    match token {
        Token::Word(word) => word == part,
        Token::Sign(sign) => part.chars().eq([*sign]),
        Token::Literal => false,
    }
}

fn spelling(token: &Token) -> String {
    match token {
        Token::Word(word) => word.clone(),
        Token::Sign(sign) => sign.to_string(),
        Token::Literal => "\"\"".into(),
    }
}

/// Where the bracket closes that was opened just before `tokens`; their length if it does not.
fn closing(tokens: &[(Token, usize)]) -> usize {
    let mut depth = 0_usize;
    for (index, (token, _)) in tokens.iter().enumerate() {
        match token {
            Token::Sign('(' | '[' | '{') => depth += 1,
            Token::Sign(')' | ']' | '}') if depth == 0 => return index,
            Token::Sign(')' | ']' | '}') => depth -= 1,
            _ => {}
        }
    }
    tokens.len()
}

/// Whether an attribute compiles its item for tests only: `cfg(test)`, or `cfg(all(test, ...))`.
fn is_test_condition(attribute: &[(Token, usize)]) -> bool {
    let word = |wanted: &str| attribute.iter().any(|token| is(token, wanted));
    attribute.first().is_some_and(|first| is(first, "cfg")) && word("test") && !word("not") && !word("any")
}

/// Past further attributes and the visibility, to the item's keyword.
fn skip_to_keyword(mut tokens: &[(Token, usize)]) -> &[(Token, usize)] {
    loop {
        tokens = match tokens {
            [hash, open, rest @ ..] if is(hash, "#") && is(open, "[") => rest.get(closing(rest) + 1..).unwrap_or_default(),
            [visibility, open, rest @ ..] if is(visibility, "pub") && is(open, "(") => rest.get(closing(rest) + 1..).unwrap_or_default(),
            [visibility, rest @ ..] if is(visibility, "pub") => rest,
            _ => return tokens,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Source {
        Source::parse("crates/esc/src/chip.rs", text).expect("small input is Rust")
    }

    #[test]
    fn words_in_comments_and_strings_are_not_code() {
        let source = parse("//! unsafe\n/* unsafe */\nconst A: &str = \"unsafe\";\nconst B: &str = r#\"unsafe\"#;\nunsafe fn f() {}\n");
        assert_eq!(source.find("unsafe"), [5]);
    }

    #[test]
    fn a_pattern_matches_over_lines_and_only_whole_words() {
        let source = parse("use std::\n    time::Duration;\nuse std::timer;\n");
        assert_eq!(source.find("std : : time"), [1]);
    }

    #[test]
    fn test_modules_do_not_count_and_a_lone_attribute_is_no_module() {
        let source = parse(
            "#[cfg(test)]\nextern crate std;\nfn f() {}\n\n#[cfg(test)]\n#[rustfmt::skip]\nmod tests {\n    fn g() { dbg!(1); }\n}\n",
        );
        assert_eq!(source.lines_outside_tests(), 4);
        assert_eq!(source.find("dbg !"), [8]);
        assert_eq!(source.find_outside_tests("dbg !"), []);
    }

    #[test]
    fn code_after_a_test_module_counts_again() {
        let source = parse("#[cfg(all(test, feature = \"slow\"))]\npub(crate) mod tests {\n}\nfn f() { dbg!(1); }\n");
        assert_eq!(source.find_outside_tests("dbg !"), [4]);
    }

    #[test]
    fn code_for_builds_without_tests_is_no_test() {
        assert_eq!(parse("#[cfg(not(test))]\nmod real { fn f() {} }\n").lines_outside_tests(), 2);
    }

    #[test]
    fn files_of_test_modules_are_tests() {
        let mut sources = [
            "crates/esc/src/chip.rs",
            "crates/esc/src/chip/properties.rs",
            "crates/esc/src/properties.rs",
        ]
        .map(|path| Source::parse(path, "#[cfg(test)]\nmod properties;\nfn f() {}\n").expect("small input is Rust"));
        mark_test_files(&mut sources);
        assert_eq!(sources.map(|source| source.lines_outside_tests()), [3, 0, 3]);
    }

    #[test]
    fn files_in_a_tests_folder_are_tests() {
        let source = Source::parse("crates/esc/tests/frames.rs", "fn f() {}\n").expect("small input is Rust");
        assert_eq!(source.lines_outside_tests(), 0);
    }

    #[test]
    fn attributes_of_the_file_are_those_before_the_first_item() {
        let source = parse("//! Doc.\n#![no_std]\n#![forbid(unsafe_code)]\nmod a { #![allow(dead_code)] }\n");
        assert_eq!(source.inner_attributes()[1..], ["no_std", "forbid ( unsafe_code )"]);
    }

    #[test]
    fn text_that_is_not_rust_gives_its_line() {
        assert!(Source::parse("a.rs", "fn f() {\n}\n}\n").is_err());
    }
}
