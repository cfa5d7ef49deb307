//! Hexahedra and wedges split into tetrahedra between a new node in the middle of each cell and the triangles of its faces.
//!
//! Every quadrilateral is cut into four around a new node in its middle, so that a hexahedron becomes 24 tetrahedra. Cut along
//! diagonals, with a middle or without, the warped cells of the two faces have tetrahedra that are inside out.

use std::collections::BTreeMap;

use mechanics::mesh::{CellShape, Cells, Vector, VolumeMesh};

/// The mesh in tetrahedra. Nodes keep their numbers, node sets theirs; a middle of a face belongs to the sets of all its nodes.
pub fn tetrahedra(mesh: &VolumeMesh) -> VolumeMesh {
    let mut split = VolumeMesh { node_sets: mesh.node_sets.clone(), ..VolumeMesh::default() };
    split.nodes.clone_from(&mesh.nodes);
    let mut middles: BTreeMap<Vec<u32>, u32> = BTreeMap::new();
    let mut cells = Cells::default();
    for (shape, corners) in mesh.cells.iter() {
        if shape == CellShape::Tet4 {
            cells.push(shape, corners);
            continue;
        }
        let middle = add_middle(&mut split.nodes, corners);
        for face in shape.faces() {
            let face: Vec<u32> = face.iter().map(|&corner| corners[corner]).collect();
            if let [a, b, c] = face[..] {
                cells.push(CellShape::Tet4, &[a, c, b, middle]);
                continue;
            }
            let mut sorted = face.clone();
            sorted.sort_unstable();
            let of_face =
                *middles.entry(sorted).or_insert_with(|| add_middle(&mut split.nodes, &face));
            for (k, &a) in face.iter().enumerate() {
                let b = face[(k + 1) % face.len()];
                cells.push(CellShape::Tet4, &[of_face, b, a, middle]);
            }
        }
    }
    for set in split.node_sets.values_mut() {
        let whole = |face: &Vec<u32>| face.iter().all(|node| set.binary_search(node).is_ok());
        let inside = middles.iter().filter(|(face, _)| whole(face)).map(|(_, &middle)| middle);
        let inside: Vec<u32> = inside.collect();
        set.extend(inside);
        set.sort_unstable();
    }
    VolumeMesh { cells, ..split }
}

/// A new node in the middle of others.
fn add_middle(nodes: &mut Vec<Vector>, of: &[u32]) -> u32 {
    let sum: Vector = of.iter().map(|&node| nodes[node as usize]).sum();
    nodes.push(sum / of.len() as f64);
    nodes.len() as u32 - 1
}
