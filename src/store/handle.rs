//! Store handle: one database and one blob store, scoped to a tenant.

use super::blobs::Blobs;
use super::database::{Address, Database, EarlierSchema, PlacedFile};
use super::error::{StoreError, at};
use super::exported_values::{JsonReader, any_object};
use super::notes::Notes;
use super::open_actions::OpenActions;
use super::spare::Spare;
use super::wake::{Changes, Wake};
use crate::config::{DatabaseLocation, StorageLocations};
use crate::store::database::schema::Migrated;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use tokio::sync::{Mutex, watch};

/// Keys in force that a tenant may have where no setting says otherwise.
const MOST_KEYS: i64 = 100;
/// Requests of a tenant that may wait to write.
const MOST_WAITING: usize = 256;

/// The tenant of all resources where none is stated.
pub const DEFAULT_TENANT: &str = "default";

/// The database, the blobs and the folder for temporary files, scoped to one tenant: cases, meshes and jobs of other
/// tenants are not found.
#[derive(Clone)]
pub struct Store {
    pub(super) tenant: Arc<str>,
    pub(super) database: Database,
    pub(super) blobs: Blobs,
    pub(super) folder: PathBuf,
    /// Whether other processes work on the same rows.
    pub(super) shared: bool,
    /// Notifies waiting requests of changed jobs.
    pub(super) wake: Wake,
    /// Beside an embedded database.
    pub(super) spare: Option<Arc<Spare>>,
    /// Whether something was erased that the files of the database may still hold.
    pub(super) holds_erased: Arc<AtomicBool>,
    /// When a row was last written to see whether one can be.
    pub(super) last_written: Arc<Mutex<Option<Instant>>>,
    /// Keys in force that a tenant may have.
    pub(super) most_keys: i64,
    /// Requests of a tenant that may wait to write.
    pub(super) most_waiting: usize,
    /// Reads the inputs of jobs of an export.
    pub(super) reads_input: JsonReader,
    pub(super) open_actions: OpenActions,
    pub(super) notes: Notes,
    /// Whether nothing is begun any more.
    pub(super) closing: Arc<watch::Sender<bool>>,
    pub(super) _lock: Arc<File>,
}

impl Store {
    /// Opens the store that has everything in one folder, which no other process may serve.
    pub async fn open(folder: &Path) -> Result<Store, StoreError> {
        Store::connect(&StorageLocations::in_folder(folder)).await
    }

    /// Opens the store, and brings an embedded database up to date. The data folder is that of this process alone.
    pub async fn connect(places: &StorageLocations) -> Result<Store, StoreError> {
        Store::connect_by(places, EarlierSchema::Migrate).await
    }

    /// Opens the store, and refuses an embedded database of an earlier schema step, which stays as it is.
    pub async fn connect_unchanged(places: &StorageLocations) -> Result<Store, StoreError> {
        Store::connect_by(places, EarlierSchema::Refuse).await
    }

    async fn connect_by(
        places: &StorageLocations,
        earlier: EarlierSchema,
    ) -> Result<Store, StoreError> {
        let temporary = places.data.join("tmp");
        std::fs::create_dir_all(&temporary).map_err(at(&temporary))?;
        let (held, lock) = lock(&places.data).await?;
        let shared = matches!(places.database, DatabaseLocation::Server { .. });
        // Before the database is opened, which may need the room.
        let spare = (!shared).then(|| Arc::new(Spare::new(&places.data)));
        let database = Database::open(address(places, lock)?, earlier).await?;
        let open_actions = OpenActions::default();
        Ok(Store {
            tenant: DEFAULT_TENANT.into(),
            blobs: Blobs::open(places)?,
            folder: places.data.clone(),
            shared,
            wake: Wake::new(database.server()),
            database,
            spare,
            // An earlier process may have been killed.
            holds_erased: Arc::new(AtomicBool::new(true)),
            last_written: Arc::default(),
            most_keys: MOST_KEYS,
            most_waiting: MOST_WAITING,
            reads_input: any_object,
            notes: Notes::of(open_actions.clone()),
            open_actions,
            closing: Arc::new(watch::Sender::new(false)),
            _lock: Arc::new(held),
        })
    }

    /// The file of the embedded database, where nothing was ever stored.
    pub fn missing(places: &StorageLocations) -> Option<PathBuf> {
        let is_embedded = matches!(places.database, DatabaseLocation::Embedded);
        let file = embedded(places);
        (is_embedded && matches!(file.try_exists(), Ok(false))).then_some(file)
    }

    /// The same store with another bound on the keys of a tenant.
    pub fn with_key_limit(self, most_keys: u32) -> Store {
        Store { most_keys: most_keys.into(), ..self }
    }

    /// The same store with another bound on the requests of a tenant that wait to write.
    pub fn with_waiting_limit(self, most_waiting: u32) -> Store {
        Store { most_waiting: most_waiting as usize, ..self }
    }

    /// The same store, which exports, imports and checks only such inputs of jobs as this reads. Without it they are objects of JSON.
    pub fn with_input_reader(self, reads_input: JsonReader) -> Store {
        Store { reads_input, ..self }
    }

    /// Brings the schema of the database up to date.
    pub async fn migrate(places: &StorageLocations) -> Result<Migrated, StoreError> {
        // The embedded database is open in one process at a time; of a shared one the data folder has nothing.
        match &places.database {
            DatabaseLocation::Server { address, connections } => {
                Database::migrate(Address::server(address.reveal(), *connections)?).await
            }
            DatabaseLocation::Embedded => {
                std::fs::create_dir_all(&places.data).map_err(at(&places.data))?;
                let locked = lock(&places.data).await;
                let (_held, lock) = locked.map_err(|error| match error {
                    StoreError::InUse { folder } => StoreError::ServedAlready { folder },
                    other => other,
                })?;
                Database::migrate(address(places, lock)?).await
            }
        }
    }

    /// The same store over connections of its own, for a thread with an async runtime of its own.
    pub async fn again(&self) -> Result<Store, StoreError> {
        Ok(Store { database: self.database.again().await?, ..self.clone() })
    }

    /// The same store scoped to another tenant.
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

    /// Receiver of changes of jobs.
    pub fn job_changes(&self) -> Changes {
        self.wake.changes()
    }

    /// To be told after a change of a job was committed.
    pub(super) fn job_changed(&self, job: &str) {
        self.wake.tell(job);
    }

    /// Makes sure of the room in reserve before bytes are stored; an error of a full disk where there is none.
    pub(super) fn reserve_room(&self) -> Result<(), StoreError> {
        match &self.spare {
            Some(spare) => Ok(spare.hold()?),
            None => Ok(()),
        }
    }

    /// Releases the reserved disk space where the disk is full, so that something can be erased; where none is left, it
    /// checkpoints the log of the database.
    pub async fn release_reserve(&self) {
        let Some(spare) = &self.spare else { return };
        if !spare.release_reserve() {
            self.shorten_log().await;
        }
    }

    /// Reserves disk space again after something was erased, as much as there is, before other writers take it.
    pub async fn refill_reserve(&self) {
        let Some(spare) = &self.spare else { return };
        if spare.is_whole() {
            return;
        }
        self.shorten_log().await;
        spare.fill_reserve();
    }

    /// Whether bytes can be stored, as far as the room in reserve is concerned.
    pub fn has_room(&self) -> bool {
        self.spare.as_ref().is_none_or(|spare| spare.has_room())
    }

    async fn shorten_log(&self) {
        if let Err(error) = self.database.empty_log().await {
            tracing::warn!(%error, "the log of the database stays as long as it is");
        }
    }

    /// Marks that the files of the database may hold erased data.
    pub(super) fn mark_erased(&self) {
        self.holds_erased.store(true, Ordering::Relaxed);
    }

    /// Wipes erased data from the files of the database; false while a reader or a writer prevents it.
    pub async fn wipe(&self) -> Result<bool, StoreError> {
        if !self.holds_erased.swap(false, Ordering::Relaxed) {
            return Ok(true);
        }
        let wiped = self.database.empty_log().await;
        if !matches!(wiped, Ok(true)) {
            self.mark_erased();
        }
        wiped
    }

    /// Ends what goes on beside requests, and closes the database.
    pub async fn close(&self) {
        self.closing.send_replace(true);
        self.database.close().await;
    }

    /// Whether it is closed or about to be.
    pub fn is_closing(&self) -> bool {
        *self.closing.borrow()
    }

    /// Waits for so long; false as soon as the store is closed, for what goes on again and again.
    pub async fn is_open_after(&self, pause: Duration) -> bool {
        let mut closing = self.closing.subscribe();
        let closed = closing.wait_for(|closing| *closing);
        tokio::time::timeout(pause, closed).await.is_err()
    }
}

/// How long a start waits for the data folder: a process that was killed may hold it a little longer.
const LOCK_WITHIN: Duration = Duration::from_secs(3);
const LOCK_PAUSE: Duration = Duration::from_millis(50);

/// The lock of a data folder, held as long as the file is open.
async fn lock(folder: &Path) -> Result<(File, PlacedFile), StoreError> {
    let path = folder.join("lock");
    let until = Instant::now() + LOCK_WITHIN;
    loop {
        // What is there is neither emptied nor, where it is a pipe, waited for.
        let mut options = File::options();
        let options = options.read(true).write(true).create(true).truncate(false);
        let held = options.open(&path).map_err(at(&path))?;
        if held.try_lock().is_ok() {
            let lock = PlacedFile::new(path.clone(), &held.metadata()?);
            // One that was removed meanwhile keeps nobody out.
            if lock.is_in_place()? {
                return Ok((held, lock));
            }
        }
        if Instant::now() >= until {
            return Err(StoreError::InUse { folder: folder.to_owned() });
        }
        tokio::time::sleep(LOCK_PAUSE).await;
    }
}

fn embedded(places: &StorageLocations) -> PathBuf {
    places.data.join("facies.db")
}

/// `lock` is that of the data folder.
fn address(places: &StorageLocations, lock: PlacedFile) -> Result<Address, StoreError> {
    Ok(match &places.database {
        DatabaseLocation::Embedded => Address::File { path: embedded(places), lock },
        DatabaseLocation::Server { address, connections } => {
            Address::server(address.reveal(), *connections)?
        }
    })
}

/// What is wrong with the address of a server, if anything is.
pub fn address_fault(address: &str) -> Option<String> {
    Address::server(address, 1).err().map(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test(flavor = "multi_thread")]
    async fn a_folder_that_a_process_is_about_to_leave_is_waited_for() {
        let folder = tempfile::tempdir().unwrap();
        let held = File::create(folder.path().join("lock")).unwrap();
        held.lock().unwrap();
        let mut opening = std::pin::pin!(Store::open(folder.path()));
        let early = tokio::time::timeout(Duration::from_millis(1), &mut opening).await;
        assert!(early.is_err(), "it neither serves the folder nor gives up");
        drop(held);
        opening.await.unwrap();
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn what_goes_on_again_and_again_ends_as_soon_as_the_store_is_closed() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).await.unwrap();
        assert!(store.is_open_after(Duration::from_millis(1)).await && !store.is_closing());
        let hour = Duration::from_secs(3600);
        let other = store.clone();
        let again = tokio::spawn(async move { other.is_open_after(hour).await });
        store.close().await;
        let ended = tokio::time::timeout(Duration::from_secs(60), again).await;
        assert!(!ended.unwrap().unwrap() && store.is_closing());
        assert!(!store.is_open_after(hour).await, "nor does it begin again");
    }
}
