//! The list of statements, `docs/manual.toml`.

use std::ops::Range;

use toml::de::{DeTable, DeValue};

/// What becomes of a statement.
#[derive(Debug, PartialEq)]
pub enum Kind {
    /// A test proves it.
    Tested,
    /// The drive does not do it yet; the words by which the README names it among what is missing.
    NotYet(String),
    /// Software cannot show it, for this reason.
    Unobservable(String),
}

/// A sentence of the manual, in other words.
#[derive(Debug, PartialEq)]
pub struct Statement {
    /// Section and name, as in `2.2.24/time`.
    pub id: String,
    pub says: String,
    pub kind: Kind,
    /// Where it is in the file.
    pub line: usize,
}

/// A section of the manual.
#[derive(Debug, PartialEq)]
pub struct Section {
    pub number: String,
    pub title: String,
    pub statements: Vec<Statement>,
}

/// The whole list in the manual's order.
#[derive(Debug, PartialEq)]
pub struct Table {
    pub sections: Vec<Section>,
}

impl Table {
    pub fn statements(&self) -> impl Iterator<Item = &Statement> {
        self.sections.iter().flat_map(|section| &section.statements)
    }
}

/// A line of the file and what is wrong there.
type Fault = (usize, String);

/// Reads the list.
pub fn parse(text: &str) -> Result<Table, Fault> {
    let at = |span: Range<usize>| 1 + text.bytes().take(span.start).filter(|byte| *byte == b'\n').count();
    let table = DeTable::parse(text).map_err(|error| (at(error.span().unwrap_or_default()), error.message().to_string()))?;
    let list = table.get_ref().get("section").ok_or((1, "no section".to_string()))?;
    let list = list
        .get_ref()
        .as_array()
        .ok_or((at(list.span()), "section is no list".to_string()))?;
    let mut sections: Vec<Section> = Vec::new();
    for section in list.iter() {
        let line = at(section.span());
        let keys = section.get_ref().as_table().ok_or((line, "section is no table".to_string()))?;
        let section = read_section(keys, line, at)?;
        if sections.last().is_some_and(|last| rank(&last.number) >= rank(&section.number)) {
            return Err((line, format!("section {} is out of order", section.number)));
        }
        sections.push(section);
    }
    let table = Table { sections };
    twin(&table).map_or(Ok(table), Err)
}

/// Reads a section that begins in `line`; `at` tells the line of a place in the file.
fn read_section(keys: &DeTable<'_>, line: usize, at: impl Fn(Range<usize>) -> usize) -> Result<Section, Fault> {
    let word = |key: &str| keys.get(key).and_then(|value| value.get_ref().as_str()).map(str::to_string);
    let (Some(number), Some(title)) = (word("number"), word("title")) else {
        return Err((line, "a section needs number and title".into()));
    };
    let mut statements = Vec::new();
    let lists = keys
        .iter()
        .filter(|(key, _)| !["number", "title"].contains(&key.get_ref().as_ref()));
    for (key, value) in lists {
        let rows = value.get_ref().as_array().ok_or((at(key.span()), "no list".to_string()))?;
        for row in rows.iter() {
            let line = at(row.span());
            let statement = statement(&number, key.get_ref(), words(row.get_ref()), line);
            statements.push(statement.ok_or((line, format!("no row of {}", key.get_ref())))?);
        }
    }
    statements.sort_by_key(|statement| statement.line);
    Ok(Section { number, title, statements })
}

/// The strings of a list; nothing if it has something else.
fn words(value: &DeValue<'_>) -> Vec<String> {
    let words = value
        .as_array()
        .map(|list| list.iter().map(|word| word.get_ref().as_str().map(str::to_string)).collect());
    words.flatten().unwrap_or_default()
}

/// A row of the list named `key`, if it has that list's form.
fn statement(section: &str, key: &str, words: Vec<String>, line: usize) -> Option<Statement> {
    let (name, says, kind) = match (key, <[String; 2]>::try_from(words.clone()), <[String; 3]>::try_from(words)) {
        ("statements", Ok([name, says]), _) => (name, says, Kind::Tested),
        ("not-yet", _, Ok([name, says, missing])) => (name, says, Kind::NotYet(missing)),
        ("unobservable", _, Ok([name, says, reason])) => (name, says, Kind::Unobservable(reason)),
        _ => return None,
    };
    let id = format!("{section}/{name}");
    Some(Statement { id, says, kind, line })
}

/// A section's number, for the order.
fn rank(number: &str) -> Vec<u32> {
    number.split('.').map(|part| part.parse().unwrap_or(0)).collect()
}

/// A statement whose name another one has.
fn twin(table: &Table) -> Option<Fault> {
    let ids: Vec<&Statement> = table.statements().collect();
    let twin = ids
        .iter()
        .enumerate()
        .find(|(n, one)| ids[..*n].iter().any(|other| other.id == one.id))?;
    Some((twin.1.line, format!("{} is there twice", twin.1.id)))
}
