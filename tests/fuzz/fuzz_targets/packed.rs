//! Fuzzing of `harness::fuzz::packed`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    harness::fuzz::packed(bytes);
});
