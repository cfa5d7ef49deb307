//! Data that lies beside the repository and is never part of it.

use std::path::PathBuf;

/// A file of the shared data; `None`, said on stderr, where it is absent.
pub fn shared_data(file: &str) -> Option<PathBuf> {
    let beside = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared");
    let root = std::env::var_os("FACIES_SHARED").map_or_else(beside, PathBuf::from);
    let path = root.join("data").join(file);
    if path.exists() {
        return Some(path);
    }
    eprintln!("skipped: shared data {file} is absent");
    None
}
