//! Fuzzing of `harness::fuzz::toy`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| harness::fuzz::toy(bytes));
