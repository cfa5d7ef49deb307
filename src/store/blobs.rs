//! Bytes by their SHA-256: stored meshes and result files.

use std::path::Path;
use std::sync::Arc;

use bytes::Bytes;
use futures::TryStreamExt;
use object_store::local::LocalFileSystem;
use object_store::{ObjectStore, ObjectStoreExt, PutMode, PutOptions, PutPayload};

use super::StoreError;
use crate::schema::canonical::sha256_hex;

/// A folder of blobs. A blob is complete or absent: it is written beside its place, flushed, and linked.
#[derive(Clone)]
pub struct Blobs {
    objects: Arc<dyn ObjectStore>,
}

impl Blobs {
    pub fn open(folder: &Path) -> Result<Blobs, StoreError> {
        std::fs::create_dir_all(folder)?;
        let objects = LocalFileSystem::new_with_prefix(folder)?.with_fsync(true);
        Ok(Blobs { objects: Arc::new(objects) })
    }

    /// Stores bytes under their hash, durably; bytes that are there already stay as they are.
    pub async fn put(&self, sha256: &str, bytes: Bytes) -> Result<(), StoreError> {
        let options = PutOptions { mode: PutMode::Create, ..PutOptions::default() };
        let payload = PutPayload::from(bytes);
        match self.objects.put_opts(&place(sha256), payload, options).await {
            Ok(_) | Err(object_store::Error::AlreadyExists { .. }) => Ok(()),
            Err(error) => Err(error.into()),
        }
    }

    /// The bytes, compared with their hash: a blob that changed on disk is an error, never an answer.
    pub async fn get(&self, sha256: &str) -> Result<Bytes, StoreError> {
        let bytes = self.objects.get(&place(sha256)).await?.bytes().await?;
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

    pub async fn delete(&self, sha256: &str) -> Result<(), StoreError> {
        match self.objects.delete(&place(sha256)).await {
            Ok(()) | Err(object_store::Error::NotFound { .. }) => Ok(()),
            Err(error) => Err(error.into()),
        }
    }

    /// The hashes of all blobs.
    pub async fn list(&self) -> Result<Vec<String>, StoreError> {
        let found = self.objects.list(None).try_collect::<Vec<_>>().await?;
        Ok(found
            .iter()
            .filter_map(|object| object.location.filename().map(str::to_owned))
            .collect())
    }
}

/// Two letters of the hash as a folder keep folders small.
fn place(sha256: &str) -> object_store::path::Path {
    object_store::path::Path::from_iter([&sha256[..2], sha256])
}
