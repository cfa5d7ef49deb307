//! Writability of the store, for readiness.

use std::time::{Duration, Instant};

use super::blob_operations::in_time;
use super::database::{is_read_only, query};
use super::spare::free_bytes;
use super::{Store, StoreError};

/// A row that is gone again when it is committed, in a table that nothing refers to.
const WRITE: &str = "INSERT INTO unfinished_blobs (id, place, begun) VALUES ($1, '', 0)";
const TAKE_BACK: &str = "DELETE FROM unfinished_blobs WHERE id = $1";
/// The newest rows of what requests use: where the newest pages of a database are damaged or lost, its other ones may well answer.
const NEWEST: &str = "SELECT (SELECT updated FROM cases ORDER BY id DESC LIMIT 1), \
     (SELECT updated FROM plans ORDER BY id DESC LIMIT 1), (SELECT created FROM jobs ORDER BY id DESC LIMIT 1), \
     (SELECT created FROM meshes ORDER BY id DESC LIMIT 1), (SELECT created FROM keys ORDER BY id DESC LIMIT 1), \
     (SELECT at FROM deeds ORDER BY id DESC LIMIT 1)";

/// How long readiness waits for the storage.
const STORAGE_WITHIN: Duration = Duration::from_secs(2);

/// A check of the storage that failed, by its name in the response of readiness, and the reason for the log.
#[derive(Debug)]
pub struct StorageFault {
    pub check: &'static str,
    pub reason: String,
}

/// More frequent requests get the last result.
const WRITTEN_EVERY: Duration = Duration::from_secs(1);

impl Store {
    /// Whether the newest rows can be read.
    pub(super) async fn check_readable(&self) -> Result<(), StoreError> {
        query(NEWEST).execute(self.database.reader()).await?;
        Ok(())
    }

    /// Whether the database answers and takes a row. A commit that failed may leave a database that answers and does not.
    pub async fn ping(&self) -> Result<(), StoreError> {
        self.check_readable().await?;
        let mut last = self.last_written.lock().await;
        if last.is_some_and(|last| last.elapsed() < WRITTEN_EVERY) {
            return Ok(());
        }
        *last = None;
        let id = uuid::Uuid::now_v7().to_string();
        let mut transaction = self.database.begin_unflushed().await?;
        query(WRITE).bind(&id).execute(&mut transaction).await?;
        query(TAKE_BACK).bind(&id).execute(&mut transaction).await?;
        transaction.commit().await?;
        *last = Some(Instant::now());
        Ok(())
    }

    /// Whether the database takes a row, for a start: one that can only be read serves nobody.
    pub async fn check_writable(&self) -> Result<(), StoreError> {
        match self.ping().await {
            Err(StoreError::Database(source)) if is_read_only(&source) => {
                Err(StoreError::ReadOnly { place: self.database.place(), source })
            }
            tried => tried,
        }
    }

    /// The same within so long.
    pub async fn check_blobs_within(&self, limit: Duration) -> Result<(), StoreError> {
        in_time(limit, self.check_blobs()).await
    }

    /// Whether the blobs can be reached, are those of this database and, where other hosts share it, those that they name: what is kept
    /// elsewhere is lost to the others.
    pub async fn check_blobs(&self) -> Result<(), StoreError> {
        self.blobs.ping().await?;
        self.check_whose().await
    }

    async fn check_whose(&self) -> Result<(), StoreError> {
        if self.shared {
            let newest = self.newest().await?;
            if newest.meshes > 0 && !newest.is_there {
                return Err(StoreError::OtherBlobs { meshes: newest.meshes });
            }
        }
        self.check_owner().await
    }

    /// Whether the store of blobs answers and is read, or its folder takes a file, and the data folder takes one. Asks no database.
    async fn try_write(&self) -> Result<(), StoreError> {
        self.blobs.ping().await?;
        self.blobs.owner().await?;
        let place = self.folder.join("tmp").join(uuid::Uuid::now_v7().to_string());
        tokio::fs::write(&place, b"facies").await?;
        tokio::fs::remove_file(&place).await?;
        Ok(())
    }

    /// Whether blobs are in order and the data folder takes a file, within so long.
    async fn check_storage(&self, limit: Duration) -> Result<(), StoreError> {
        let begun = Instant::now();
        in_time(limit, self.try_write()).await?;
        match in_time(limit.saturating_sub(begun.elapsed()), self.check_whose()).await {
            // The store of blobs has just answered: it is the database that does not, which has a check of its own.
            Err(
                StoreError::Database(_) | StoreError::DatabaseFile(_) | StoreError::NoAnswer { .. },
            ) => Ok(()),
            checked => checked,
        }
    }

    /// What keeps results and uploads from being stored, nothing where they can be: blobs and the data folder take files within
    /// two seconds, the folder has `floor_bytes` free, and there is room for the reserve.
    pub async fn storage_faults(&self, floor_bytes: u64) -> Vec<StorageFault> {
        let mut faults = Vec::new();
        if let Err(error) = self.check_storage(STORAGE_WITHIN).await {
            faults.push(StorageFault { check: "storage", reason: error.to_string() });
        }
        let short = match self.free_space() {
            Ok(free) if free < floor_bytes => {
                Some(format!("{free} bytes are free, less than {floor_bytes}"))
            }
            Ok(_) if !self.has_room() => Some("there is no room for the reserve".to_owned()),
            Ok(_) => None,
            Err(error) => Some(error.to_string()),
        };
        faults.extend(short.map(|reason| StorageFault { check: "free-space", reason }));
        faults
    }

    /// Bytes free for this user on the disk of the data folder.
    pub fn free_space(&self) -> Result<u64, StoreError> {
        Ok(free_bytes(&self.folder)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{BlobLocation, StorageLocations};

    async fn with_blobs_in_a_folder() -> (tempfile::TempDir, Store) {
        let folder = tempfile::tempdir().unwrap();
        let blobs = BlobLocation::Folder(folder.path().join("blobs"));
        let places = StorageLocations::in_folder(&folder.path().join("data"));
        let store = Store::connect(&StorageLocations { blobs, ..places }).await.unwrap();
        store.check_blobs().await.unwrap();
        (folder, store)
    }

    #[tokio::test]
    async fn storage_is_sound_while_only_the_database_fails_or_does_not_answer() {
        let (folder, store) = with_blobs_in_a_folder().await;
        let mut readers = Vec::new();
        for _ in 0..4 {
            readers.push(store.database.snapshot().await.unwrap());
        }
        let asked = in_time(STORAGE_WITHIN, store.check_owner()).await;
        assert!(matches!(asked, Err(StoreError::NoAnswer { .. })), "{asked:?}");
        store.check_storage(STORAGE_WITHIN).await.unwrap();
        drop(readers);
        std::fs::remove_file(folder.path().join("data/facies.db")).unwrap();
        assert!(store.ping().await.is_err() && store.check_owner().await.is_err());
        store.check_storage(STORAGE_WITHIN).await.unwrap();
        std::fs::remove_dir_all(folder.path().join("blobs")).unwrap();
        assert!(store.check_storage(STORAGE_WITHIN).await.is_err());
    }
}
