//! Parts of a mesh that hang together nowhere, and nodes that no cell names.

use super::connectivity::{Faces, parts_by_nodes};
use super::{VolumeMesh, Warning};

/// The warning of a volume mesh in parts that share no node: a face is one, and what is not joined to it is held and
/// moved by itself.
pub fn several_components(mesh: &VolumeMesh, faces: &Faces) -> Option<Warning> {
    let mut cells: Vec<u64> = Vec::new();
    for part in parts_by_nodes(mesh, &faces.parts()) {
        cells.resize(cells.len().max(part as usize + 1), 0);
        cells[part as usize] += 1;
    }
    cells.sort_unstable_by(|one, other| other.cmp(one));
    let (largest, others) = cells.split_first()?;
    let rest: u64 = others.iter().sum();
    let detail = format!(
        "{} parts of the mesh, {rest} cells, touch the largest one, of {largest} cells, nowhere",
        others.len()
    );
    let warning = Warning::new("several-components", detail).with("count", others.len() as f64);
    (!others.is_empty()).then(|| warning.with("cells", rest as f64))
}

/// For each of so many nodes whether it is among those that cells or triangles name.
pub fn referenced<'a>(nodes: usize, named: impl Iterator<Item = &'a u32>) -> Vec<bool> {
    let mut is_named = vec![false; nodes];
    named.for_each(|&node| is_named[node as usize] = true);
    is_named
}
