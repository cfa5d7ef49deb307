//! What is kept: rows in a database, bytes in blobs. Every query lives here, one file for each table.

mod audit;
mod blobs;
mod cases;
mod database;
mod deeds;
mod events;
mod fsck;
mod idempotency;
mod jobs;
mod keys;
mod leases;
mod made;
mod meshes;
mod plans;
mod queue;
mod references;
mod responses;
mod sweep;
mod tenants;
mod tombstones;
mod transfer;
mod wake;

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use tokio::sync::watch;

use crate::config::{DatabasePlace, Places};
pub use audit::{AuditRow, Chain, Deed};
use blobs::Blobs;
pub use cases::{CaseRow, Change, NewCase};
pub use database::Migrated;
pub use deeds::Begun;
pub use events::EventRow;
pub use fsck::{Dangling, Findings, Repaired};
pub use idempotency::Reserved;
pub use jobs::{Dismissal, Enqueued, JobFilter, JobRow, NewJob};
pub use keys::KeyRow;
pub use leases::{Claim, FileRow, Lease, LostRow, Point, Published, PublishedFile, Reaped};
pub use made::MadeMesh;
pub use meshes::{MeshDeletion, MeshRow, NewMesh};
pub use plans::PlanRow;
pub use queue::QueueRow;
pub use responses::{CaseResponses, ResponseRow};
pub use sweep::Swept;
pub use tenants::{DEFAULT_TENANT, TenantRow};
pub use transfer::Moved;

use database::{Address, Database, query};

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
    #[error(
        "the database is at schema step {found} and this program needs step {known}: run `facies migrate`"
    )]
    SchemaTooOld { found: i64, known: i64 },
    #[error("the schema of the database does not fit this program: {0}")]
    Schema(String),
    #[error("another facies serves this data folder")]
    InUse,
    #[error("blob {sha256} has changed on disk, its hash is {found}")]
    Integrity { sha256: String, found: String },
    #[error("blob {sha256} is not where it was kept")]
    Missing { sha256: String },
    #[error("others changed the same rows at the same time, again and again")]
    Contended,
    #[error("there is something in this deployment already: {table} has rows")]
    NotEmpty { table: &'static str },
    #[error("the export cannot be read: {0}")]
    Export(String),
    #[error("the work was interrupted")]
    Interrupted,
    #[error("the system has no random bytes")]
    NoRandomness,
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
        match self {
            StoreError::Database(error) => database::is_unavailable(error),
            // A server that does not answer, a disk that errs, no descriptor left.
            StoreError::Blobs(object_store::Error::Generic { .. }) => !self.is_full(),
            StoreError::Contended => true,
            _ => false,
        }
    }

    /// True when another setting, folder or program would help.
    pub fn is_setting(&self) -> bool {
        match self {
            StoreError::InUse
            | StoreError::Files(_)
            | StoreError::SchemaTooNew { .. }
            | StoreError::SchemaTooOld { .. }
            | StoreError::Schema(_) => true,
            StoreError::Database(error) => database::is_refused(error),
            _ => false,
        }
    }
}

fn is_full(error: &std::io::Error) -> bool {
    use std::io::ErrorKind;
    matches!(error.kind(), ErrorKind::StorageFull | ErrorKind::QuotaExceeded)
}

/// The database, the blobs and the folder for files under way, in the hand of one tenant: whoever asks for a case,
/// a mesh or a job finds those of that tenant only.
#[derive(Clone)]
pub struct Store {
    tenant: Arc<str>,
    database: Database,
    blobs: Blobs,
    folder: PathBuf,
    /// Whether other processes work on the same rows.
    shared: bool,
    /// Counts the changes of jobs, for those who wait for one.
    changes: watch::Sender<u64>,
    /// Counts those that this process made, to be told to the others.
    own_changes: watch::Sender<u64>,
    _lock: Arc<File>,
}

impl Store {
    /// Opens the store that has everything in one folder, which no other process may serve.
    pub async fn open(folder: &Path) -> Result<Store, StoreError> {
        Store::connect(&Places::in_folder(folder)).await
    }

    /// Opens the store. The data folder is that of this process alone.
    pub async fn connect(places: &Places) -> Result<Store, StoreError> {
        std::fs::create_dir_all(places.data.join("tmp"))?;
        let lock = lock(&places.data)?;
        let store = Store {
            tenant: DEFAULT_TENANT.into(),
            database: Database::open(address(places)?).await?,
            blobs: Blobs::open(places)?,
            folder: places.data.clone(),
            shared: matches!(places.database, DatabasePlace::Server { .. }),
            changes: watch::Sender::new(0),
            own_changes: watch::Sender::new(0),
            _lock: Arc::new(lock),
        };
        store.listen_to_others();
        Ok(store)
    }

    /// Brings the schema of the database up to date.
    pub async fn migrate(places: &Places) -> Result<Migrated, StoreError> {
        std::fs::create_dir_all(&places.data)?;
        // The embedded database is open in one process at a time.
        let _lock = lock(&places.data)?;
        Database::migrate(address(places)?).await
    }

    /// The same store over connections of its own, for a thread with an async runtime of its own.
    pub async fn again(&self) -> Result<Store, StoreError> {
        Ok(Store { database: self.database.again().await?, ..self.clone() })
    }

    /// The same store in the hand of another tenant.
    pub fn of_tenant(&self, tenant: &str) -> Store {
        Store { tenant: tenant.into(), ..self.clone() }
    }

    pub fn tenant(&self) -> &str {
        &self.tenant
    }

    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Where an attempt writes its files before they are published.
    pub fn attempt_folder(&self, job: &str, attempt: i64) -> PathBuf {
        self.folder.join("tmp").join(job).join(attempt.to_string())
    }

    /// Changes whenever a job does.
    pub fn job_changes(&self) -> watch::Receiver<u64> {
        self.changes.subscribe()
    }

    fn jobs_changed(&self) {
        self.changes.send_modify(|count| *count = count.wrapping_add(1));
        self.own_changes.send_modify(|count| *count = count.wrapping_add(1));
    }

    /// Whether the database answers.
    pub async fn ping(&self) -> Result<(), StoreError> {
        query("SELECT now_ms FROM clock").execute(self.database.reader()).await?;
        Ok(())
    }

    /// Whether the blobs can be reached and the data folder takes a file.
    pub async fn try_write(&self) -> Result<(), StoreError> {
        self.blobs.ping().await?;
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

fn lock(folder: &Path) -> Result<File, StoreError> {
    let lock = File::create(folder.join("lock"))?;
    lock.try_lock().map_err(|_| StoreError::InUse)?;
    Ok(lock)
}

fn address(places: &Places) -> Result<Address, StoreError> {
    Ok(match &places.database {
        DatabasePlace::Embedded => Address::File(places.data.join("facies.db")),
        DatabasePlace::Server { address, connections } => {
            Address::server(address.reveal(), *connections)?
        }
    })
}
