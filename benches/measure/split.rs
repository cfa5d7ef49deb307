//! Hexahedra and wedges split into tetrahedra between a new node in the middle of each cell and the triangles of its faces.
//!
//! Every quadrilateral is cut along the diagonal that leaves the smallest of the tetrahedra on its two sides largest, as a
//! share of their cells. Cut along diagonals from their lowest nodes, without middles, the warped cells of the two faces have
//! tetrahedra that are inside out; whether this leaves some too is for the caller to ask.

use std::collections::BTreeMap;

use mechanics::mesh::{CellShape, Cells, Vector, VolumeMesh};

/// Cells of a mesh, each with the node in its middle.
struct Middles<'a> {
    mesh: &'a VolumeMesh,
    nodes: Vec<Vector>,
    of_cell: Vec<Option<u32>>,
}

/// The mesh in tetrahedra. Nodes keep their numbers, node sets theirs.
pub fn tetrahedra(mesh: &VolumeMesh) -> VolumeMesh {
    let mut nodes = mesh.nodes.clone();
    let mut of_cell = Vec::new();
    for (cell, (shape, corners)) in mesh.cells.iter().enumerate() {
        of_cell.push((shape != CellShape::Tet4).then_some(nodes.len() as u32));
        if shape != CellShape::Tet4 {
            nodes.push(mesh.corners(cell).sum::<Vector>() / corners.len() as f64);
        }
    }
    let middles = Middles { mesh, nodes, of_cell };
    let diagonals = middles.diagonals();
    let mut cells = Cells::default();
    for (cell, (shape, corners)) in mesh.cells.iter().enumerate() {
        let Some(middle) = middles.of_cell[cell] else {
            cells.push(CellShape::Tet4, corners);
            continue;
        };
        for face in shape.faces() {
            let face: Vec<u32> = face.iter().map(|&corner| corners[corner]).collect();
            for [a, b, c] in triangles(&face, diagonals.get(&sorted(&face)).copied()) {
                cells.push(CellShape::Tet4, &[a, c, b, middle]);
            }
        }
    }
    let node_sets = mesh.node_sets.clone();
    VolumeMesh { nodes: middles.nodes, cells, node_sets, ..VolumeMesh::default() }
}

impl Middles<'_> {
    /// For each quadrilateral one end of its diagonal.
    fn diagonals(&self) -> BTreeMap<Vec<u32>, u32> {
        let mut smallest: BTreeMap<Vec<u32>, Vec<(u32, f64)>> = BTreeMap::new();
        for (cell, (shape, corners)) in self.mesh.cells.iter().enumerate() {
            let Some(middle) = self.of_cell[cell] else { continue };
            let size = self.volume_of(cell, shape, corners);
            for face in shape.faces().iter().filter(|face| face.len() == 4) {
                let face: Vec<u32> = face.iter().map(|&corner| corners[corner]).collect();
                let both = smallest.entry(sorted(&face)).or_default();
                for from in sorted(&face) {
                    let least = triangles(&face, Some(from))
                        .into_iter()
                        .map(|[a, b, c]| self.volume([a, c, b, middle]) / size)
                        .fold(f64::INFINITY, f64::min);
                    match both.iter_mut().find(|(own, _)| *own == from) {
                        Some((_, own)) => *own = own.min(least),
                        None => both.push((from, least)),
                    }
                }
            }
        }
        let best = |ends: Vec<(u32, f64)>| {
            let first = ends[0];
            ends.into_iter().fold(first, |best, own| if own.1 > best.1 { own } else { best }).0
        };
        smallest.into_iter().map(|(face, ends)| (face, best(ends))).collect()
    }

    fn volume(&self, [a, b, c, d]: [u32; 4]) -> f64 {
        let [a, b, c, d] = [a, b, c, d].map(|node| self.nodes[node as usize]);
        (b - a).cross(&(c - a)).dot(&(d - a)) / 6.0
    }

    fn volume_of(&self, cell: usize, shape: CellShape, corners: &[u32]) -> f64 {
        let middle = self.of_cell[cell].unwrap_or_default();
        let faces = shape.faces().iter();
        let all = faces.flat_map(|face| {
            let face: Vec<u32> = face.iter().map(|&corner| corners[corner]).collect();
            triangles(&face, None)
        });
        all.map(|[a, b, c]| self.volume([a, c, b, middle])).sum()
    }
}

/// A face as triangles; a quadrilateral is cut along the diagonal from one of its corners, its first where none is given.
fn triangles(face: &[u32], from: Option<u32>) -> Vec<[u32; 3]> {
    let mut face = face.to_vec();
    let start = face.iter().position(|node| Some(*node) == from).unwrap_or_default();
    face.rotate_left(start);
    face[1..].windows(2).map(|pair| [face[0], pair[0], pair[1]]).collect()
}

fn sorted(face: &[u32]) -> Vec<u32> {
    let mut face = face.to_vec();
    face.sort_unstable();
    face
}
