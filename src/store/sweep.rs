//! Garbage collection: files of attempts that ended without a result, bytes without a row.

use std::path::Path;
use std::time::Duration;

use super::database::query;
use super::{Store, StoreError};

const UNREFERENCED: &str = "SELECT sha256 FROM blobs \
     WHERE announced <= (SELECT now_ms FROM clock) - $1 \
     AND NOT EXISTS (SELECT 1 FROM meshes WHERE meshes.blob = blobs.sha256) \
     AND NOT EXISTS (SELECT 1 FROM job_files WHERE job_files.blob = blobs.sha256)";

/// How long another process may take from announcing bytes to referring to them without being disturbed.
pub(super) const PATIENCE: Duration = Duration::from_secs(3600);

/// Result of a garbage collection.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Swept {
    pub blobs: usize,
    pub temporary: usize,
}

impl Store {
    /// Removes everything that a process which died may have left. At the start only: the folder of
    /// temporary files belongs to the one process that holds the lock of the data folder.
    pub async fn sweep(&self) -> Result<Swept, StoreError> {
        let temporary = self.sweep_temporary()?;
        let patience = if self.shared { PATIENCE } else { Duration::ZERO };
        Ok(Swept { blobs: self.sweep_blobs(patience).await?, temporary })
    }

    /// The same in the data folder alone, where blobs cannot be reached: the number of files.
    pub fn sweep_temporary(&self) -> Result<usize, StoreError> {
        let mut temporary = 0;
        for entry in std::fs::read_dir(self.folder.join("tmp"))? {
            remove(&entry?.path())?;
            temporary += 1;
        }
        let own_blobs = self.folder.join("blobs");
        if own_blobs.exists() {
            temporary += remove_staged(&own_blobs)?;
        }
        Ok(temporary)
    }

    /// Removes bytes that were announced long ago and that nothing refers to, and those whose removal was
    /// broken off. Bytes that no row knows stay: a database that was restored from an old backup knows less
    /// than there is, and `facies admin fsck` tells.
    pub async fn sweep_old_blobs(&self) -> Result<usize, StoreError> {
        self.sweep_blobs(PATIENCE).await
    }

    pub(super) async fn sweep_blobs(&self, patience: Duration) -> Result<usize, StoreError> {
        let patience = i64::try_from(patience.as_millis()).unwrap_or(i64::MAX);
        self.finish_old(patience).await?;
        let rows = query(UNREFERENCED).bind(patience).fetch_all(self.database.reader()).await?;
        let mut removed = 0;
        for row in rows {
            let sha256: String = row.try_get(0)?;
            removed += usize::from(self.discard_one(&sha256).await?);
        }
        let rows =
            query("SELECT place FROM discarded_blobs").fetch_all(self.database.reader()).await?;
        for row in rows {
            let place: String = row.try_get(0)?;
            self.remove_bytes(&place).await?;
            removed += 1;
        }
        Ok(removed)
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
