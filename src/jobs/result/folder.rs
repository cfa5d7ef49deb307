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

/// The names of all files that were ever written into a folder, a line each: no other is replaced.
const RECORD: &str = ".facies";

/// Documents beside results that have no record, of earlier versions.
const BESIDE: [&str; 2] = ["case.json", "plan.json"];

/// The files that the manifest in a folder names, and itself; a file of its name that no job wrote names none.
fn earlier(folder: &Path) -> Vec<String> {
    let manifest = std::fs::read(folder.join(MANIFEST)).unwrap_or_default();
    let Ok(result) = serde_json::from_slice::<serde_json::Value>(&manifest) else {
        return Vec::new();
    };
    if result.pointer("/provenance/engine").is_none() {
        return Vec::new();
    }
    let files = result.get("files").and_then(|files| files.as_array()).into_iter().flatten();
    let names = files.filter_map(|file| file.get("name")?.as_str());
    // A name with a folder in it is none of ours.
    let own = names.filter(|name| Path::new(name).components().count() == 1 && *name != "..");
    std::iter::once(MANIFEST).chain(own).map(str::to_owned).collect()
}

/// The files in a folder that may be replaced.
fn own(folder: &Path) -> Vec<String> {
    let mut own = earlier(folder);
    match std::fs::read_to_string(folder.join(RECORD)) {
        Ok(record) => own.extend(record.lines().map(str::to_owned)),
        Err(_) if own.is_empty() => {}
        Err(_) => own.extend(BESIDE.map(str::to_owned)),
    }
    own
}

/// Refuses names of files that are there and that no command wrote.
pub fn refuse_foreign<'a>(
    folder: &Path,
    names: impl IntoIterator<Item = &'a str>,
) -> Result<(), JobError> {
    let own = own(folder);
    let is_foreign = |name: &&str| folder.join(name).exists() && !own.iter().any(|own| own == name);
    match names.into_iter().find(is_foreign) {
        None => Ok(()),
        Some(name) => {
            let detail = format!(
                "{} is there, and no result of facies: it would be replaced; give another folder",
                folder.join(name).display()
            );
            Err(JobError::Refused(Problem::new(ErrorCode::ValidationFailed, detail)))
        }
    }
}

/// Adds names to the record of a folder.
fn remember(folder: &Path, names: &[String]) -> std::io::Result<()> {
    let path = folder.join(RECORD);
    let record = std::fs::read_to_string(&path).unwrap_or_default();
    let is_new = |name: &&String| !record.lines().any(|line| line == name.as_str());
    let added: String = names.iter().filter(is_new).map(|name| format!("{name}\n")).collect();
    if added.is_empty() { Ok(()) } else { std::fs::write(path, record + &added) }
}

/// Writes a file, unless one that no command wrote would be replaced.
pub fn put(folder: &Path, file: &str, bytes: &[u8]) -> Result<(), JobError> {
    refuse_foreign(folder, [file])?;
    // The name first, so that half of a file is ours too.
    remember(folder, &[file.to_owned()])
        .and_then(|()| std::fs::write(folder.join(file), bytes))
        .map_err(|source| JobError::Write { file: file.to_owned(), source })
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

/// Refuses a folder in which an earlier result is what the job has read so far, or the manifest is none of ours.
pub fn check(place: &JobContext) -> Result<(), JobError> {
    refuse_foreign(place.out, [MANIFEST])?;
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
        remember(folder, &own(folder)).map_err(failed)?;
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
        put(self.folder, file, bytes)?;
        self.files.push(FileDocument {
            name: file.to_owned(),
            media_type: media_type.to_owned(),
            bytes: bytes.len() as u64,
            sha256: canonical::sha256_hex(bytes),
        });
        Ok(())
    }
}
