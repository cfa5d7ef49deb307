//! References to stored bytes. A row of `blobs` says where the bytes of a hash are; rows of meshes and of files of jobs
//! refer to it by the hash.
//!
//! Any number of processes store, refer to and discard the same bytes at the same time, and any of them may
//! stop at any point and go on much later. What holds all the same is that every row that refers to a hash
//! finds its bytes, for two reasons:
//!
//! 1. *A place is used once.* Storing begins with a row of its own (`announce`), whose place carries a fresh
//!    id. Bytes go to that place, and the row is locked and compared again in the transaction that refers to it
//!    (`hold`). Where it was discarded meanwhile, storing begins anew, at another place. So a deletion that was
//!    sent and arrives late, or one by a process that slept for an hour, meets a place that nobody uses.
//! 2. *A row is discarded under its lock.* The lock waits for those who `hold` it, and the statement that looks
//!    for references comes after the lock, so that it sees whatever they committed. From then on the place
//!    stands in `discarded_blobs` until its bytes are gone: a process that dies in between leaves it to others.
//!
//! What is written late to a place that was discarded must not stay there unseen: a place stands in `unfinished_blobs`
//! from before its bytes are written until a row refers to them, so that the sweep finds what is left of those who died.
//!
//! None of this counts on a clock. The time of the announcement only keeps the garbage collection away from writes in
//! progress.

use std::fs::File;

use bytes::Bytes;

use super::database::{Transaction, query};
use super::files::FoundBlob;
use super::{Store, StoreError};

/// Bytes by their hash, to be stored.
pub(super) type Content = (String, Bytes);

/// Bytes that are stored in a place of their own and not yet referred to.
pub(super) struct Stored {
    /// Of its row in `unfinished_blobs`.
    id: String,
    sha256: String,
    place: String,
}

const ANNOUNCE: &str = "INSERT INTO blobs (sha256, place, announced) \
     VALUES ($1, $2, (SELECT now_ms FROM clock)) \
     ON CONFLICT (sha256) DO UPDATE SET announced = excluded.announced RETURNING place";
const WRITE: &str = "INSERT INTO unfinished_blobs (id, place, begun) \
     VALUES ($1, $2, (SELECT now_ms FROM clock))";
const WRITTEN: &str = "DELETE FROM unfinished_blobs WHERE id = $1";
const LEFT: &str = "SELECT id, place FROM unfinished_blobs \
     WHERE begun <= (SELECT now_ms FROM clock) - $1";
const HOLD: &str = "SELECT 1 FROM blobs WHERE sha256 = $1 AND place = $2 FOR UPDATE";
const LOCK: &str = "SELECT place FROM blobs WHERE sha256 = $1 FOR UPDATE";
const DISCARD: &str = "DELETE FROM blobs WHERE sha256 = $1 \
     AND NOT EXISTS (SELECT 1 FROM meshes WHERE meshes.blob = $1) \
     AND NOT EXISTS (SELECT 1 FROM job_files WHERE job_files.blob = $1)";
const REFERRED: &str = "SELECT 1 FROM meshes WHERE meshes.blob = $1 \
     UNION ALL SELECT 1 FROM job_files WHERE job_files.blob = $1 LIMIT 1";
const REMEMBER: &str =
    "INSERT INTO discarded_blobs (place, discarded) VALUES ($1, (SELECT now_ms FROM clock))";
const FORGET: &str = "DELETE FROM discarded_blobs WHERE place = $1";

/// Attempts to store before the client gets `Retry-After`.
const TRIES: usize = 5;

impl Store {
    /// Stores bytes, and begins the transaction that may refer to them.
    pub(super) async fn begin_with(
        &self,
        mut contents: Vec<Content>,
    ) -> Result<Transaction, StoreError> {
        self.reserve_room()?;
        contents.sort_by(|one, other| one.0.cmp(&other.0));
        contents.dedup_by(|one, other| one.0 == other.0);
        for _ in 0..TRIES {
            let stored = self.put(&contents).await?;
            let mut transaction = self.database.begin().await?;
            if hold(&mut transaction, &stored).await? {
                return Ok(transaction);
            }
            transaction.rollback().await;
            self.remove_orphans(&stored).await?;
        }
        Err(StoreError::Contended)
    }

    /// Removes what was stored in places that were discarded meanwhile: a place without a row gets none again.
    async fn remove_orphans(&self, stored: &[Stored]) -> Result<(), StoreError> {
        for Stored { id, place, .. } in stored {
            self.finish(id, place).await?;
        }
        Ok(())
    }

    async fn finish(&self, id: &str, place: &str) -> Result<(), StoreError> {
        let row = query("SELECT 1 FROM blobs WHERE place = $1")
            .bind(place)
            .fetch_optional(self.database.reader())
            .await?;
        if row.is_none() {
            self.blobs.delete(place).await?;
        }
        query(WRITTEN).bind(id).execute(&self.database.writer().await?).await?;
        Ok(())
    }

    /// The same for writes that began longer ago than `patience`, in ms, and were abandoned.
    pub(super) async fn finish_old(&self, patience: i64) -> Result<(), StoreError> {
        for row in query(LEFT).bind(patience).fetch_all(self.database.reader()).await? {
            let (id, place): (String, String) = (row.try_get(0)?, row.try_get(1)?);
            self.finish(&id, &place).await?;
        }
        Ok(())
    }

    /// Announces bytes and stores them. Rows are locked in the order of their hashes, so that of two that
    /// store the same one waits for the other, and not both.
    pub(super) async fn put(&self, contents: &[Content]) -> Result<Vec<Stored>, StoreError> {
        let mut stored = Vec::with_capacity(contents.len());
        let mut transaction = self.database.begin().await?;
        for (sha256, _) in contents {
            let row = query(ANNOUNCE)
                .bind(sha256)
                .bind(new_place(sha256))
                .fetch_one(&mut transaction)
                .await?;
            let (id, place) = (uuid::Uuid::now_v7().to_string(), row.try_get::<String, _>(0)?);
            query(WRITE).bind(&id).bind(&place).execute(&mut transaction).await?;
            stored.push(Stored { id, sha256: sha256.clone(), place });
        }
        transaction.commit().await?;
        for (stored, (_, bytes)) in stored.iter().zip(contents) {
            if let Err(error) = self.blobs.put(&stored.place, bytes.clone()).await {
                // A store that hangs would hang once more: what it has is left to the sweep.
                if !matches!(error, StoreError::NoAnswer { .. }) {
                    self.discard(hashes(contents)).await;
                }
                return Err(error);
            }
        }
        Ok(stored)
    }

    /// Removes those of the given bytes that nothing refers to. What cannot be removed is left to the sweep.
    pub(super) async fn discard(&self, blobs: Vec<String>) {
        for sha256 in blobs {
            if let Err(error) = self.discard_one(&sha256).await {
                tracing::warn!(%sha256, %error, "bytes without a reference are left to the sweep");
                if let StoreError::NoAnswer { .. } = error {
                    return;
                }
            }
        }
    }

    /// True when the bytes were there and are gone.
    pub(super) async fn discard_one(&self, sha256: &str) -> Result<bool, StoreError> {
        let mut transaction = self.database.begin().await?;
        let row = query(LOCK).bind(sha256).fetch_optional(&mut transaction).await?;
        let Some(row) = row else { return Ok(false) };
        let place: String = row.try_get(0)?;
        if query(DISCARD).bind(sha256).execute(&mut transaction).await? == 0 {
            return Ok(false);
        }
        query(REMEMBER).bind(&place).execute(&mut transaction).await?;
        transaction.commit().await?;
        self.remove_bytes(&place).await?;
        Ok(true)
    }

    /// Removes the bytes of a discarded place. Done twice, by two processes, it is done as well.
    pub(super) async fn remove_bytes(&self, place: &str) -> Result<(), StoreError> {
        self.blobs.delete(place).await?;
        query(FORGET).bind(place).execute(&self.database.writer().await?).await?;
        Ok(())
    }

    /// The bytes of a hash, compared with it.
    pub async fn read_blob(&self, sha256: &str) -> Result<Bytes, StoreError> {
        let read = async { self.blobs.get(&self.place_of(sha256).await?, sha256).await };
        self.erased_or(read.await).await
    }

    /// The blob of a hash, before any of it is read.
    pub async fn find_blob(&self, sha256: &str) -> Result<FoundBlob, StoreError> {
        let found = async { self.blobs.find(&self.place_of(sha256).await?, sha256).await };
        self.erased_or(found.await).await
    }

    /// Bytes that are missing are no damage where what referred to them was erased after it was looked up.
    async fn erased_or<T>(&self, read: Result<T, StoreError>) -> Result<T, StoreError> {
        let Err(StoreError::Missing { sha256 }) = read else { return read };
        let row = query(REFERRED).bind(&sha256).fetch_optional(self.database.reader()).await?;
        Err(match row {
            Some(_) => StoreError::Missing { sha256 },
            None => StoreError::Erased,
        })
    }

    /// It as a file, compared with its hash, which can be read to its end also where the blob is erased meanwhile.
    pub async fn file_of(&self, found: FoundBlob) -> Result<File, StoreError> {
        found.into_file(&self.blobs.operations, || self.nameless_file()).await
    }

    /// An unnamed file of this process, removed when it is closed.
    pub fn nameless_file(&self) -> Result<File, StoreError> {
        tempfile::tempfile_in(self.folder.join("tmp")).map_err(|error| match error.kind() {
            std::io::ErrorKind::NotFound => StoreError::NoFolder { folder: self.folder.clone() },
            _ => error.into(),
        })
    }

    /// Where the bytes of a hash are.
    pub(super) async fn place_of(&self, sha256: &str) -> Result<String, StoreError> {
        let row = query("SELECT place FROM blobs WHERE sha256 = $1")
            .bind(sha256)
            .fetch_optional(self.database.reader())
            .await?;
        let missing = || StoreError::Missing { sha256: sha256.to_owned() };
        Ok(row.ok_or_else(missing)?.try_get(0)?)
    }
}

/// Locks the rows of stored bytes until the end of the transaction; false when one of them is not theirs any more.
pub(super) async fn hold(
    transaction: &mut Transaction,
    stored: &[Stored],
) -> Result<bool, StoreError> {
    for Stored { id, sha256, place } in stored {
        let held = query(HOLD).bind(sha256).bind(place).fetch_optional(&mut *transaction).await?;
        if held.is_none() {
            return Ok(false);
        }
        query(WRITTEN).bind(id).execute(&mut *transaction).await?;
    }
    Ok(true)
}

/// The hashes of bytes, to be discarded.
pub(super) fn hashes(contents: &[Content]) -> Vec<String> {
    contents.iter().map(|(sha256, _)| sha256.clone()).collect()
}

/// A place that was never used. Two letters of the hash as a folder keep folders small.
pub(super) fn new_place(sha256: &str) -> String {
    let folder = sha256.get(..2).unwrap_or("00");
    format!("{folder}/{sha256}-{}", uuid::Uuid::now_v7().simple())
}
