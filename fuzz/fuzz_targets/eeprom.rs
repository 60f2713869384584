//! Target `eeprom`: see [`fuzzing::target::eeprom`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzzing::target::eeprom::run(bytes));
