//! The folder of a result: each file with its size and hash.

use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::jobs::failure::JobError;
use crate::jobs::output::JobContext;
use crate::jobs::result::record::{self, Record, RecordedFile, refused};
use crate::schema::predict::document::OutputName;
use crate::schema::predict::output::media_type_of;
use crate::schema::predict::result::FileDocument;
use crate::schema::wire::canonical;

/// The manifest of a result.
const MANIFEST: &str = "result.json";

/// Documents beside results that have no record, of earlier versions.
const BESIDE: [&str; 2] = ["case.json", "plan.json"];

/// The document of a check, and its picture.
pub const CHECK: &str = "check.json";
pub const CHECK_PICTURE: &str = "classes.svg";

/// The ends of names of movements, which a check writes and nothing else.
const MOVEMENTS: [&str; 2] = [".txt", ".tfm"];

/// The manifest in a folder, unless it is one that no job wrote.
fn manifest(folder: &Path) -> Option<Value> {
    let manifest = std::fs::read(folder.join(MANIFEST)).ok()?;
    let result: Value = serde_json::from_slice(&manifest).ok()?;
    result.pointer("/provenance/engine").is_some().then_some(result)
}

/// The files that the manifest in a folder names, and itself.
fn earlier(folder: &Path) -> Record {
    let Some(result) = manifest(folder) else { return Record::new() };
    let files = result.get("files").and_then(|files| files.as_array()).into_iter().flatten();
    let member = |file: &Value, name: &str| Some(file.get(name)?.as_str()?.to_owned());
    let named = files.filter_map(|file| Some((member(file, "name")?, member(file, "sha256"))));
    let own = named.filter(|(name, _)| record::is_plain(name));
    let all = std::iter::once((MANIFEST.to_owned(), None)).chain(own);
    all.map(|(name, hash)| (name, RecordedFile { hash, of_result: true })).collect()
}

/// The files in a folder that may be replaced.
fn own(folder: &Path) -> Result<Record, JobError> {
    let mut own = earlier(folder);
    match record::read(folder)? {
        Some(record) => own.extend(record),
        None if own.is_empty() => {}
        None => own.extend(BESIDE.map(|name| (name.to_owned(), RecordedFile::default()))),
    }
    Ok(own)
}

fn is_of_check(name: &str) -> bool {
    [CHECK, CHECK_PICTURE].contains(&name) || MOVEMENTS.iter().any(|end| name.ends_with(end))
}

/// What would be taken for the answer in a folder: the files of a result, be it a whole one, and of a check. The manifest is the first:
/// without it nothing is an answer.
fn answer(folder: &Path) -> Result<Vec<String>, JobError> {
    let earlier = earlier(folder);
    let is_of_answer = |name: &str, recorded: &RecordedFile| {
        recorded.of_result || earlier.contains_key(name) || is_of_check(name)
    };
    let own = own(folder)?.into_iter();
    let names = own.filter(|(name, recorded)| is_of_answer(name, recorded)).map(|(name, _)| name);
    let mut names: Vec<String> = names.collect();
    names.sort_by_key(|name| name != MANIFEST);
    Ok(names)
}

/// Why a file is not to be replaced, if it is there and not as a command wrote it, as a link is not.
fn foreign(file: &Path, own: Option<&RecordedFile>) -> Option<&'static str> {
    let found = std::fs::symlink_metadata(file).ok()?;
    let Some(own) = own else { return Some("is there, and no result of facies") };
    let is_changed = |hash: &String| {
        std::fs::read(file).is_ok_and(|bytes| canonical::sha256_hex(&bytes) != *hash)
    };
    let is_foreign = !found.is_file() || own.hash.as_ref().is_some_and(is_changed);
    is_foreign.then_some("was changed since facies wrote it")
}

/// Refuses names of files that are there and that no command wrote, or something else changed since.
pub fn refuse_foreign<'a>(
    folder: &Path,
    names: impl IntoIterator<Item = &'a str>,
) -> Result<(), JobError> {
    let own = own(folder)?;
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

/// Writes a file beside a result, unless one that no command wrote would be replaced.
pub fn put(folder: &Path, file: &str, bytes: &[u8]) -> Result<(), JobError> {
    put_as(folder, file, bytes, false).map(|_| ())
}

/// Writes a file; its hash.
fn put_as(folder: &Path, file: &str, bytes: &[u8], of_result: bool) -> Result<String, JobError> {
    refuse_foreign(folder, [file])?;
    let hash = canonical::sha256_hex(bytes);
    let written = |hash| [(file.to_owned(), RecordedFile { hash, of_result })];
    // The name first, so that half of a file is ours too.
    record::add(folder, written(None))?;
    remove_file(folder, file)?;
    // Never through a link that came to be there meanwhile.
    File::create_new(folder.join(file))
        .and_then(|mut made| made.write_all(bytes))
        .map_err(|source| JobError::Write { file: file.to_owned(), source })?;
    record::add(folder, written(Some(hash.clone())))?;
    Ok(hash)
}

/// Removes files that commands wrote.
fn remove(folder: &Path, names: &[String]) -> Result<(), JobError> {
    refuse_foreign(folder, names.iter().map(String::as_str))?;
    names.iter().try_for_each(|name| remove_file(folder, name))?;
    record::forget(folder, names)
}

/// One that is not there need not go.
fn remove_file(folder: &Path, file: &str) -> Result<(), JobError> {
    match std::fs::remove_file(folder.join(file)) {
        Err(source) if source.kind() != ErrorKind::NotFound => {
            Err(JobError::Write { file: file.to_owned(), source })
        }
        Ok(()) | Err(_) => Ok(()),
    }
}

/// Removes the files of an earlier check: movements of segments that the next one does not move would be taken for its own.
pub fn remove_check(folder: &Path) -> Result<(), JobError> {
    let names = own(folder)?.into_keys().filter(|name| is_of_check(name));
    remove(folder, &names.collect::<Vec<_>>())
}

/// Refuses to remove an earlier answer where its disk has no room for as much again: the next one could not be written, and both
/// would be lost.
fn require_room(folder: &Path, answer: &[String], free: u64) -> Result<(), JobError> {
    let size = |name: &String| folder.join(name).symlink_metadata().map_or(0, |found| found.len());
    let bytes: u64 = answer.iter().map(size).sum();
    if bytes <= free {
        return Ok(());
    }
    let detail = format!(
        "it has an earlier result of {bytes} bytes, and its disk has {free} bytes left, too few for as much again: nothing was removed"
    );
    let source = std::io::Error::new(ErrorKind::StorageFull, detail);
    Err(JobError::Write { file: folder.display().to_string(), source })
}

/// The bytes left on the disk of a folder, as far as that is known.
fn free_bytes(folder: &Path) -> u64 {
    rustix::fs::statvfs(folder).map_or(u64::MAX, |disk| disk.f_bavail.saturating_mul(disk.f_frsize))
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
    let answer = answer(place.out)?;
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
        let earlier = answer(folder)?;
        require_room(folder, &earlier, free_bytes(folder))?;
        record::add(folder, own(folder)?)?;
        remove(folder, &earlier)?;
        remove(folder, &place.sources.beside_result())?;
        Ok(ResultFolder { folder, files: Vec::new(), inputs: inputs(place) })
    }

    pub fn add(&mut self, name: OutputName, bytes: &[u8]) -> Result<(), JobError> {
        self.add_file(name.file_name(), name.media_type(), bytes)
    }

    /// A file that no spec names.
    pub fn add_file(&mut self, file: &str, media_type: &str, bytes: &[u8]) -> Result<(), JobError> {
        // An import refuses any other.
        debug_assert_eq!(media_type_of(file), Some(media_type));
        keep(&self.inputs, &self.folder.join(file))?;
        let sha256 = put_as(self.folder, file, bytes, true)?;
        self.files.push(FileDocument {
            name: file.to_owned(),
            media_type: media_type.to_owned(),
            bytes: bytes.len() as u64,
            sha256,
        });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::ErrorCode;

    #[test]
    fn an_earlier_answer_stays_where_there_is_no_room_for_as_much_again() {
        let folder = tempfile::tempdir().unwrap();
        let mut names = Vec::new();
        for (name, content) in [("skin.vtp", "skin"), (MANIFEST, "manifest")] {
            put_as(folder.path(), name, content.as_bytes(), true).unwrap();
            names.push(name.to_owned());
        }
        assert_eq!(answer(folder.path()).unwrap().len(), 2);
        assert!(require_room(folder.path(), &names, 12).is_ok());
        let refused = require_room(folder.path(), &names, 11).unwrap_err();
        assert!(refused.to_string().contains("earlier result of 12 bytes"), "{refused}");
        assert_eq!(refused.kind(), ErrorCode::Storage);
        // Nothing has to go where nothing was.
        assert!(require_room(folder.path(), &[], 0).is_ok());
        assert!(free_bytes(folder.path()) > 0);
    }
}
