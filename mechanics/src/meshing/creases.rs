//! Creases: where two boundaries meet, nodes are moved onto both, so that the edge between them is not cut off.

use super::boundary_set::BoundarySet;
use super::climb::Climb;
use super::draft::Draft;
use super::error::MeshingError;
use super::watch::Watch;

/// How far nodes may be moved, in parts of their longest edge: first those that lie near.
const LIMITS: [f64; 2] = [0.15, 0.35];
/// Angles stay above 12 degrees.
const FAIR: f64 = 0.21;

/// A node of an edge of the boundary whose ends share no boundary, and the other end.
type CreaseEdge = [u32; 2];

/// Moves nodes onto creases; returns how many.
pub(super) fn snap_creases(climb: &mut Climb, watch: &Watch) -> Result<usize, MeshingError> {
    let mut moved = 0;
    for limit in LIMITS {
        let beside = beside_creases(climb);
        let mut nodes: Vec<u32> = beside.iter().map(|&[node, _]| node).collect();
        nodes.dedup();
        moved += climb.sweep(&nodes, watch, |climb, node| {
            let wanted = beyond(climb.draft, &beside, node);
            let star = (!wanted.is_empty()).then(|| climb.star(node));
            star.and_then(|star| star.on_crease(wanted, limit, FAIR))
        })?;
    }
    Ok(moved)
}

/// Both ways, ascending.
fn beside_creases(Climb { draft, faces, .. }: &Climb) -> Vec<CreaseEdge> {
    let several = draft.boundaries.iter().fold(BoundarySet::NONE, |all, &set| all.and(set));
    if several.iter().count() < 2 {
        return Vec::new();
    }
    let edges = faces.iter().flat_map(|face| {
        let [a, b, c] = face.nodes;
        [[a, b], [b, a], [b, c], [c, b], [c, a], [a, c]]
    });
    let mut beside: Vec<CreaseEdge> = edges.filter(|&[a, b]| parts(draft, a, b)).collect();
    beside.sort_unstable();
    beside.dedup();
    beside
}

fn parts(draft: &Draft, one: u32, other: u32) -> bool {
    let [a, b] = [one, other].map(|node| draft.boundaries[node as usize]);
    a.shared(b).is_empty()
}

/// The boundaries on the far side of the crease that a node is still beside.
fn beyond(draft: &Draft, beside: &[CreaseEdge], node: u32) -> BoundarySet {
    let first = beside.partition_point(|edge| edge[0] < node);
    let edges = beside[first..].iter().take_while(|edge| edge[0] == node);
    let others = edges.map(|edge| edge[1]).filter(|&other| parts(draft, node, other));
    others.fold(BoundarySet::NONE, |all, other| all.and(draft.boundaries[other as usize]))
}
