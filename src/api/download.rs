//! Streaming of files in pieces, so that a slow client costs no memory of the file's size.

use std::fs::File;
use std::io::{Seek as _, SeekFrom, Write as _};
use std::sync::Arc;

use axum::body::Body;
use futures::StreamExt as _;
use tokio::io::AsyncReadExt as _;
use tokio_util::io::ReaderStream;

use super::Service;
use super::budget::ByteReservation;
use super::error::{ApiError, ApiResult};
use super::permits::Permit;
use crate::schema::wire::problem::Problem;
use crate::store::StoreError;

/// Bytes of a file in memory at a time.
const PIECE: usize = 64 << 10;

/// A file that can be sent, whole or in part.
pub struct ServedFile {
    file: File,
    pub bytes: u64,
    /// Reserves the bytes of a copy.
    held: Arc<ByteReservation>,
}

impl ServedFile {
    /// The file of a blob, compared with its hash.
    pub async fn blob(service: &Service, sha256: &str) -> ApiResult<ServedFile> {
        let found = service.store.find_blob(sha256).await?;
        let (bytes, held) = (found.bytes(), Arc::new(service.hold()));
        if found.is_far() {
            held.at_least(bytes)?;
            service.ground().require(bytes)?;
        }
        Ok(ServedFile { file: service.store.file_of(found).await?, bytes, held })
    }

    /// A file of the bytes that `make` produces under a permit.
    pub async fn made(
        service: &Service,
        permit: &Permit,
        make: impl FnOnce() -> Result<Vec<u8>, Problem> + Send + 'static,
    ) -> ApiResult<ServedFile> {
        let (held, ground) = (Arc::new(service.hold()), service.ground());
        let work = move || -> ApiResult<ServedFile> {
            let content = make()?;
            let bytes = content.len() as u64;
            held.at_least(bytes)?;
            ground.require(bytes)?;
            let mut file = ground.store.nameless_file()?;
            file.write_all(&content).map_err(StoreError::from)?;
            Ok(ServedFile { file, bytes, held })
        };
        permit.compute(work).await?
    }

    /// `count` bytes from `first`.
    pub fn into_body(mut self, first: u64, count: u64) -> ApiResult<Body> {
        self.file.seek(SeekFrom::Start(first)).map_err(ApiError::internal)?;
        let part = tokio::fs::File::from_std(self.file).take(count);
        let pieces = ReaderStream::with_capacity(part, PIECE);
        let held = self.held;
        // The copy counts until its last piece is sent, or its client has gone.
        Ok(Body::from_stream(pieces.inspect(move |_| drop(held.clone()))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::ErrorCode;
    use crate::store::NewMesh;

    #[tokio::test]
    async fn what_was_erased_after_it_was_found_is_not_found_and_what_is_lost_is_damage() {
        let folder = tempfile::tempdir().unwrap();
        let service = Service::example(folder.path(), &[]).await;
        let store = service.store.clone();
        let [erased, lost] = ["e", "f"].map(|digit| digit.repeat(64));
        for hash in [&erased, &lost] {
            let mesh = NewMesh::example(hash);
            assert!(store.add_mesh(&mesh).await.unwrap());
            if hash == &erased {
                store.delete_mesh(&mesh.id).await.unwrap();
            }
        }
        std::fs::remove_dir_all(folder.path().join("blobs").join(&lost[..2])).unwrap();
        let told = async |hash: &str| match ServedFile::blob(&service, hash).await {
            Ok(_) => panic!("{hash} is served"),
            Err(error) => error.problem.code,
        };
        assert_eq!(told(&erased).await, ErrorCode::NotFound);
        assert_eq!(told(&lost).await, ErrorCode::Integrity);
    }
}
