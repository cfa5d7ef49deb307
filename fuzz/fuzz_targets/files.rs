//! Any bytes as a mesh or an image.
#![no_main]

#[path = "../../tests/support/answers.rs"]
mod answers;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    answers::file(bytes);
});
