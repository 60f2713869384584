//! Drive and windings: identification, and what protection finds in currents.

mod bench;
mod identification;
mod protection;
