//! The program as people call it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use facies::schema::predict::result::ResultDocument;

pub fn facies(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_facies")).args(arguments).output().unwrap()
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

pub fn block() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/block")
}

pub fn result(folder: &Path) -> ResultDocument {
    serde_json::from_slice(&fs::read(folder.join("result.json")).unwrap()).unwrap()
}

pub fn path(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// A folder with a plan that moves node set `mandible` of the block.
pub fn plan_folder(plan: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("plan.json"), plan).unwrap();
    folder
}
