//! The target `reader` of the fuzzer; see the `README.md` of this folder.
#![no_main]

#[path = "../crafted.rs"]
mod crafted;
#[path = "../script.rs"]
mod script;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| script::read(script::log_of(bytes)));
