//! Any bytes as the document that the environment names: `FACIES_DOCUMENT=case`.
#![no_main]

use std::sync::LazyLock;

#[allow(dead_code, reason = "each target uses a part")]
#[path = "../../tests/support/answers.rs"]
mod answers;

static NAME: LazyLock<String> = LazyLock::new(|| {
    std::env::var("FACIES_DOCUMENT").expect("FACIES_DOCUMENT is the name of a document")
});

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    answers::document(&NAME, bytes);
});
