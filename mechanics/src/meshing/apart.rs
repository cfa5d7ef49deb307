//! Boundary of tissue that touches itself, moved apart until no two of its triangles cross.

use super::climb::Climb;
use super::error::MeshingError;
use super::watch::Watch;
use crate::mesh::TriangleSurface;
use crate::mesh::crossing::self_crossings;

/// Looks at which triangles cross, at most; between two of them their nodes go into their own cells.
const LOOKS: usize = 40;

/// Moves copies of nodes apart, then nodes of triangles that cross, each into its own cells as far as these stay good. Returns how
/// many pairs of triangles still cross.
pub(super) fn part(climb: &mut Climb, watch: &Watch) -> Result<u64, MeshingError> {
    climb.part_copies();
    let triangles = climb.faces.iter().map(|face| face.nodes).collect();
    let mut boundary = TriangleSurface { points: Vec::new(), triangles, node_ids: None };
    let mut looks = LOOKS;
    loop {
        watch.check_cancelled()?;
        boundary.points.clone_from(&climb.draft.nodes);
        let crossings = self_crossings(&boundary, |_| true);
        let triangles = crossings.pairs.iter().flatten();
        let nodes = triangles.flat_map(|&triangle| boundary.triangles[triangle as usize]);
        let mut nodes: Vec<u32> = nodes.collect();
        nodes.sort_unstable();
        nodes.dedup();
        let moved = climb.sweep(&nodes, watch, |climb, node| climb.star(node).inwards())?;
        looks -= 1;
        if moved == 0 || looks == 0 {
            return Ok(crossings.count);
        }
    }
}
