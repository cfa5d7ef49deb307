//! The store as all others see it: one database and one place for bytes, scoped to a tenant.

use super::blobs::Blobs;
use super::database::{Address, Database, query};
use super::error::StoreError;
use super::open_deeds::OpenDeeds;
use crate::config::{DatabasePlace, Places};
use crate::store::database::schema::Migrated;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tokio::sync::watch;

/// Whose everything is where nobody says otherwise.
pub const DEFAULT_TENANT: &str = "default";

/// The database, the blobs and the folder for files under way, in the hand of one tenant: whoever asks for a case,
/// a mesh or a job finds those of that tenant only.
#[derive(Clone)]
pub struct Store {
    pub(super) tenant: Arc<str>,
    pub(super) database: Database,
    pub(super) blobs: Blobs,
    pub(super) folder: PathBuf,
    /// Whether other processes work on the same rows.
    pub(super) shared: bool,
    /// Counts the changes of jobs, for those who wait for one.
    pub(super) changes: watch::Sender<u64>,
    /// Counts those that this process made, to be told to the others.
    pub(super) own_changes: watch::Sender<u64>,
    pub(super) open_deeds: OpenDeeds,
    pub(super) _lock: Arc<File>,
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
            open_deeds: OpenDeeds::default(),
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

    pub(super) fn jobs_changed(&self) {
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
