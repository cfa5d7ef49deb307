//! Bytes by their place: stored meshes and result files, in a folder or in an S3-compatible store.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use bytes::Bytes;
use futures::StreamExt;
use object_store::aws::AmazonS3Builder;
use object_store::local::LocalFileSystem;
use object_store::path::Path as Place;
use object_store::prefix::PrefixStore;
use object_store::{ClientOptions, ObjectStore, ObjectStoreExt, PutPayload, RetryConfig};

use super::StoreError;
use super::blob_folder::{BlobFolder, OWNER};
use super::blob_operations::{Operations, WITHIN, in_time, limit_of};
use super::error::at;
use super::files::FoundBlob;
use crate::config::{BlobLocation, Secret, StorageLocations};
use crate::schema::wire::canonical::sha256_hex;

/// How long a store may take to accept a connection, and one request for a whole blob.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(3);
const REQUEST_TIMEOUT: Duration = Duration::from_secs(300);
/// How long a request is repeated before the client is told to come back.
const RETRY_TIMEOUT: Duration = Duration::from_secs(10);
const RETRIES: usize = 3;

/// Blobs, each complete or absent: the folder writes beside the place, flushes and renames; S3 shows an object
/// when all of it is there.
#[derive(Clone)]
pub struct Blobs {
    objects: Arc<dyn ObjectStore>,
    /// Where they are, unless in a bucket.
    folder: Option<BlobFolder>,
    pub(super) operations: Operations,
}

impl Blobs {
    pub fn open(places: &StorageLocations) -> Result<Blobs, StoreError> {
        match &places.blobs {
            BlobLocation::InData => Blobs::in_folder(&places.data.join("blobs"), true),
            BlobLocation::Folder(folder) => Blobs::in_folder(folder, false),
            BlobLocation::Bucket { bucket, prefix, settings } => {
                Blobs::in_bucket(bucket, prefix, settings)
            }
        }
    }

    fn in_folder(folder: &Path, in_data: bool) -> Result<Blobs, StoreError> {
        std::fs::create_dir_all(folder).map_err(at(folder))?;
        let objects = LocalFileSystem::new_with_prefix(folder)?.with_fsync(true);
        let folder = BlobFolder::new(std::path::absolute(folder)?, in_data);
        Ok(Blobs::new(Arc::new(objects), Some(folder)))
    }

    fn new(objects: Arc<dyn ObjectStore>, folder: Option<BlobFolder>) -> Blobs {
        let operations = Operations::new(folder.is_some());
        Blobs { objects, folder, operations }
    }

    fn in_bucket(
        bucket: &str,
        prefix: &str,
        settings: &[(String, Secret)],
    ) -> Result<Blobs, StoreError> {
        // Whichever part of the program asks first for an encrypted connection decides by what.
        let _ = rustls::crypto::ring::default_provider().install_default();
        let client = ClientOptions::new()
            .with_connect_timeout(CONNECT_TIMEOUT)
            .with_timeout(REQUEST_TIMEOUT);
        let retry = RetryConfig {
            max_retries: RETRIES,
            retry_timeout: RETRY_TIMEOUT,
            ..RetryConfig::default()
        };
        let mut builder = AmazonS3Builder::new().with_client_options(client).with_retry(retry);
        for (name, value) in settings {
            // Those of other programs are not known.
            if let Ok(key) = name.to_ascii_lowercase().parse() {
                builder = builder.with_config(key, value.reveal());
            }
        }
        let objects = builder.with_bucket_name(bucket).build()?;
        let objects: Arc<dyn ObjectStore> = match prefix {
            "" => Arc::new(objects),
            prefix => Arc::new(PrefixStore::new(objects, prefix)),
        };
        Ok(Blobs::new(objects, None))
    }

    /// Stores bytes durably, at a place that never holds other bytes.
    pub async fn put(&self, place: &str, bytes: Bytes) -> Result<(), StoreError> {
        let limit = limit_of(bytes.len() as u64);
        let (blobs, place) = (self.clone(), Place::from(place));
        let put = async move {
            blobs.require_folder().await?;
            blobs.objects.put(&place, PutPayload::from(bytes)).await.map_err(named)?;
            // Below its mount point, where the folder went meanwhile.
            blobs.require_folder().await
        };
        self.operations.within(limit, put).await
    }

    /// A blob that is there.
    pub(super) async fn find(&self, place: &str, sha256: &str) -> Result<FoundBlob, StoreError> {
        let (blobs, place, sha256) = (self.clone(), Place::from(place), sha256.to_owned());
        let find = async move {
            match blobs.objects.get(&place).await {
                Ok(found) => Ok(FoundBlob { sha256, found }),
                Err(object_store::Error::NotFound { .. }) => {
                    blobs.require_folder().await?;
                    Err(StoreError::Missing { sha256 })
                }
                Err(error) => Err(error.into()),
            }
        };
        self.operations.within(WITHIN, find).await
    }

    /// The bytes, compared with their hash: a blob that changed where it is kept is an error, never an answer.
    pub async fn get(&self, place: &str, sha256: &str) -> Result<Bytes, StoreError> {
        let found = self.find(place, sha256).await?;
        let bytes = self.operations.within(limit_of(found.bytes()), found.found.bytes()).await?;
        let (bytes, found) = tokio::task::spawn_blocking(move || {
            let found = sha256_hex(&bytes);
            (bytes, found)
        })
        .await
        .map_err(|_| StoreError::Interrupted)?;
        if found != sha256 {
            return Err(StoreError::Integrity { sha256: sha256.to_owned(), found });
        }
        Ok(bytes)
    }

    pub async fn delete(&self, place: &str) -> Result<(), StoreError> {
        let (blobs, place) = (self.clone(), Place::from(place));
        let delete = async move {
            match blobs.objects.delete(&place).await {
                Ok(()) => Ok(()),
                Err(object_store::Error::NotFound { .. }) => blobs.require_folder().await,
                Err(error) => Err(error.into()),
            }
        };
        self.operations.within(WITHIN, delete).await
    }

    /// Whether a place holds bytes.
    pub async fn exists(&self, place: &str) -> Result<bool, StoreError> {
        let (blobs, place) = (self.clone(), Place::from(place));
        let exists = async move {
            match blobs.objects.head(&place).await {
                Ok(_) => Ok(true),
                // Whose folder it is may be asked by what is there.
                Err(object_store::Error::NotFound { .. }) if !blobs.had_owner() => Ok(false),
                Err(object_store::Error::NotFound { .. }) => {
                    blobs.require_folder().await.map(|()| false)
                }
                Err(error) => Err(StoreError::from(error)),
            }
        };
        self.operations.within(WITHIN, exists).await
    }

    /// All places that hold bytes, without the mark and without folders that bear a mark of their own.
    pub async fn list(&self) -> Result<Vec<String>, StoreError> {
        self.require_folder().await?;
        let (mut places, mut found) = (Vec::new(), self.objects.list(None));
        while let Some(object) = in_time(WITHIN, async { Ok(found.next().await) }).await? {
            places.push(object?.location.to_string());
        }
        Ok(own_places(places))
    }

    /// Whether they are in the data folder, which has one owner.
    pub fn are_in_data(&self) -> bool {
        self.folder.as_ref().is_some_and(BlobFolder::is_in_data)
    }

    /// The identity of the database whose blobs these are, if it is written there.
    pub async fn owner(&self) -> Result<Option<String>, StoreError> {
        let objects = self.objects.clone();
        let read = async move {
            match objects.get(&OWNER.into()).await {
                Ok(found) => Ok(Some(found.bytes().await?)),
                Err(object_store::Error::NotFound { .. }) => Ok(None),
                Err(error) => Err(error),
            }
        };
        let owner = self.operations.within(WITHIN, read).await?;
        Ok(owner.map(|owner| String::from_utf8_lossy(&owner).trim().to_owned()))
    }

    /// Writes the mark, in a place that was just found to be the right one.
    pub async fn set_owner(&self, identity: &str) -> Result<(), StoreError> {
        let (objects, mark) = (self.objects.clone(), PutPayload::from(format!("{identity}\n")));
        let put = async move { objects.put(&OWNER.into(), mark).await.map_err(named) };
        self.operations.within(WITHIN, put).await.map(drop)
    }

    /// The mark was found: a folder without it is out of reach from now on.
    pub fn know_owner(&self, identity: &str) {
        if let Some(folder) = &self.folder {
            folder.know_owner(identity);
        }
    }

    /// Whether a folder had its mark since the start.
    pub fn had_owner(&self) -> bool {
        self.folder.as_ref().is_some_and(BlobFolder::is_known)
    }

    /// Whether nothing is there but the mark. A folder that cannot be read, as `lost+found` of a disk, is none of ours.
    pub async fn is_empty(&self) -> Result<bool, StoreError> {
        let mut found = self.objects.list(None);
        while let Some(object) = in_time(WITHIN, async { Ok(found.next().await) }).await? {
            if object.is_ok_and(|object| object.location != OWNER.into()) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether the folder takes a file; whether the store answers, and its bucket exists, which a list tells: an object that is not
    /// there has the same status as a bucket that is not.
    pub async fn ping(&self) -> Result<(), StoreError> {
        if let Some(folder) = &self.folder {
            return in_time(WITHIN, folder.try_write()).await;
        }
        let mut listed = self.objects.list(Some(&"ready".into()));
        let ready = async move { listed.next().await.transpose().map_err(named) };
        self.operations.within(WITHIN, ready).await.map(drop)
    }

    async fn require_folder(&self) -> Result<(), StoreError> {
        match &self.folder {
            Some(folder) => folder.require().await,
            None => Ok(()),
        }
    }
}

/// An error with a name for that of a bucket which does not exist.
fn named(error: object_store::Error) -> StoreError {
    if tells_of_no_bucket(&error) { StoreError::NoBucket } else { error.into() }
}

/// Places without the mark and what another one owns.
fn own_places(places: Vec<String>) -> Vec<String> {
    let marked = places.iter().filter_map(|place| place.strip_suffix(OWNER));
    let of_others: Vec<String> =
        marked.filter(|folder| folder.ends_with('/')).map(str::to_owned).collect();
    let is_own = |place: &String| {
        place != OWNER && !of_others.iter().any(|folder| place.starts_with(folder.as_str()))
    };
    places.into_iter().filter(is_own).collect()
}

/// Whether an error is that of a bucket that does not exist, which has the same status as that of an object.
fn tells_of_no_bucket(error: &object_store::Error) -> bool {
    let mut cause: Option<&(dyn std::error::Error + 'static)> = Some(error);
    while let Some(error) = cause {
        if error.to_string().contains("NoSuchBucket") {
            return true;
        }
        cause = error.source();
    }
    false
}

#[cfg(test)]
#[path = "blobs_tests.rs"]
mod tests;
