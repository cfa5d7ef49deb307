//! The record of a folder: which files commands wrote into it, and with which bytes.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Component, Path};

use crate::jobs::failure::JobError;
use crate::schema::{ErrorCode, Problem};

/// All files that were ever written into a folder, a line each, as `sha256sum` writes it: no other is replaced, and none that has other
/// bytes by now. One that is being written has dashes in place of its hash.
const RECORD: &str = ".facies";

/// The length of a hash in a record, and what follows it.
const HASH: usize = 64;
const BESIDE: &str = "  ";
const OF_RESULT: &str = " *";

/// A file that a command wrote.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecordedFile {
    /// Of its bytes, if all of them were written.
    pub hash: Option<String>,
    /// Whether it is a part of a result, with which it is removed.
    pub of_result: bool,
}

/// Files by name.
pub type Record = BTreeMap<String, RecordedFile>;

/// Whether a name is that of a file in a folder, and leads to no other.
pub fn is_plain(name: &str) -> bool {
    let mut parts = Path::new(name).components();
    matches!((parts.next(), parts.next()), (Some(Component::Normal(part)), None) if part == name)
}

/// The record of a folder, if there is one; what no command wrote there is refused.
pub fn read(folder: &Path) -> Result<Option<Record>, JobError> {
    let path = folder.join(RECORD);
    let known = match std::fs::symlink_metadata(&path) {
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
            return Ok(None);
        }
        Ok(found) if found.is_file() => std::fs::read_to_string(&path).ok(),
        Ok(_) | Err(_) => None,
    };
    match known.and_then(|text| text.lines().map(line).collect()) {
        Some(record) => Ok(Some(record)),
        None => Err(refused(format!(
            "{} is there, and no record that facies wrote: it would be replaced; give another folder",
            path.display()
        ))),
    }
}

/// The file that a line is of.
fn line(line: &str) -> Option<(String, RecordedFile)> {
    let (hash, rest) = line.split_at_checked(HASH)?;
    let (of_result, name) = match rest.strip_prefix(OF_RESULT) {
        Some(name) => (true, name),
        None => (false, rest.strip_prefix(BESIDE)?),
    };
    let is_hash = hash.bytes().all(|digit| digit.is_ascii_hexdigit());
    let is_unfinished = hash.bytes().all(|digit| digit == b'-');
    let hash = is_hash.then(|| hash.to_owned());
    ((is_hash || is_unfinished) && is_plain(name))
        .then(|| (name.to_owned(), RecordedFile { hash, of_result }))
}

/// Adds files to the record of a folder.
pub fn add(
    folder: &Path,
    files: impl IntoIterator<Item = (String, RecordedFile)>,
) -> Result<(), JobError> {
    change(folder, |record| record.extend(files))
}

/// Files that are gone: whoever makes one of the same name is not facies.
pub fn forget(folder: &Path, names: &[String]) -> Result<(), JobError> {
    change(folder, |record| record.retain(|name, _| !names.contains(name)))
}

fn change(folder: &Path, make: impl FnOnce(&mut Record)) -> Result<(), JobError> {
    let before = read(folder)?.unwrap_or_default();
    let mut record = before.clone();
    make(&mut record);
    if record == before {
        return Ok(());
    }
    let line = |(name, recorded): (&String, &RecordedFile)| {
        let hash = recorded.hash.as_deref().unwrap_or_default();
        format!("{hash:-<HASH$}{}{name}\n", if recorded.of_result { OF_RESULT } else { BESIDE })
    };
    let text: String = record.iter().map(line).collect();
    replace(folder, text.as_bytes())
        .map_err(|source| JobError::Write { file: RECORD.to_owned(), source })
}

/// A record is whole at every moment: without it no file of the folder is known.
fn replace(folder: &Path, text: &[u8]) -> std::io::Result<()> {
    let part = folder.join(format!("{RECORD}-{}", uuid::Uuid::now_v7()));
    let written = File::create_new(&part)
        .and_then(|mut file| file.write_all(text))
        .and_then(|()| std::fs::rename(&part, folder.join(RECORD)));
    if written.is_err() {
        let _ = std::fs::remove_file(&part);
    }
    written
}

pub fn refused(detail: String) -> JobError {
    JobError::Refused(Problem::new(ErrorCode::ValidationFailed, detail))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_names_files_of_its_folder_alone() {
        let hash = "a".repeat(HASH);
        let names = |text: &str| Some(line(text)?.0);
        assert_eq!(names(&format!("{hash}  skin.vtp")).as_deref(), Some("skin.vtp"));
        assert_eq!(names(&format!("{} *a b.txt", "-".repeat(HASH))).as_deref(), Some("a b.txt"));
        for name in ["../keep.txt", "/keep.txt", "a/b", "a/", "./a", ".", "..", ""] {
            assert_eq!(names(&format!("{hash}  {name}")), None, "{name:?}");
        }
        for foreign in ["my own notes".to_owned(), format!("{hash} skin.vtp"), hash] {
            assert_eq!(names(&foreign), None, "{foreign:?}");
        }
    }

    #[test]
    fn what_is_added_to_a_record_is_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let recorded = |hash: Option<&str>, of_result| RecordedFile {
            hash: hash.map(|digit| digit.repeat(HASH)),
            of_result,
        };
        let one = ("a.vtp".to_owned(), recorded(None, true));
        let other = ("b b.txt".to_owned(), recorded(Some("b"), false));
        add(folder.path(), [one.clone()]).unwrap();
        add(folder.path(), [other.clone()]).unwrap();
        assert_eq!(read(folder.path()).unwrap(), Some(Record::from([one, other])));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        forget(folder.path(), &["a.vtp".to_owned()]).unwrap();
        let left = read(folder.path()).unwrap().unwrap_or_default();
        assert_eq!(left.into_keys().collect::<Vec<_>>(), ["b b.txt"]);
    }
}
