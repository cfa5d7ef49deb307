//! Parsed meshes in memory, by the hash of their stored bytes; the least recently used is given up first.

use std::collections::HashMap;

use crate::jobs::StoredShape;

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

/// Meshes of at most `room` bytes.
pub struct MeshCache {
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

impl MeshCache {
    pub fn new(room: usize) -> Self {
        MeshCache { room, used: 0, clock: 0, meshes: HashMap::new() }
    }

    pub fn get(&mut self, blob: &str) -> Option<StoredShape> {
        self.clock += 1;
        let cached = self.meshes.get_mut(blob)?;
        cached.last_used = self.clock;
        Some(cached.mesh.clone())
    }

    pub fn insert(&mut self, blob: &str, mesh: StoredShape) {
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

    pub fn forget(&mut self, blob: &str) {
        if let Some(cached) = self.meshes.remove(blob) {
            self.used -= cached.size;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use mechanics::mesh::{TriangleSurface, Vector};

    fn surface(points: usize) -> StoredShape {
        let points = vec![Vector::zeros(); points];
        StoredShape::Surface(Arc::new(TriangleSurface { points, ..TriangleSurface::default() }))
    }

    #[test]
    fn the_mesh_that_was_not_used_for_longest_makes_room() {
        let mut cache = MeshCache::new(28 * 10);
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
