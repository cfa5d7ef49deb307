//! Free band along an osteotomy: constrained nodes too near to others with another movement.

use std::collections::BTreeSet;

use crate::mesh::VolumeMesh;
use crate::mesh::cubes::Cubes;

/// Held nodes, by number ascending, with one of another movement at most `band_mm` away or in one of their cells.
/// `None` for nodes that are not held.
pub(super) fn near_other_segments(
    mesh: &VolumeMesh,
    movements: &[Option<u32>],
    band_mm: f64,
) -> BTreeSet<u32> {
    let mut near = in_mixed_cells(mesh, movements);
    if band_mm > 0.0 {
        near.extend(within(mesh, movements, band_mm));
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

fn within(mesh: &VolumeMesh, movements: &[Option<u32>], band_mm: f64) -> Vec<u32> {
    let place = |node: u32| mesh.nodes[node as usize];
    let movement = |node: u32| movements[node as usize];
    let held = || (0..movements.len() as u32).filter(|&node| movement(node).is_some());
    let cubes = Cubes::new(band_mm, held().map(|node| (node, place(node))));
    held()
        .filter(|&node| {
            cubes.around(&place(node)).any(|other| {
                movement(other) != movement(node) && (place(other) - place(node)).norm() <= band_mm
            })
        })
        .collect()
}
