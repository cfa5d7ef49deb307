//! The folder of a result: each file with its size and hash.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::jobs::failure::JobError;
use crate::jobs::output::JobContext;
use crate::schema::predict::document::OutputName;
use crate::schema::predict::result::FileDocument;
use crate::schema::wire::canonical;
use crate::schema::{ErrorCode, Problem};

/// The manifest of a result.
const MANIFEST: &str = "result.json";

/// All files that were ever written into a folder, a line each, as `sha256sum` writes it: no other is replaced, and none that has other
/// bytes by now. Without a hash: one that is being written, and those of earlier versions.
const RECORD: &str = ".facies";

/// Documents beside results that have no record, of earlier versions.
const BESIDE: [&str; 2] = ["case.json", "plan.json"];

/// The document of a check, and its picture.
pub const CHECK: &str = "check.json";
pub const CHECK_PICTURE: &str = "classes.svg";

/// The ends of names of movements, which a check writes and nothing else.
const MOVEMENTS: [&str; 2] = [".txt", ".tfm"];

/// The length of a hash in a record, and what follows it.
const HASH: usize = 64;
const BETWEEN: &str = "  ";

/// Hashes of files by name.
type Hashes = BTreeMap<String, Option<String>>;

/// The manifest in a folder, unless it is one that no job wrote.
fn manifest(folder: &Path) -> Option<Value> {
    let manifest = std::fs::read(folder.join(MANIFEST)).ok()?;
    let result: Value = serde_json::from_slice(&manifest).ok()?;
    result.pointer("/provenance/engine").is_some().then_some(result)
}

/// The files that the manifest in a folder names, and itself.
fn earlier(folder: &Path) -> Hashes {
    let Some(result) = manifest(folder) else { return Hashes::new() };
    let files = result.get("files").and_then(|files| files.as_array()).into_iter().flatten();
    let member = |file: &Value, name: &str| Some(file.get(name)?.as_str()?.to_owned());
    let named = files.filter_map(|file| Some((member(file, "name")?, member(file, "sha256"))));
    // A name with a folder in it is none of ours.
    let own = named.filter(|(name, _)| Path::new(name).components().count() == 1 && *name != "..");
    std::iter::once((MANIFEST.to_owned(), None)).chain(own).collect()
}

/// The file that a line of a record is of.
fn recorded(line: &str) -> (String, Option<String>) {
    let of_hash = line.split_at_checked(HASH).and_then(|(hash, rest)| {
        let is_hash = hash.bytes().all(|digit| digit.is_ascii_hexdigit());
        Some((rest.strip_prefix(BETWEEN)?, hash)).filter(|_| is_hash)
    });
    match of_hash {
        Some((name, hash)) => (name.to_owned(), Some(hash.to_owned())),
        None => (line.to_owned(), None),
    }
}

/// The files in a folder that may be replaced.
fn own(folder: &Path) -> Hashes {
    let mut own = earlier(folder);
    match std::fs::read_to_string(folder.join(RECORD)) {
        Ok(record) => own.extend(record.lines().map(recorded)),
        Err(_) if own.is_empty() => {}
        Err(_) => own.extend(BESIDE.map(|name| (name.to_owned(), None))),
    }
    own
}

fn is_of_check(name: &str) -> bool {
    [CHECK, CHECK_PICTURE].contains(&name) || MOVEMENTS.iter().any(|end| name.ends_with(end))
}

/// What would be taken for the answer in a folder: the files of a result and of a check.
fn answer(folder: &Path) -> Vec<String> {
    let earlier = earlier(folder);
    let names = own(folder).into_keys();
    names.filter(|name| earlier.contains_key(name) || is_of_check(name)).collect()
}

/// Why a file is not to be replaced, if it is there and not as a command wrote it.
fn foreign(file: &Path, own: Option<&Option<String>>) -> Option<&'static str> {
    let is_changed = |hash: &String| {
        std::fs::read(file).is_ok_and(|bytes| canonical::sha256_hex(&bytes) != *hash)
    };
    match own {
        _ if !file.exists() => None,
        None => Some("is there, and no result of facies"),
        Some(Some(hash)) if is_changed(hash) => Some("was changed since facies wrote it"),
        Some(_) => None,
    }
}

/// Refuses names of files that are there and that no command wrote, or something else changed since.
pub fn refuse_foreign<'a>(
    folder: &Path,
    names: impl IntoIterator<Item = &'a str>,
) -> Result<(), JobError> {
    let own = own(folder);
    let why = |name: &'a str| Some((name, foreign(&folder.join(name), own.get(name))?));
    match names.into_iter().find_map(why) {
        None => Ok(()),
        Some((name, why)) => Err(refused(format!(
            "{} {why}: it would be removed or replaced; give another folder",
            folder.join(name).display()
        ))),
    }
}

/// Refuses a folder with the result of another plan.
pub fn refuse_other_plan(folder: &Path, plan: &Value) -> Result<(), JobError> {
    let result = manifest(folder);
    match result.as_ref().and_then(|result| result.pointer("/provenance/plan")) {
        Some(other) if other != plan => Err(refused(format!(
            "{} holds the result of another plan, and a check beside it would be taken for its own: give another folder",
            folder.display()
        ))),
        _ => Ok(()),
    }
}

fn refused(detail: String) -> JobError {
    JobError::Refused(Problem::new(ErrorCode::ValidationFailed, detail))
}

/// Adds files to the record of a folder.
fn remember(
    folder: &Path,
    files: impl IntoIterator<Item = (String, Option<String>)>,
) -> std::io::Result<()> {
    let path = folder.join(RECORD);
    let before = std::fs::read_to_string(&path).unwrap_or_default();
    let mut record: Hashes = before.lines().map(recorded).collect();
    record.extend(files);
    let line = |(name, hash): (&String, &Option<String>)| match hash {
        Some(hash) => format!("{hash}{BETWEEN}{name}\n"),
        None => format!("{name}\n"),
    };
    let record: String = record.iter().map(line).collect();
    if record == before { Ok(()) } else { std::fs::write(path, record) }
}

/// Writes a file, unless one that no command wrote would be replaced; its hash.
pub fn put(folder: &Path, file: &str, bytes: &[u8]) -> Result<String, JobError> {
    refuse_foreign(folder, [file])?;
    let hash = canonical::sha256_hex(bytes);
    // The name first, so that half of a file is ours too.
    remember(folder, [(file.to_owned(), None)])
        .and_then(|()| std::fs::write(folder.join(file), bytes))
        .and_then(|()| remember(folder, [(file.to_owned(), Some(hash.clone()))]))
        .map_err(|source| JobError::Write { file: file.to_owned(), source })?;
    Ok(hash)
}

/// Removes files that commands wrote; one that is not there need not go.
fn remove(folder: &Path, names: &[String]) -> Result<(), JobError> {
    refuse_foreign(folder, names.iter().map(String::as_str))?;
    for name in names {
        match std::fs::remove_file(folder.join(name)) {
            Err(source) if source.kind() != ErrorKind::NotFound => {
                return Err(JobError::Write { file: name.clone(), source });
            }
            Ok(()) | Err(_) => {}
        }
    }
    Ok(())
}

/// Removes the files of an earlier check: movements of segments that the next one does not move would be taken for its own.
pub fn remove_check(folder: &Path) -> Result<(), JobError> {
    let names = own(folder).into_keys().filter(|name| is_of_check(name));
    remove(folder, &names.collect::<Vec<_>>())
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
            let why =
                "is read, and would be removed or replaced by the result: give another folder";
            Err(refused(format!("{} {why}", file.display())))
        }
        _ => Ok(()),
    }
}

/// Refuses a folder in which an earlier answer is what the job has read so far or was changed, or the manifest is none of ours.
pub fn check(place: &JobContext) -> Result<(), JobError> {
    let answer = answer(place.out);
    refuse_foreign(place.out, std::iter::once(MANIFEST).chain(answer.iter().map(String::as_str)))?;
    let inputs = inputs(place);
    answer.iter().try_for_each(|file| keep(&inputs, &place.out.join(file)))
}

fn inputs(place: &JobContext) -> Vec<PathBuf> {
    place.sources.files().iter().filter_map(|file| file.canonicalize().ok()).collect()
}

impl<'a> ResultFolder<'a> {
    /// Creates the folder if missing, and removes the files of an earlier answer in it, which could be mistaken for this one's.
    pub fn open(place: &'a JobContext) -> Result<Self, JobError> {
        let folder = place.out;
        check(place)?;
        let failed = |source| JobError::Write { file: folder.display().to_string(), source };
        std::fs::create_dir_all(folder).map_err(failed)?;
        remember(folder, own(folder)).map_err(failed)?;
        remove(folder, &answer(folder))?;
        Ok(ResultFolder { folder, files: Vec::new(), inputs: inputs(place) })
    }

    pub fn add(&mut self, name: OutputName, bytes: &[u8]) -> Result<(), JobError> {
        self.add_file(name.file_name(), name.media_type(), bytes)
    }

    /// A file that no spec names.
    pub fn add_file(&mut self, file: &str, media_type: &str, bytes: &[u8]) -> Result<(), JobError> {
        keep(&self.inputs, &self.folder.join(file))?;
        let sha256 = put(self.folder, file, bytes)?;
        self.files.push(FileDocument {
            name: file.to_owned(),
            media_type: media_type.to_owned(),
            bytes: bytes.len() as u64,
            sha256,
        });
        Ok(())
    }
}
