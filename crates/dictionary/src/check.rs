//! What is verified of a table at compile time.

use crate::Entry;

/// Whether two entries of a table do not fit together, and why: out of order, twice the same, or an object that starts in its middle.
const fn misfit(previous: &Entry, next: &Entry) -> Option<&'static str> {
    if next.index < previous.index {
        return Some("objects must be sorted by index");
    }
    if next.index == previous.index && next.sub <= previous.sub {
        return Some("sub-indices of an object must be sorted");
    }
    if next.index > previous.index && next.sub > 1 {
        return Some("an object starts at sub-index 0 or 1");
    }
    None
}

/// Panics, at compile time, if `entries` is no valid table: order, uniqueness, defaults in range.
pub const fn assert_table(entries: &[Entry]) {
    let mut i = 0;
    while i < entries.len() {
        let entry = &entries[i];
        assert!(
            entry.min <= entry.default && entry.default <= entry.max,
            "a default lies outside of its range"
        );
        assert!(!entry.name.is_empty(), "an entry has no name");
        if i > 0
            && let Some(reason) = misfit(&entries[i - 1], entry)
        {
            panic!("{}", reason);
        }
        i += 1;
    }
}
