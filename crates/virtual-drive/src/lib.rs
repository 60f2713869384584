//! usr2556e
