//! What is kept: rows in a database, bytes in blobs. Every query lives here, one file for each table.

mod blobs;
mod cases;
mod database;
mod events;
mod idempotency;
mod jobs;
mod leases;
mod meshes;
mod plans;
mod queue;
mod responses;
mod sweep;
mod tombstones;

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use tokio::sync::{RwLock, watch};

pub use blobs::Blobs;
pub use cases::{CaseRow, Change, NewCase};
pub use events::EventRow;
pub use idempotency::Reserved;
pub use jobs::{Dismissal, Enqueued, JobFilter, JobRow, NewJob};
pub use leases::{Claim, FileRow, Lease, Point, PublishedFile, Reaped};
pub use meshes::{MeshDeletion, MeshRow, NewMesh};
pub use plans::PlanRow;
pub use queue::QueueRow;
pub use responses::{CaseResponses, ResponseRow};
pub use sweep::Swept;

use database::Database;

#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    #[error("database: {0}")]
    Database(#[from] sqlx::Error),
    #[error("blobs: {0}")]
    Blobs(#[from] object_store::Error),
    #[error("file system: {0}")]
    Files(#[from] std::io::Error),
    #[error(
        "the database is at schema step {found} and this program knows steps up to {known}: start a newer program"
    )]
    SchemaTooNew { found: i64, known: i64 },
    #[error("the schema of the database does not fit this program: {0}")]
    Schema(String),
    #[error("another facies serves this data folder")]
    InUse,
    #[error("blob {sha256} has changed on disk, its hash is {found}")]
    Integrity { sha256: String, found: String },
    #[error("the work was interrupted")]
    Interrupted,
}

impl StoreError {
    /// True when the disk or the quota is full.
    pub fn is_full(&self) -> bool {
        match self {
            StoreError::Database(error) => database::is_full(error),
            StoreError::Files(error) => is_full(error),
            StoreError::Blobs(error) => {
                let mut cause: Option<&(dyn std::error::Error + 'static)> = Some(error);
                while let Some(error) = cause {
                    if error.downcast_ref::<std::io::Error>().is_some_and(is_full) {
                        return true;
                    }
                    cause = error.source();
                }
                false
            }
            _ => false,
        }
    }

    /// True when the store is busy or out of reach, so that the same request may succeed later.
    pub fn is_unavailable(&self) -> bool {
        const SQLITE_BUSY: &str = "5";
        match self {
            StoreError::Database(sqlx::Error::PoolTimedOut | sqlx::Error::PoolClosed) => true,
            StoreError::Database(sqlx::Error::Database(error)) => {
                error.code().is_some_and(|code| code == SQLITE_BUSY)
            }
            _ => false,
        }
    }
}

fn is_full(error: &std::io::Error) -> bool {
    use std::io::ErrorKind;
    matches!(error.kind(), ErrorKind::StorageFull | ErrorKind::QuotaExceeded)
}

/// The database, the blobs and the folder for files under way.
#[derive(Clone)]
pub struct Store {
    database: Database,
    blobs: Blobs,
    folder: PathBuf,
    /// Counts the changes of jobs, for those who wait for one.
    changes: watch::Sender<u64>,
    /// Shared while bytes are stored and their row is not committed yet; alone while blobs without a row go.
    uncommitted: Arc<RwLock<()>>,
    _lock: Arc<File>,
}

impl Store {
    /// Opens the store in a folder, which no other process may serve.
    pub async fn open(folder: &Path) -> Result<Store, StoreError> {
        std::fs::create_dir_all(folder.join("tmp"))?;
        let lock = File::create(folder.join("lock"))?;
        lock.try_lock().map_err(|_| StoreError::InUse)?;
        Ok(Store {
            database: Database::open(&folder.join("facies.db")).await?,
            blobs: Blobs::open(&folder.join("blobs"))?,
            folder: folder.to_owned(),
            changes: watch::Sender::new(0),
            uncommitted: Arc::default(),
            _lock: Arc::new(lock),
        })
    }

    /// The same store over connections of its own, for a thread with an async runtime of its own.
    pub async fn again(&self) -> Result<Store, StoreError> {
        Ok(Store { database: self.database.again().await?, ..self.clone() })
    }

    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Where an attempt writes its files before they are published.
    pub fn attempt_folder(&self, job: &str, attempt: i64) -> PathBuf {
        self.folder.join("tmp").join(job).join(attempt.to_string())
    }

    /// The bytes of a blob, compared with their hash.
    pub async fn read_blob(&self, sha256: &str) -> Result<bytes::Bytes, StoreError> {
        self.blobs.get(sha256).await
    }

    /// Changes whenever a job does.
    pub fn job_changes(&self) -> watch::Receiver<u64> {
        self.changes.subscribe()
    }

    fn jobs_changed(&self) {
        self.changes.send_modify(|count| *count = count.wrapping_add(1));
    }

    /// Whether the database answers.
    pub async fn ping(&self) -> Result<(), StoreError> {
        sqlx::query("SELECT now_ms FROM clock").execute(self.database.reader()).await?;
        Ok(())
    }

    /// Whether the data folder takes a file.
    pub async fn try_write(&self) -> Result<(), StoreError> {
        let place = self.folder.join("tmp").join(uuid::Uuid::now_v7().to_string());
        tokio::fs::write(&place, b"facies").await?;
        tokio::fs::remove_file(&place).await?;
        Ok(())
    }

    /// Bytes free for this user on the disk of the data folder.
    pub fn free_space(&self) -> Result<u64, StoreError> {
        let disk = rustix::fs::statvfs(&self.folder).map_err(std::io::Error::from)?;
        Ok(disk.f_bavail.saturating_mul(disk.f_frsize))
    }

    pub async fn close(&self) {
        self.database.close().await;
    }
}
