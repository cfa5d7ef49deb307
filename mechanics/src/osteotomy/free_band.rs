//! The band along an osteotomy: held nodes too near to others that move otherwise.

use std::collections::{BTreeSet, HashMap};

use crate::mesh::{Vector, VolumeMesh};

/// Held nodes, by number ascending, with one of another movement at most `band_mm` away or in one of their cells.
/// `None` for nodes that are not held.
pub(super) fn near_others(
    mesh: &VolumeMesh,
    movements: &[Option<u32>],
    band_mm: f64,
) -> BTreeSet<u32> {
    let mut near = in_mixed_cells(mesh, movements);
    if band_mm > 0.0 {
        let buckets = Buckets::new(mesh, movements, band_mm);
        let held = (0..movements.len()).filter(|&node| movements[node].is_some());
        near.extend(held.filter(|&node| buckets.has_other_near(node)).map(|node| node as u32));
    }
    near
}

fn in_mixed_cells(mesh: &VolumeMesh, movements: &[Option<u32>]) -> BTreeSet<u32> {
    let mut near = BTreeSet::new();
    for (_, nodes) in mesh.cells.iter() {
        let held = || nodes.iter().filter(|node| movements[**node as usize].is_some());
        let first = held().next().map(|node| movements[*node as usize]);
        if held().any(|node| Some(movements[*node as usize]) != first) {
            near.extend(held());
        }
    }
    near
}

/// Held nodes by the cube they are in; cubes are as wide as the band.
struct Buckets<'a> {
    nodes: &'a [Vector],
    movements: &'a [Option<u32>],
    band_mm: f64,
    cubes: HashMap<[i64; 3], Vec<usize>>,
}

impl<'a> Buckets<'a> {
    fn new(mesh: &'a VolumeMesh, movements: &'a [Option<u32>], band_mm: f64) -> Self {
        let mut buckets = Buckets { nodes: &mesh.nodes, movements, band_mm, cubes: HashMap::new() };
        for node in (0..movements.len()).filter(|&node| movements[node].is_some()) {
            let cube = buckets.cube(node);
            buckets.cubes.entry(cube).or_default().push(node);
        }
        buckets
    }

    fn cube(&self, node: usize) -> [i64; 3] {
        [0, 1, 2].map(|axis| (self.nodes[node][axis] / self.band_mm).floor() as i64)
    }

    fn has_other_near(&self, node: usize) -> bool {
        let [x, y, z] = self.cube(node);
        let other = |other: &usize| {
            let way = self.nodes[*other] - self.nodes[node];
            self.movements[*other] != self.movements[node] && way.norm() <= self.band_mm
        };
        (0..27).any(|number| {
            let around = [x + number % 3 - 1, y + number / 3 % 3 - 1, z + number / 9 - 1];
            self.cubes.get(&around).is_some_and(|nodes| nodes.iter().any(other))
        })
    }
}
