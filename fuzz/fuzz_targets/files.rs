//! Any bytes as a mesh or an image.
#![no_main]

#[allow(dead_code, reason = "each target uses a part")]
#[path = "../../tests/support/answers.rs"]
mod answers;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    answers::file(bytes);
});
