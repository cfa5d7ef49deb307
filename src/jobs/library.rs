//! The meshes of the service, parsed: kept in memory while there is room, so that a job does not parse
//! again what its check has parsed.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::format::{self, Mesh, ReadLimits};
use crate::mesh::{Frame, TriangleSurface, VolumeMesh};
use crate::schema::case::LengthUnit;
use crate::schema::mesh::MeshDocument;
use crate::store::{MeshRow, Store, StoreError};

/// A parsed mesh in the unit of its file, shared by all who use it.
#[derive(Clone, Debug)]
pub enum SharedMesh {
    Volume(Arc<VolumeMesh>),
    Surface(Arc<TriangleSurface>),
}

impl From<Mesh> for SharedMesh {
    fn from(mesh: Mesh) -> Self {
        match mesh {
            Mesh::Volume(volume) => SharedMesh::Volume(Arc::new(volume)),
            Mesh::Surface(surface) => SharedMesh::Surface(Arc::new(surface)),
        }
    }
}

impl SharedMesh {
    /// About what it takes in memory, in bytes.
    fn size(&self) -> usize {
        match self {
            SharedMesh::Volume(volume) => {
                let numbers: usize = volume.cells.iter().map(|(_, nodes)| nodes.len() + 2).sum();
                let per_node = 24 + 8 * volume.node_labels.len() + 24 * volume.node_vectors.len();
                let per_cell = 8 * volume.cell_labels.len();
                let sets = volume.node_sets.values().chain(volume.cell_sets.values());
                let in_sets: usize = sets.map(Vec::len).sum();
                4 * (numbers + in_sets)
                    + per_node * volume.nodes.len()
                    + per_cell * volume.cells.len()
            }
            SharedMesh::Surface(surface) => {
                28 * surface.points.len() + 12 * surface.triangles.len()
            }
        }
    }
}

/// A stored mesh with what its upload said about it.
#[derive(Clone, Debug)]
pub struct LibraryMesh {
    pub id: String,
    /// Of the bytes that were uploaded.
    pub sha256: String,
    pub mesh: SharedMesh,
    /// Named by the file or by the upload.
    pub frame: Option<Frame>,
    /// Named by the upload.
    pub units: Option<LengthUnit>,
}

/// Parsed meshes by the hash of their stored bytes, the least recently used given up first.
struct Cache {
    room: usize,
    used: usize,
    clock: u64,
    meshes: HashMap<String, Cached>,
}

struct Cached {
    mesh: SharedMesh,
    size: usize,
    last_used: u64,
}

impl Cache {
    fn get(&mut self, blob: &str) -> Option<SharedMesh> {
        self.clock += 1;
        let cached = self.meshes.get_mut(blob)?;
        cached.last_used = self.clock;
        Some(cached.mesh.clone())
    }

    fn insert(&mut self, blob: &str, mesh: SharedMesh) {
        let size = mesh.size();
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
    pub fn keep(&self, blob: &str, mesh: SharedMesh) {
        self.cache().insert(blob, mesh);
    }

    /// Gives up a mesh that was deleted.
    pub fn forget(&self, blob: &str) {
        self.cache().forget(blob);
    }

    pub async fn get(&self, id: &str) -> Result<Option<LibraryMesh>, StoreError> {
        match self.store.mesh(id).await? {
            Some(row) => self.open(row).await.map(Some),
            None => Ok(None),
        }
    }

    /// The mesh of a row; parsed on a thread that may block.
    pub async fn open(&self, row: MeshRow) -> Result<LibraryMesh, StoreError> {
        let document: MeshDocument = serde_json::from_str(&row.report)
            .map_err(|error| StoreError::Schema(format!("report of a mesh: {error}")))?;
        let cached = self.cache().get(&row.blob);
        let mesh = match cached {
            Some(mesh) => mesh,
            None => self.parse(&row.blob).await?,
        };
        Ok(LibraryMesh {
            id: row.id,
            sha256: row.sha256,
            mesh,
            frame: document.report.space.or(document.frame).map(Frame::from),
            units: document.units,
        })
    }

    async fn parse(&self, blob: &str) -> Result<SharedMesh, StoreError> {
        let bytes = self.store.read_blob(blob).await?;
        let limits = ReadLimits { decoded_ratio: f64::INFINITY, ..ReadLimits::default() };
        let parsed = tokio::task::spawn_blocking(move || format::read(&bytes, &limits)).await;
        let parsed = parsed.map_err(|_| StoreError::Interrupted)?;
        let parsed = parsed.map_err(|error| StoreError::Schema(format!("stored mesh: {error}")))?;
        let mesh = SharedMesh::from(parsed.mesh);
        self.keep(blob, mesh.clone());
        Ok(mesh)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Vector;

    fn surface(points: usize) -> SharedMesh {
        let points = vec![Vector::zeros(); points];
        SharedMesh::Surface(Arc::new(TriangleSurface { points, ..TriangleSurface::default() }))
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
