//! Spooled request bodies: small ones in memory, others in an unnamed file in the data folder, which is gone when it is
//! closed. Their hash is computed as they arrive.

use std::fs::File;
use std::io::{Read as _, Seek as _, Write as _};
use std::sync::Arc;

use bytes::{Bytes, BytesMut};
use sha2::{Digest, Sha256};

use super::budget::ByteReservation;
use super::error::{ApiError, ApiResult};
use crate::schema::wire::canonical::hex;
use crate::store::{Store, StoreError};

/// Bytes of one body in memory at a time; smaller bodies are never written to disk.
pub const IN_MEMORY: usize = 256 << 10;

/// Reserved free space.
#[derive(Clone)]
pub struct Ground {
    pub store: Store,
    pub floor_bytes: u64,
}

impl Ground {
    /// Refuses bytes that would leave less free space than the floor.
    pub fn require(&self, bytes: u64) -> ApiResult<()> {
        let (free, floor) = (self.store.free_space()?, self.floor_bytes);
        if free >= floor.saturating_add(bytes) {
            return Ok(());
        }
        tracing::error!(free, floor, bytes, "a body finds no room");
        Err(ApiError::storage_full())
    }
}

/// An incoming body.
pub struct Spool {
    ground: Ground,
    held: Arc<ByteReservation>,
    buffer: BytesMut,
    hasher: Sha256,
    file: Option<File>,
    bytes: u64,
}

/// A received body, which can be read again.
#[derive(Clone)]
pub struct SpooledBody {
    content: Content,
    pub bytes: u64,
    pub sha256: [u8; 32],
    _held: Arc<ByteReservation>,
}

#[derive(Clone)]
enum Content {
    Memory(Bytes),
    File(Arc<File>),
}

/// Bytes to write at once, on a thread that may block.
struct Batch {
    file: Option<File>,
    hasher: Sha256,
    bytes: Bytes,
}

impl Spool {
    pub fn new(ground: Ground, held: Arc<ByteReservation>) -> Spool {
        let (buffer, hasher) = (BytesMut::new(), Sha256::new());
        Spool { ground, held, buffer, hasher, file: None, bytes: 0 }
    }

    /// Appends the next bytes.
    pub async fn push(&mut self, frame: &[u8]) -> ApiResult<()> {
        self.bytes += frame.len() as u64;
        self.buffer.extend_from_slice(frame);
        if self.buffer.len() >= IN_MEMORY {
            self.write().await?;
        }
        Ok(())
    }

    async fn write(&mut self) -> ApiResult<()> {
        self.ground.require(self.buffer.len() as u64)?;
        let bytes = self.buffer.split().freeze();
        let (file, hasher) = (self.file.take(), std::mem::take(&mut self.hasher));
        let (batch, store) = (Batch { file, hasher, bytes }, self.ground.store.clone());
        let written = tokio::task::spawn_blocking(move || batch.write(&store)).await;
        let batch = written.map_err(ApiError::internal)??;
        (self.file, self.hasher) = (batch.file, batch.hasher);
        Ok(())
    }

    /// All of it.
    pub async fn finish(mut self) -> ApiResult<SpooledBody> {
        let content = if self.bytes <= IN_MEMORY as u64 && self.file.is_none() {
            let bytes = self.buffer.split().freeze();
            self.hasher.update(&bytes);
            Content::Memory(bytes)
        } else {
            self.write().await?;
            let file = self.file.take().ok_or_else(|| ApiError::internal("a lost file"))?;
            Content::File(Arc::new(file))
        };
        let sha256 = self.hasher.finalize().into();
        Ok(SpooledBody { content, bytes: self.bytes, sha256, _held: self.held })
    }
}

impl Batch {
    fn write(mut self, store: &Store) -> Result<Batch, StoreError> {
        let mut file = match self.file.take() {
            Some(file) => file,
            None => store.nameless_file()?,
        };
        file.write_all(&self.bytes)?;
        self.hasher.update(&self.bytes);
        Ok(Batch { file: Some(file), hasher: self.hasher, bytes: Bytes::new() })
    }
}

impl SpooledBody {
    /// All of its bytes. Reads a file: not for an async thread.
    pub fn read(&self) -> Result<Bytes, StoreError> {
        match &self.content {
            Content::Memory(bytes) => Ok(bytes.clone()),
            Content::File(file) => {
                let mut file = &**file;
                let mut bytes = Vec::with_capacity(usize::try_from(self.bytes).unwrap_or(0));
                file.rewind()?;
                file.read_to_end(&mut bytes)?;
                Ok(bytes.into())
            }
        }
    }

    /// The bytes of a body known to be small.
    pub async fn into_bytes(self) -> ApiResult<Bytes> {
        if let Content::Memory(bytes) = self.content {
            return Ok(bytes);
        }
        let read = tokio::task::spawn_blocking(move || self.read()).await;
        Ok(read.map_err(ApiError::internal)??)
    }

    pub fn sha256_hex(&self) -> String {
        hex(&self.sha256)
    }
}
