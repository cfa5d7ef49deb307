//! Cuts of a mesh without a gap: boundary nodes at exactly the place of another one.
//!
//! Two meshes that were joined without merging their nodes look whole and come apart when they are moved. Lips
//! that touch are cut on purpose: hence a warning and no refusal.

use crate::mesh::{VolumeMesh, Warning};

/// A warning that counts the nodes that lie on another one. `boundary_nodes` has each node once.
pub(super) fn duplicate_nodes(mesh: &VolumeMesh, boundary_nodes: &[u32]) -> Option<Warning> {
    // Adding zero makes one of the two zeros.
    let bits = |node: u32| {
        let place = mesh.nodes[node as usize];
        [place.x, place.y, place.z].map(|c| (c + 0.0).to_bits())
    };
    let mut places: Vec<([u64; 3], u32)> =
        boundary_nodes.iter().map(|&node| (bits(node), node)).collect();
    places.sort_unstable();
    let same = places.chunk_by(|one, other| one.0 == other.0).filter(|same| same.len() > 1);
    let (mut count, mut first) = (0, u32::MAX);
    for group in same {
        count += group.len() - 1;
        first = group.iter().map(|(_, node)| *node).fold(first, u32::min);
    }
    let detail = format!(
        "{count} boundary nodes lie exactly on another one, the first is node {first}: the tissue is cut there"
    );
    (count > 0).then(|| Warning::new("duplicate-nodes", detail).with("count", count as f64))
}
