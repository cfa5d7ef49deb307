//! Data that is not part of the project: a test that needs it is skipped, and says so, where it is absent.

use std::io::Write;
use std::path::PathBuf;

/// A file of the shared data: under `FACIES_SHARED`, or under `../shared` beside the project.
pub fn shared_data(file: &str) -> Option<PathBuf> {
    let root = std::env::var_os("FACIES_SHARED")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared"), PathBuf::from);
    let path = root.join("data").join(file);
    if path.exists() {
        return Some(path);
    }
    say_skipped(&format!("{} is not here", path.display()));
    None
}

/// Says why a test does nothing. Written to the stream itself: what a test prints is shown only when it fails.
pub fn say_skipped(why: &str) {
    let line = format!("skipped: {why}\n");
    std::io::stderr().write_all(line.as_bytes()).expect("standard error takes a line");
}
