//! Streaming of blobs as files of any size: compared with their hash before the first piece is handed out.

use std::fs::File;
use std::io::{Read as _, Seek as _, Write as _};

use futures::StreamExt as _;
use object_store::{GetResult, GetResultPayload};
use sha2::{Digest, Sha256};

use super::blob_operations::{Operations, WITHIN, in_time, limit_of};
use super::error::StoreError;
use crate::schema::wire::canonical::hex;

/// Bytes of a file in memory at a time.
const PIECE: usize = 256 << 10;

/// A blob that is there and was not read yet.
pub struct FoundBlob {
    pub(super) sha256: String,
    pub(super) found: GetResult,
}

impl FoundBlob {
    pub fn bytes(&self) -> u64 {
        self.found.meta.size
    }

    /// Whether it comes from another machine, and is copied to the data folder to be read.
    pub fn is_far(&self) -> bool {
        match self.found.payload {
            GetResultPayload::File(..) => false,
            GetResultPayload::Stream(_) => true,
        }
    }

    /// The file, at its beginning, compared with the hash; a copy where it comes from another machine.
    pub(super) async fn into_file(
        self,
        operations: &Operations,
        nameless: impl FnOnce() -> Result<File, StoreError>,
    ) -> Result<File, StoreError> {
        let limit = limit_of(self.bytes());
        let (mut file, found) = match self.found.payload {
            GetResultPayload::File(file, _) => {
                operations.within(limit, blocking(move || hashed(file))).await?
            }
            GetResultPayload::Stream(_) => copied(self.found, nameless()?).await?,
        };
        if found != self.sha256 {
            return Err(StoreError::Integrity { sha256: self.sha256, found });
        }
        file.rewind()?;
        Ok(file)
    }
}

/// A file with the hash of what it holds.
fn hashed(mut file: File) -> Result<(File, String), StoreError> {
    let (mut hasher, mut piece) = (Sha256::new(), vec![0; PIECE]);
    loop {
        let count = file.read(&mut piece)?;
        if count == 0 {
            return Ok((file, hex(&hasher.finalize())));
        }
        hasher.update(&piece[..count]);
    }
}

/// What comes from elsewhere, in a file, with its hash.
async fn copied(found: GetResult, mut file: File) -> Result<(File, String), StoreError> {
    let (mut pieces, mut hasher) = (found.into_stream(), Sha256::new());
    while let Some(piece) = in_time(WITHIN, async { Ok(pieces.next().await) }).await? {
        let piece = piece?;
        (file, hasher) = blocking(move || {
            file.write_all(&piece)?;
            hasher.update(&piece);
            Ok((file, hasher))
        })
        .await?;
    }
    Ok((file, hex(&hasher.finalize())))
}

async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, StoreError> + Send + 'static,
) -> Result<T, StoreError> {
    tokio::task::spawn_blocking(work).await.map_err(|_| StoreError::Interrupted)?
}
