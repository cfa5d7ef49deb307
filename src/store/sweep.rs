//! What nobody refers to goes: files of attempts that ended without a result, blobs without a row.

use std::collections::HashSet;
use std::path::Path;

use sqlx::Row as _;

use super::{Store, StoreError};

const REFERENCED: &str = "SELECT blob FROM meshes UNION SELECT blob FROM job_files";
const REFERENCES_OF: &str = "SELECT (SELECT COUNT(*) FROM meshes WHERE blob = $1) \
     + (SELECT COUNT(*) FROM job_files WHERE blob = $1)";

/// What a sweep removed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Swept {
    pub blobs: usize,
    pub temporary: usize,
}

impl Store {
    /// Removes everything that a process which died may have left. At the start only: the folder of
    /// temporary files belongs to the one process that holds the lock of the data folder.
    pub async fn sweep(&self) -> Result<Swept, StoreError> {
        let _alone = self.uncommitted.write().await;
        let mut temporary = 0;
        for entry in std::fs::read_dir(self.folder.join("tmp"))? {
            remove(&entry?.path())?;
            temporary += 1;
        }
        temporary += remove_staged(&self.folder.join("blobs"))?;
        let rows = sqlx::query(REFERENCED).fetch_all(self.database.writer()).await?;
        let referenced =
            rows.iter().map(|row| row.try_get(0)).collect::<Result<HashSet<String>, _>>()?;
        let mut blobs = 0;
        for blob in self.blobs.list().await? {
            if !referenced.contains(&blob) {
                self.blobs.delete(&blob).await?;
                blobs += 1;
            }
        }
        Ok(Swept { blobs, temporary })
    }

    /// Removes those of the given blobs that no row refers to.
    pub(super) async fn delete_unreferenced_blobs(
        &self,
        blobs: Vec<String>,
    ) -> Result<(), StoreError> {
        let _alone = self.uncommitted.write().await;
        for blob in blobs {
            let row =
                sqlx::query(REFERENCES_OF).bind(&blob).fetch_one(self.database.writer()).await?;
            if row.try_get::<i64, _>(0)? == 0 {
                self.blobs.delete(&blob).await?;
            }
        }
        Ok(())
    }
}

fn remove(path: &Path) -> std::io::Result<()> {
    if path.is_dir() { std::fs::remove_dir_all(path) } else { std::fs::remove_file(path) }
}

/// Blobs that were being written carry a `#` in their name until they are linked to their place.
fn remove_staged(folder: &Path) -> std::io::Result<usize> {
    let mut removed = 0;
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            removed += remove_staged(&path)?;
        } else if path.file_name().is_some_and(|name| name.to_string_lossy().contains('#')) {
            std::fs::remove_file(path)?;
            removed += 1;
        }
    }
    Ok(removed)
}
