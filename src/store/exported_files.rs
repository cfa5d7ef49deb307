//! Files of an export: plain files, of which one that is missing, damaged or something else is named.

use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::Path;

use super::StoreError;
use crate::schema::wire::canonical::sha256_hex;

/// An error of the file system with its place and what has to be there.
pub(super) fn at(path: &Path, wanted: &'static str) -> impl Fn(std::io::Error) -> std::io::Error {
    let path = path.display().to_string();
    move |error| std::io::Error::new(error.kind(), format!("{path}: {error}; {wanted}"))
}

/// What an export lacks is a fault of the export, and not of the disk.
fn absent(error: std::io::Error) -> StoreError {
    match error.kind() {
        ErrorKind::NotFound | ErrorKind::NotADirectory => StoreError::Export(error.to_string()),
        _ => StoreError::Files(error),
    }
}

fn no_plain_file(path: &Path) -> StoreError {
    StoreError::Export(format!("{} is no plain file", path.display()))
}

/// Opens a file of an export. A pipe or a device is not opened, which may take for ever, nor is a folder.
pub(super) fn open_plain(path: &Path, wanted: &'static str) -> Result<File, StoreError> {
    let failed = at(path, wanted);
    match std::fs::metadata(path).map_err(&failed).map_err(absent)?.is_file() {
        true => File::open(path).map_err(failed).map_err(absent),
        false => Err(no_plain_file(path)),
    }
}

/// The bytes of an exported blob, whose file has their hash for its name.
pub(super) fn read_exported(folder: &Path, sha256: &str) -> Result<Vec<u8>, StoreError> {
    let file = folder.join("blobs").join(sha256);
    let failed = at(&file, "the manifest of the export names it");
    let is_file = std::fs::symlink_metadata(&file).map_err(&failed).map_err(absent)?.is_file();
    if !is_file {
        return Err(no_plain_file(&file));
    }
    let bytes = std::fs::read(&file).map_err(failed).map_err(absent)?;
    let found = sha256_hex(&bytes);
    if found == *sha256 {
        return Ok(bytes);
    }
    Err(StoreError::Export(format!("{} is damaged: its hash is {found}", file.display())))
}

pub(super) fn write_durably(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut file = File::create(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::symlink;

    use super::*;

    #[test]
    fn what_is_no_plain_file_is_named_and_not_opened() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("keys.ndjson");
        let told = || open_plain(&place, "it has to be there").unwrap_err().to_string();
        assert!(told().contains("keys.ndjson: No such file") && told().contains("to be there"));
        std::fs::create_dir(&place).unwrap();
        assert!(told().ends_with("keys.ndjson is no plain file"), "{}", told());
        std::fs::remove_dir(&place).unwrap();
        // As long as nobody writes into a pipe, who opens it waits.
        let made = std::process::Command::new("mkfifo").arg(&place).status().unwrap();
        assert!(made.success() && told().ends_with("keys.ndjson is no plain file"));
        std::fs::remove_file(&place).unwrap();
        symlink("/dev/zero", &place).unwrap();
        assert!(told().ends_with("keys.ndjson is no plain file"), "{}", told());
        std::fs::remove_file(&place).unwrap();
        std::fs::write(&place, "").unwrap();
        assert!(open_plain(&place, "").is_ok());
        let within = open_plain(&place.join("keys.ndjson"), "it has to be there").unwrap_err();
        assert!(matches!(within, StoreError::Export(_)), "{within}");
    }
}
