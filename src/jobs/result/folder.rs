//! The folder of a result: each file with its size and hash.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::jobs::failure::JobError;
use crate::jobs::output::JobContext;
use crate::schema::predict::document::OutputName;
use crate::schema::predict::result::FileDocument;
use crate::schema::wire::canonical;
use crate::schema::{ErrorCode, Problem};

/// The manifest of a result.
const MANIFEST: &str = "result.json";

/// The files that the manifest in a folder names, and itself.
fn earlier(folder: &Path) -> Vec<String> {
    let manifest = std::fs::read(folder.join(MANIFEST)).unwrap_or_default();
    let Ok(result) = serde_json::from_slice::<serde_json::Value>(&manifest) else {
        return Vec::new();
    };
    let files = result.get("files").and_then(|files| files.as_array()).into_iter().flatten();
    let names = files.filter_map(|file| file.get("name")?.as_str());
    // A name with a folder in it is none of ours.
    let own = names.filter(|name| Path::new(name).components().count() == 1 && *name != "..");
    std::iter::once(MANIFEST).chain(own).map(str::to_owned).collect()
}

/// Writes files and lists them.
pub struct ResultFolder<'a> {
    folder: &'a Path,
    pub files: Vec<FileDocument>,
    /// What the job read.
    inputs: Vec<PathBuf>,
}

/// Refuses to remove or replace what was read.
fn keep(inputs: &[PathBuf], file: &Path) -> Result<(), JobError> {
    match file.canonicalize() {
        Ok(whole) if inputs.contains(&whole) => {
            let detail = format!(
                "{} is read, and would be removed or replaced by the result: give another folder",
                file.display()
            );
            Err(JobError::Refused(Problem::new(ErrorCode::ValidationFailed, detail)))
        }
        _ => Ok(()),
    }
}

/// Refuses a folder in which an earlier result is what the job has read so far.
pub fn check(place: &JobContext) -> Result<(), JobError> {
    let inputs = inputs(place);
    earlier(place.out).iter().try_for_each(|file| keep(&inputs, &place.out.join(file)))
}

fn inputs(place: &JobContext) -> Vec<PathBuf> {
    place.sources.files().iter().filter_map(|file| file.canonicalize().ok()).collect()
}

impl<'a> ResultFolder<'a> {
    /// Creates the folder if missing, and removes the files of an earlier result in it, which could be mistaken for this one's.
    pub fn open(place: &'a JobContext) -> Result<Self, JobError> {
        let folder = place.out;
        check(place)?;
        let failed = |source| JobError::Write { file: folder.display().to_string(), source };
        std::fs::create_dir_all(folder).map_err(failed)?;
        for file in earlier(folder) {
            let file = folder.join(file);
            match std::fs::remove_file(&file) {
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(failed(error)),
                Ok(()) | Err(_) => {}
            }
        }
        Ok(ResultFolder { folder, files: Vec::new(), inputs: inputs(place) })
    }

    pub fn add(&mut self, name: OutputName, bytes: &[u8]) -> Result<(), JobError> {
        self.add_file(name.file_name(), name.media_type(), bytes)
    }

    /// A file that no spec names.
    pub fn add_file(&mut self, file: &str, media_type: &str, bytes: &[u8]) -> Result<(), JobError> {
        keep(&self.inputs, &self.folder.join(file))?;
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
