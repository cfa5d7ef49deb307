//! Bytes by their place: stored meshes and result files, in a folder or in an S3-compatible store.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use bytes::Bytes;
use futures::{StreamExt, TryStreamExt};
use object_store::aws::AmazonS3Builder;
use object_store::local::LocalFileSystem;
use object_store::prefix::PrefixStore;
use object_store::{ClientOptions, ObjectStore, ObjectStoreExt, PutPayload, RetryConfig};

use super::StoreError;
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

/// The place that says whose blobs these are.
const OWNER: &str = "facies-owner";

/// Blobs, each complete or absent: the folder writes beside the place, flushes and renames; S3 shows an object
/// when all of it is there.
#[derive(Clone)]
pub struct Blobs {
    objects: Arc<dyn ObjectStore>,
    in_data: bool,
}

impl Blobs {
    pub fn open(places: &StorageLocations) -> Result<Blobs, StoreError> {
        match &places.blobs {
            BlobLocation::InData => {
                let blobs = Blobs::in_folder(&places.data.join("blobs"))?;
                Ok(Blobs { in_data: true, ..blobs })
            }
            BlobLocation::Folder(folder) => Blobs::in_folder(folder),
            BlobLocation::Bucket { bucket, prefix, settings } => {
                Blobs::in_bucket(bucket, prefix, settings)
            }
        }
    }

    fn in_folder(folder: &Path) -> Result<Blobs, StoreError> {
        std::fs::create_dir_all(folder).map_err(at(folder))?;
        let objects = LocalFileSystem::new_with_prefix(folder)?.with_fsync(true);
        Ok(Blobs { objects: Arc::new(objects), in_data: false })
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
        Ok(Blobs { objects, in_data: false })
    }

    /// Stores bytes durably, at a place that never holds other bytes.
    pub async fn put(&self, place: &str, bytes: Bytes) -> Result<(), StoreError> {
        match self.objects.put(&place.into(), PutPayload::from(bytes)).await {
            Ok(_) => Ok(()),
            Err(error) if tells_of_no_bucket(&error) => Err(StoreError::NoBucket),
            Err(error) => Err(error.into()),
        }
    }

    /// A blob that is there.
    pub(super) async fn find(&self, place: &str, sha256: &str) -> Result<FoundBlob, StoreError> {
        let sha256 = sha256.to_owned();
        match self.objects.get(&place.into()).await {
            Ok(found) => Ok(FoundBlob { sha256, found }),
            Err(object_store::Error::NotFound { .. }) => Err(StoreError::Missing { sha256 }),
            Err(error) => Err(error.into()),
        }
    }

    /// The bytes, compared with their hash: a blob that changed where it is kept is an error, never an answer.
    pub async fn get(&self, place: &str, sha256: &str) -> Result<Bytes, StoreError> {
        let bytes = self.find(place, sha256).await?.found.bytes().await?;
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
        match self.objects.delete(&place.into()).await {
            Ok(()) | Err(object_store::Error::NotFound { .. }) => Ok(()),
            Err(error) => Err(error.into()),
        }
    }

    /// Whether a place holds bytes.
    pub async fn exists(&self, place: &str) -> Result<bool, StoreError> {
        match self.objects.head(&place.into()).await {
            Ok(_) => Ok(true),
            Err(object_store::Error::NotFound { .. }) => Ok(false),
            Err(error) => Err(error.into()),
        }
    }

    /// All places that hold bytes, without the mark and without folders that bear a mark of their own.
    pub async fn list(&self) -> Result<Vec<String>, StoreError> {
        let found = self.objects.list(None).try_collect::<Vec<_>>().await?;
        let places = found.iter().map(|object| object.location.to_string());
        Ok(own_places(places.collect()))
    }

    /// Whether they are in the data folder, which has one owner.
    pub fn are_in_data(&self) -> bool {
        self.in_data
    }

    /// The identity of the database whose blobs these are, if it is written there.
    pub async fn owner(&self) -> Result<Option<String>, StoreError> {
        match self.objects.get(&OWNER.into()).await {
            Ok(found) => {
                let bytes = found.bytes().await?;
                Ok(Some(String::from_utf8_lossy(&bytes).trim().to_owned()))
            }
            Err(object_store::Error::NotFound { .. }) => Ok(None),
            Err(error) => Err(error.into()),
        }
    }

    pub async fn set_owner(&self, identity: &str) -> Result<(), StoreError> {
        self.put(OWNER, format!("{identity}\n").into()).await
    }

    /// Whether nothing is there but the mark. A folder that cannot be read, as `lost+found` of a disk, is none of ours.
    pub async fn is_empty(&self) -> bool {
        let mut found = self.objects.list(None);
        while let Some(object) = found.next().await {
            if object.is_ok_and(|object| object.location != OWNER.into()) {
                return false;
            }
        }
        true
    }

    /// Whether the store answers, and its bucket exists, which a list tells: an object that is not there has the same status as a
    /// bucket that is not.
    pub async fn ping(&self) -> Result<(), StoreError> {
        let nothing = self.objects.list(Some(&"ready".into())).try_next().await;
        match nothing {
            Ok(_) => Ok(()),
            Err(error) if tells_of_no_bucket(&error) => Err(StoreError::NoBucket),
            Err(error) => Err(error.into()),
        }
    }
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
mod tests {
    use super::*;

    #[test]
    fn places_of_a_store_within_another_are_none_of_its_own() {
        let places =
            ["ab/1", "facies-owner", "b/facies-owner", "b/cd/2", "bc/3", "not-facies-owner"];
        let own = own_places(places.map(str::to_owned).into());
        assert_eq!(own, ["ab/1", "bc/3", "not-facies-owner"]);
    }
}
