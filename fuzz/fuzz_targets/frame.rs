//! Target `frame`: see [`fuzzing::target::frame`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzzing::target::frame::run(bytes));
