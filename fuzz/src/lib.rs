//! What the fuzz targets do: each takes arbitrary bytes, turns them into what a hostile master could do to virtual drives, and panics if a
//! drive does what no drive may do.
//!
//! | module | holds |
//! |---|---|
//! | [`input`] | the fuzzer's bytes as a sequence of choices |
//! | [`bus`] | drives, the cables between them, time, and a plain master |
//! | [`bring_up`] | the way to PREOP from wherever the drives are, and on to OP |
//! | [`mail`] | mailbox messages of a plain master |
//! | [`target`] | the targets |
//!
//! `cargo fuzz` feeds the targets through the programs in `fuzz_targets`; the tests replay the corpus without it.
#![forbid(unsafe_code)]

pub mod bring_up;
pub mod bus;
pub mod input;
pub mod mail;
pub mod target;
