//! Target `mailbox`: see [`fuzzing::target::mailbox`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzzing::target::mailbox::run(bytes));
