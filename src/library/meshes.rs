//! The meshes of the service, parsed: kept in memory while there is room, so that a request does not parse
//! again what another has parsed.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use serde::{Deserialize, Serialize};
use tokio::runtime::Handle;

use super::cache::MeshCache;
use crate::jobs::{MeshSource, SourceError, StoredMesh, StoredShape};
use crate::schema::WarningDocument;
use crate::schema::case::document::{FrameName, LengthUnit};
use crate::schema::learn::model::MODEL_FILE;
use crate::schema::mesh::MeshDocument;
use crate::store::{MeshRow, Store, StoreError};
use mechanics::format::{self, FormatError, ReadLimits, ReadMesh};
use mechanics::mesh::Frame;
use mechanics::mesh::duplicate_cells::DUPLICATE_CELLS;

/// The result file that holds the predicted skin with its node numbers.
const PREDICTED_SKIN: &str = "skin.vtp";

/// Description of a stored mesh beside its bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeshCard {
    /// The hash of the stored bytes.
    pub blob: String,
    /// The hash of the bytes that were sent.
    pub sha256: String,
    pub identity: String,
    pub frame: Option<FrameName>,
    pub units: Option<LengthUnit>,
    /// What the meshing that made it had to say, and that cells stand twice, which no prediction looks for.
    #[serde(default)]
    pub told: Vec<WarningDocument>,
}

impl MeshCard {
    fn of(row: MeshRow) -> Result<MeshCard, StoreError> {
        let document = document_of(&row)?;
        let doubled = document.report.warnings.iter().filter(|own| own.code == DUPLICATE_CELLS);
        let told = document.report.meshing.iter().chain(doubled).cloned().collect();
        Ok(MeshCard {
            identity: document.identity(),
            blob: row.blob,
            sha256: row.sha256,
            frame: document.report.space.or(document.frame),
            units: document.units,
            told,
        })
    }

    /// The mesh, in the unit of its file.
    pub fn with(self, shape: StoredShape) -> StoredMesh {
        StoredMesh {
            shape,
            of_points: Arc::default(),
            frame: self.frame.map(Frame::from),
            units: self.units,
            warnings: Vec::new(),
            told: self.told,
            sha256: self.sha256,
            identity: self.identity,
        }
    }
}

/// The document of a stored mesh.
pub fn document_of(row: &MeshRow) -> Result<MeshDocument, StoreError> {
    serde_json::from_str(&row.report).map_err(|error| {
        StoreError::Schema(format!("the report of mesh {} cannot be read: {error}", row.id))
    })
}

/// Parses bytes that our own writers made: they may compress better than a stranger's file is allowed to.
pub fn parse_stored(bytes: &[u8]) -> Result<ReadMesh, FormatError> {
    format::read(bytes, &ReadLimits { decoded_ratio: f64::INFINITY, ..ReadLimits::default() })
}

/// Stored meshes by id, parsed.
#[derive(Clone)]
pub struct Library {
    store: Store,
    cache: Arc<Mutex<MeshCache>>,
}

impl Library {
    /// A library that keeps parsed meshes of at most `room` bytes.
    pub fn new(store: Store, room: usize) -> Self {
        Library { store, cache: Arc::new(Mutex::new(MeshCache::new(room))) }
    }

    /// The same library scoped to a tenant.
    pub fn of_tenant(&self, tenant: &str) -> Self {
        Library { store: self.store.of_tenant(tenant), cache: self.cache.clone() }
    }

    fn cache(&self) -> MutexGuard<'_, MeshCache> {
        self.cache.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Keeps a mesh that was parsed on its way in.
    pub fn keep(&self, blob: &str, mesh: StoredShape) {
        self.cache().insert(blob, mesh);
    }

    /// Drops a deleted mesh from the cache.
    pub fn forget(&self, blob: &str) {
        self.cache().forget(blob);
    }

    pub async fn get(&self, id: &str) -> Result<Option<StoredMesh>, StoreError> {
        match self.store.mesh(id).await? {
            Some(row) => self.open(row).await.map(Some),
            None => Ok(None),
        }
    }

    /// The mesh of a row, in the unit of its file; parsed on a thread that may block.
    pub async fn open(&self, row: MeshRow) -> Result<StoredMesh, StoreError> {
        let card = MeshCard::of(row)?;
        let cached = self.cache().get(&card.blob);
        let shape = match cached {
            Some(shape) => shape,
            None => {
                let shape = self.read(&card.blob, card.sha256.clone()).await?.shape;
                self.keep(&card.blob, shape.clone());
                shape
            }
        };
        Ok(card.with(shape))
    }

    /// What is known of a mesh, without its bytes.
    pub async fn card(&self, id: &str) -> Result<Option<MeshCard>, StoreError> {
        self.store.mesh(id).await?.map(MeshCard::of).transpose()
    }

    /// The blob of the skin that a successful prediction wrote; `None` where the job has none.
    pub async fn skin_blob(&self, job: &str) -> Result<Option<String>, StoreError> {
        Ok(self.store.job_file(job, PREDICTED_SKIN).await?.map(|file| file.blob))
    }

    /// The blob of what a job learned; `None` where the job has none.
    pub async fn model_blob(&self, job: &str) -> Result<Option<String>, StoreError> {
        Ok(self.store.job_file(job, MODEL_FILE).await?.map(|file| file.blob))
    }

    async fn model(&self, job: &str) -> Result<Option<Vec<u8>>, StoreError> {
        let Some(blob) = self.model_blob(job).await? else { return Ok(None) };
        Ok(Some(self.bytes(&blob).await?.to_vec()))
    }

    /// The bytes of a blob, compared with their hash.
    pub async fn bytes(&self, blob: &str) -> Result<bytes::Bytes, StoreError> {
        self.store.read_blob(blob).await
    }

    async fn read(&self, blob: &str, sha256: String) -> Result<StoredMesh, StoreError> {
        let bytes = self.bytes(blob).await?;
        let parsed = tokio::task::spawn_blocking(move || parse_stored(&bytes)).await;
        let parsed = parsed.map_err(|_| StoreError::Interrupted)?;
        let parsed = parsed.map_err(|error| StoreError::Schema(format!("stored mesh: {error}")))?;
        Ok(StoredMesh::new(parsed, Some(LengthUnit::Mm), sha256))
    }

    async fn predicted_skin(&self, job: &str) -> Result<Option<StoredMesh>, StoreError> {
        let Some(blob) = self.skin_blob(job).await? else { return Ok(None) };
        self.read(&blob, blob.clone()).await.map(Some)
    }

    /// The same meshes for work that is not async. Only to be asked on threads that may block.
    pub fn source(&self, runtime: Handle, extra: BTreeMap<String, StoredMesh>) -> LibrarySource {
        LibrarySource { library: self.clone(), runtime, extra }
    }
}

/// Stored meshes, and those of a request that are not stored yet.
pub struct LibrarySource {
    library: Library,
    runtime: Handle,
    extra: BTreeMap<String, StoredMesh>,
}

impl MeshSource for LibrarySource {
    fn mesh(&self, id: &str) -> Result<StoredMesh, SourceError> {
        if let Some(mesh) = self.extra.get(id) {
            return Ok(mesh.clone());
        }
        found(id, self.runtime.block_on(self.library.get(id)))
    }

    fn model(&self, job: &str) -> Result<Vec<u8>, SourceError> {
        found(job, self.runtime.block_on(self.library.model(job)))
    }

    fn predicted_skin(&self, job: &str) -> Result<StoredMesh, SourceError> {
        found(job, self.runtime.block_on(self.library.predicted_skin(job)))
    }
}

fn found<T>(id: &str, mesh: Result<Option<T>, StoreError>) -> Result<T, SourceError> {
    match mesh {
        Ok(Some(mesh)) => Ok(mesh),
        Ok(None) | Err(StoreError::Erased) => Err(SourceError::Unknown { id: id.to_owned() }),
        Err(error) => {
            tracing::warn!(input = %id, %error, "a stored mesh or result could not be read");
            Err(SourceError::Unreadable {
                id: id.to_owned(),
                detail: why_unreadable(&error).to_owned(),
                may_pass: error.is_unavailable(),
            })
        }
    }
}

/// Why a stored mesh or result could not be read, as clients are told it.
pub fn why_unreadable(error: &StoreError) -> &'static str {
    match error {
        StoreError::Missing { .. } => "its stored bytes are missing",
        StoreError::Integrity { .. } => "its stored bytes are damaged: they differ from their hash",
        error if error.is_unavailable() => "the database or the store of blobs does not answer",
        _ => "the log has the reason",
    }
}
