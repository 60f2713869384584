//! The last acts of a master.

use std::collections::VecDeque;

use wire::Nanos;

/// How many are kept.
const KEPT: usize = 20;

/// The last acts, the oldest first.
#[derive(Clone, Debug, Default)]
pub struct Journal(VecDeque<(Nanos, String)>);

impl Journal {
    /// Adds an act.
    pub fn note(&mut self, at: Nanos, act: impl FnOnce() -> String) {
        if self.0.len() == KEPT {
            self.0.pop_front();
        }
        self.0.push_back((at, act()));
    }

    /// All of them, with their times.
    pub fn last(&self) -> Vec<String> {
        let line = |(at, act): &(Nanos, String)| format!("{:14.6} s  {act}", at.0 as f64 / 1e9);
        self.0.iter().map(line).collect()
    }
}
