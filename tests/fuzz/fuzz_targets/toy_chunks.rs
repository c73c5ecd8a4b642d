//! Fuzzing of `harness::fuzz::toy_chunks`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| harness::fuzz::toy_chunks(bytes));
