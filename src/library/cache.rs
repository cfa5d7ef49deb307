//! Cache of parsed blobs by their hash, least recently used out first (LRU).

use std::collections::HashMap;

use crate::jobs::StoredShape;

/// Values with a size in memory.
pub trait InMemory {
    /// About how much, in bytes.
    fn size(&self) -> usize;
}

impl InMemory for StoredShape {
    fn size(&self) -> usize {
        match self {
            StoredShape::Volume(volume) => {
                let numbers: usize = volume.cells.iter().map(|(_, nodes)| nodes.len() + 2).sum();
                let per_node = 24 + 8 * volume.node_labels.len() + 24 * volume.node_vectors.len();
                let per_cell = 8 * volume.cell_labels.len() + 24 * volume.cell_vectors.len();
                let sets = volume.node_sets.values().chain(volume.cell_sets.values());
                let in_sets: usize = sets.map(Vec::len).sum();
                4 * (numbers + in_sets)
                    + per_node * volume.nodes.len()
                    + per_cell * volume.cells.len()
            }
            StoredShape::Surface(surface) => {
                28 * surface.points.len() + 12 * surface.triangles.len()
            }
            StoredShape::Image(image) => image.voxels().bytes(),
        }
    }
}

/// Parsed meshes.
pub type MeshCache = Cache<StoredShape>;

/// Things of at most `room` bytes.
pub struct Cache<T> {
    room: usize,
    used: usize,
    clock: u64,
    kept: HashMap<String, Entry<T>>,
}

struct Entry<T> {
    thing: T,
    last_used: u64,
}

impl<T: Clone + InMemory> Cache<T> {
    pub fn new(room: usize) -> Self {
        Cache { room, used: 0, clock: 0, kept: HashMap::new() }
    }

    pub fn get(&mut self, blob: &str) -> Option<T> {
        self.clock += 1;
        let kept = self.kept.get_mut(blob)?;
        kept.last_used = self.clock;
        Some(kept.thing.clone())
    }

    pub fn insert(&mut self, blob: &str, thing: T) {
        let size = thing.size();
        if size > self.room || self.kept.contains_key(blob) {
            return;
        }
        self.clock += 1;
        self.used += size;
        self.kept.insert(blob.to_owned(), Entry { thing, last_used: self.clock });
        while self.used > self.room {
            let oldest = self.kept.iter().min_by_key(|(_, kept)| kept.last_used);
            let Some(oldest) = oldest.map(|(blob, _)| blob.clone()) else { break };
            self.forget(&oldest);
        }
    }

    pub fn forget(&mut self, blob: &str) {
        if let Some(kept) = self.kept.remove(blob) {
            self.used -= kept.thing.size();
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
    fn what_was_not_used_for_longest_makes_room() {
        let mut cache = Cache::new(28 * 10);
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
