//! The SII image, taken apart without the code that made it.

use std::collections::BTreeMap;

use wire::sii::{category, word};

/// A PDO as a file describes it.
#[derive(Debug, PartialEq, Eq)]
pub struct Pdo {
    pub index: u16,
    pub name: String,
    /// The sync manager it is assigned to.
    pub manager: Option<u8>,
    /// Mapping, name and data type of each entry.
    pub entries: Vec<(u32, String, u16)>,
}

/// An image taken apart without the code that made it.
pub struct Image(pub Vec<u8>);

impl Image {
    pub fn word(&self, at: usize) -> u16 {
        u16::from_le_bytes([self.0[2 * at], self.0[2 * at + 1]])
    }

    pub fn double_word(&self, at: usize) -> u32 {
        u32::from(self.word(at)) | u32::from(self.word(at + 1)) << 16
    }

    pub fn categories(&self) -> BTreeMap<u16, Vec<u8>> {
        let mut categories = BTreeMap::new();
        let mut at = word::CATEGORIES;
        while self.word(at) != category::END {
            let length = usize::from(self.word(at + 1));
            let contents = self.0[2 * (at + 2)..2 * (at + 2 + length)].to_vec();
            assert!(categories.insert(self.word(at), contents).is_none(), "a category comes twice");
            at += 2 + length;
        }
        categories
    }

    pub fn strings(&self) -> Vec<String> {
        let bytes = &self.categories()[&category::STRINGS];
        let mut rest = &bytes[1..];
        (0..bytes[0])
            .map(|_| {
                let (text, behind) = rest[1..].split_at(usize::from(rest[0]));
                rest = behind;
                String::from_utf8(text.to_vec()).unwrap()
            })
            .collect()
    }

    /// The string with this number; empty for none.
    pub fn string(&self, number: u8) -> String {
        match number {
            0 => String::new(),
            number => self.strings()[usize::from(number) - 1].clone(),
        }
    }

    /// PDOs of a category.
    pub fn pdos(&self, kind: u16) -> Vec<Pdo> {
        let bytes = &self.categories()[&kind];
        let mut pdos = Vec::new();
        let mut rest = bytes.as_slice();
        while rest.len() >= 8 {
            let (head, behind) = rest.split_at(8);
            let (entries, behind) = behind.split_at(8 * usize::from(head[2]));
            let mapping = |e: &[u8]| u32::from(u16::from_le_bytes([e[0], e[1]])) << 16 | u32::from(e[2]) << 8 | u32::from(e[5]);
            let entry = |e: &[u8]| (mapping(e), self.string(e[3]), e[4].into());
            pdos.push(Pdo {
                index: u16::from_le_bytes([head[0], head[1]]),
                name: self.string(head[5]),
                manager: (head[3] != 0xFF).then_some(head[3]),
                entries: entries.chunks(8).map(entry).collect(),
            });
            rest = behind;
        }
        pdos
    }
}
