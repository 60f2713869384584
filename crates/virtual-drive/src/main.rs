//! usr2556e
fn main() {}
