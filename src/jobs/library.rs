//! The meshes of the service, parsed: kept in memory while there is room, so that a job does not parse
//! again what its check has parsed.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::runtime::Handle;

use super::source::{MeshSource, SourceError, StoredMesh, StoredShape};
use crate::format::{self, ReadLimits};
use crate::mesh::Frame;
use crate::schema::case::LengthUnit;
use crate::schema::mesh::MeshDocument;
use crate::store::{MeshRow, Store, StoreError};

/// The result file that holds the predicted skin with its node numbers.
const PREDICTED_SKIN: &str = "skin.vtp";

/// About what a mesh takes in memory, in bytes.
fn size_of(shape: &StoredShape) -> usize {
    match shape {
        StoredShape::Volume(volume) => {
            let numbers: usize = volume.cells.iter().map(|(_, nodes)| nodes.len() + 2).sum();
            let per_node = 24 + 8 * volume.node_labels.len() + 24 * volume.node_vectors.len();
            let per_cell = 8 * volume.cell_labels.len() + 24 * volume.cell_vectors.len();
            let sets = volume.node_sets.values().chain(volume.cell_sets.values());
            let in_sets: usize = sets.map(Vec::len).sum();
            4 * (numbers + in_sets) + per_node * volume.nodes.len() + per_cell * volume.cells.len()
        }
        StoredShape::Surface(surface) => 28 * surface.points.len() + 12 * surface.triangles.len(),
        StoredShape::Image(image) => image.voxels().bytes(),
    }
}

/// Parsed meshes by the hash of their stored bytes, the least recently used given up first.
struct Cache {
    room: usize,
    used: usize,
    clock: u64,
    meshes: HashMap<String, Cached>,
}

struct Cached {
    mesh: StoredShape,
    size: usize,
    last_used: u64,
}

impl Cache {
    fn get(&mut self, blob: &str) -> Option<StoredShape> {
        self.clock += 1;
        let cached = self.meshes.get_mut(blob)?;
        cached.last_used = self.clock;
        Some(cached.mesh.clone())
    }

    fn insert(&mut self, blob: &str, mesh: StoredShape) {
        let size = size_of(&mesh);
        if size > self.room || self.meshes.contains_key(blob) {
            return;
        }
        self.clock += 1;
        let last_used = self.clock;
        self.used += size;
        self.meshes.insert(blob.to_owned(), Cached { mesh, size, last_used });
        while self.used > self.room {
            let oldest = self.meshes.iter().min_by_key(|(_, cached)| cached.last_used);
            let Some(oldest) = oldest.map(|(blob, _)| blob.clone()) else { break };
            self.forget(&oldest);
        }
    }

    fn forget(&mut self, blob: &str) {
        if let Some(cached) = self.meshes.remove(blob) {
            self.used -= cached.size;
        }
    }
}

/// Stored meshes by id, parsed.
#[derive(Clone)]
pub struct Library {
    store: Store,
    cache: Arc<Mutex<Cache>>,
}

impl Library {
    /// A library that keeps parsed meshes of at most `room` bytes.
    pub fn new(store: Store, room: usize) -> Self {
        let cache = Cache { room, used: 0, clock: 0, meshes: HashMap::new() };
        Library { store, cache: Arc::new(Mutex::new(cache)) }
    }

    fn cache(&self) -> MutexGuard<'_, Cache> {
        self.cache.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Keeps a mesh that was parsed on its way in.
    pub fn keep(&self, blob: &str, mesh: StoredShape) {
        self.cache().insert(blob, mesh);
    }

    /// Gives up a mesh that was deleted.
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
        let document: MeshDocument = serde_json::from_str(&row.report)
            .map_err(|error| StoreError::Schema(format!("report of a mesh: {error}")))?;
        let cached = self.cache().get(&row.blob);
        let shape = match cached {
            Some(shape) => shape,
            None => {
                let shape = self.read(&row.blob, row.sha256.clone()).await?.shape;
                self.keep(&row.blob, shape.clone());
                shape
            }
        };
        Ok(StoredMesh {
            shape,
            frame: document.report.space.or(document.frame).map(Frame::from),
            units: document.units,
            warnings: Vec::new(),
            sha256: row.sha256,
        })
    }

    async fn read(&self, blob: &str, sha256: String) -> Result<StoredMesh, StoreError> {
        let bytes = self.store.read_blob(blob).await?;
        // Our own writers may compress better than a stranger's file is allowed to.
        let limits = ReadLimits { decoded_ratio: f64::INFINITY, ..ReadLimits::default() };
        let parsed = tokio::task::spawn_blocking(move || format::read(&bytes, &limits)).await;
        let parsed = parsed.map_err(|_| StoreError::Interrupted)?;
        let parsed = parsed.map_err(|error| StoreError::Schema(format!("stored mesh: {error}")))?;
        Ok(StoredMesh::new(parsed, Some(LengthUnit::Mm), sha256))
    }

    /// The skin that a successful prediction wrote; `None` where the job has none.
    async fn predicted_skin(&self, job: &str) -> Result<Option<StoredMesh>, StoreError> {
        let Some(file) = self.store.job_file(job, PREDICTED_SKIN).await? else { return Ok(None) };
        self.read(&file.blob, file.blob.clone()).await.map(Some)
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

    fn predicted_skin(&self, job: &str) -> Result<StoredMesh, SourceError> {
        found(job, self.runtime.block_on(self.library.predicted_skin(job)))
    }
}

fn found(
    id: &str,
    mesh: Result<Option<StoredMesh>, StoreError>,
) -> Result<StoredMesh, SourceError> {
    match mesh {
        Ok(Some(mesh)) => Ok(mesh),
        Ok(None) => Err(SourceError::Unknown { id: id.to_owned() }),
        Err(error) => Err(SourceError::Unreadable { id: id.to_owned(), detail: error.to_string() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{TriangleSurface, Vector};

    fn surface(points: usize) -> StoredShape {
        let points = vec![Vector::zeros(); points];
        StoredShape::Surface(Arc::new(TriangleSurface { points, ..TriangleSurface::default() }))
    }

    #[test]
    fn the_mesh_that_was_not_used_for_longest_makes_room() {
        let mut cache = Cache { room: 28 * 10, used: 0, clock: 0, meshes: HashMap::new() };
        cache.insert("a", surface(4));
        cache.insert("b", surface(4));
        assert!(cache.get("a").is_some());
        cache.insert("c", surface(4));
        assert!(cache.get("b").is_none());
        assert!(cache.get("a").is_some() && cache.get("c").is_some());
        cache.insert("too large", surface(11));
        assert!(cache.get("too large").is_none() && cache.get("a").is_some());
        assert_eq!(cache.used, 28 * 8);
    }
}
