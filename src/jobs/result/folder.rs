//! The folder of a result: each file with its size and hash.

use std::path::Path;

use crate::jobs::failure::JobError;
use crate::schema::predict::document::OutputName;
use crate::schema::predict::result::FileDocument;
use crate::schema::wire::canonical;

/// Writes files and keeps the list of them.
pub struct ResultFolder<'a> {
    folder: &'a Path,
    pub files: Vec<FileDocument>,
}

impl<'a> ResultFolder<'a> {
    /// Makes the folder if it is not there.
    pub fn open(folder: &'a Path) -> Result<Self, JobError> {
        let failed = |source| JobError::Write { file: folder.display().to_string(), source };
        std::fs::create_dir_all(folder).map_err(failed)?;
        Ok(ResultFolder { folder, files: Vec::new() })
    }

    pub fn add(&mut self, name: OutputName, bytes: &[u8]) -> Result<(), JobError> {
        self.add_file(name.file_name(), name.media_type(), bytes)
    }

    /// A file that no client asks for by name in a spec.
    pub fn add_file(&mut self, file: &str, media_type: &str, bytes: &[u8]) -> Result<(), JobError> {
        std::fs::write(self.folder.join(file), bytes)
            .map_err(|source| JobError::Write { file: file.to_owned(), source })?;
        self.files.push(FileDocument {
            name: file.to_owned(),
            media_type: media_type.to_owned(),
            bytes: bytes.len() as u64,
            sha256: canonical::sha256_hex(bytes),
        });
        Ok(())
    }
}
