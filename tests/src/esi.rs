//! The ESI file, taken apart without the code that made it.

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

/// An element of the file.
#[derive(Debug, Default)]
pub struct Element {
    /// Its tag.
    pub tag: String,
    attributes: Vec<(String, String)>,
    /// Its text, without space around it.
    pub text: String,
    children: Vec<Element>,
}

impl Element {
    /// The file as it is generated, from the root on.
    pub fn document() -> Self {
        let document = usr2556e::esi::document().unwrap();
        let mut reader = Reader::from_str(&document);
        let mut open = vec![Self::default()];
        loop {
            match reader.read_event().unwrap() {
                Event::Start(start) => open.push(Self::new(&start)),
                Event::Empty(start) => open.last_mut().unwrap().children.push(Self::new(&start)),
                Event::Text(text) => open.last_mut().unwrap().text += (*text).trim(),
                Event::End(_) => {
                    let closed = open.pop().unwrap();
                    open.last_mut().unwrap().children.push(closed);
                }
                Event::Eof => return open.remove(0).children.remove(0),
                Event::Decl(_) => {}
                other => panic!("{other:?} is not expected"),
            }
        }
    }

    fn new(start: &BytesStart) -> Self {
        Self {
            tag: start.name().as_ref().to_owned(),
            attributes: start
                .attributes()
                .map(|attribute| attribute.unwrap())
                .map(|attribute| (attribute.key.as_ref().to_owned(), attribute.value.into_owned()))
                .collect(),
            ..Self::default()
        }
    }

    /// All elements at the end of a path of tags.
    pub fn all(&self, path: &str) -> Vec<&Self> {
        path.split('/').fold(vec![self], |found, tag| {
            let children = found.into_iter().flat_map(|element| &element.children);
            children.filter(|child| child.tag == tag).collect()
        })
    }

    /// The element at the end of a path, if there is one.
    pub fn find(&self, path: &str) -> Option<&Self> {
        let all = self.all(path);
        assert!(all.len() <= 1, "{path} comes {} times", all.len());
        all.first().copied()
    }

    /// The text at the end of a path.
    pub fn text(&self, path: &str) -> &str {
        &self.find(path).unwrap_or_else(|| panic!("no {path} in {}", self.tag)).text
    }

    /// The number at the end of a path.
    pub fn number(&self, path: &str) -> u32 {
        number(self.text(path))
    }

    /// The number that is this element's text.
    pub fn number_here(&self) -> u32 {
        number(&self.text)
    }

    /// The attribute with this name.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    /// The number in an attribute.
    pub fn attribute_number(&self, name: &str) -> u32 {
        number(
            self.attribute(name)
                .unwrap_or_else(|| panic!("no attribute {name} in {}", self.tag)),
        )
    }

    /// Whether an attribute is there and true.
    pub fn is_true(&self, name: &str) -> bool {
        self.attribute(name) == Some("true")
    }
}

fn number(text: &str) -> u32 {
    match text.strip_prefix("#x") {
        Some(digits) => u32::from_str_radix(digits, 16).unwrap(),
        None => text.parse().unwrap(),
    }
}
