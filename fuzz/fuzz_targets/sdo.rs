//! Target `sdo`: see [`fuzzing::target::sdo`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzzing::target::sdo::run(bytes));
