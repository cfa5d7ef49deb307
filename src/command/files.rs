//! Meshes out of files, by paths relative to a folder.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use crate::jobs::{MeshSource, SourceError, StoredMesh};
use crate::schema::case::document::LengthUnit;
use crate::schema::wire::canonical;
use mechanics::format::{self, ReadLimits};

/// Reads each file once.
pub struct FileSource {
    folder: PathBuf,
    /// What every mesh is in; absent where each case says it for its own.
    units: Option<LengthUnit>,
    read: Mutex<BTreeMap<String, StoredMesh>>,
}

impl FileSource {
    pub fn new(folder: &Path, units: LengthUnit) -> Self {
        FileSource { units: Some(units), ..FileSource::of_any_unit(folder) }
    }

    pub fn of_any_unit(folder: &Path) -> Self {
        FileSource { folder: folder.to_owned(), units: None, read: Mutex::default() }
    }
}

impl MeshSource for FileSource {
    fn mesh(&self, id: &str) -> Result<StoredMesh, SourceError> {
        let mut read = self.read.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(known) = read.get(id) {
            return Ok(known.clone());
        }
        let bytes = std::fs::read(self.folder.join(id)).map_err(|error| match error.kind() {
            ErrorKind::NotFound => SourceError::Unknown { id: id.to_owned() },
            _ => SourceError::Unreadable {
                id: id.to_owned(),
                detail: error.to_string(),
                may_pass: false,
            },
        })?;
        let mesh = format::read(&bytes, &ReadLimits::default()).map_err(|error| {
            let (code, detail) = ((&error).into(), error.to_string());
            SourceError::Refused { id: id.to_owned(), code, detail }
        })?;
        let stored = StoredMesh::new(mesh, self.units, canonical::sha256_hex(&bytes));
        read.insert(id.to_owned(), stored.clone());
        Ok(stored)
    }

    fn predicted_skin(&self, job: &str) -> Result<StoredMesh, SourceError> {
        Err(SourceError::Unknown { id: job.to_owned() })
    }
}

/// A path that leads from a folder to a file, for documents that may move together with their meshes.
pub fn relative(file: &Path, folder: &Path) -> PathBuf {
    let (Ok(file), Ok(folder)) = (file.canonicalize(), folder.canonicalize()) else {
        return file.to_owned();
    };
    let common = file.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    let up = folder.components().skip(common).map(|_| Path::new(".."));
    let down = file.components().skip(common);
    up.map(Path::to_owned).chain(down.map(|part| Path::new(part.as_os_str()).to_owned())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_relative_path_leads_to_the_file() {
        let root = tempfile::tempdir().expect("a folder");
        let (near, far) = (root.path().join("a/b"), root.path().join("c"));
        std::fs::create_dir_all(&near).expect("made");
        std::fs::create_dir_all(&far).expect("made");
        let file = far.join("mesh.vtu");
        std::fs::write(&file, "").expect("written");
        assert_eq!(relative(&file, &near), Path::new("../../c/mesh.vtu"));
        assert_eq!(relative(&file, &far), Path::new("mesh.vtu"));
    }
}
