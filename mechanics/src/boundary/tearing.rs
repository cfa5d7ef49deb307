//! Held neighbours that part: where a plan tears the tissue at an osteotomy (docs/verification.md#v27).

use super::hold::Hold;
use crate::mesh::{Vector, VolumeMesh, Warning};

/// A difference of displacement above this share of the edge it spans tears.
const TEARING: f64 = 1.0;

/// A warning that counts the edges between wholly held nodes along which |du| / h exceeds 1.
pub fn tearing(mesh: &VolumeMesh, holds: &[Hold]) -> Option<Warning> {
    let mut displacement: Vec<Option<Vector>> = vec![None; mesh.nodes.len()];
    for hold in holds.iter().filter(|hold| hold.count() == 3) {
        displacement[hold.node as usize] = Some(*hold.values());
    }
    let mut torn: Vec<(u32, u32)> = Vec::new();
    let (mut worst, mut worst_edge) = (0.0, (0, 0));
    for (shape, nodes) in mesh.cells.iter() {
        for edge in shape.edges() {
            let [a, b] = edge.map(|local| nodes[local]);
            let (Some(u), Some(v)) = (displacement[a as usize], displacement[b as usize]) else {
                continue;
            };
            let ratio = (u - v).norm() / (mesh.nodes[a as usize] - mesh.nodes[b as usize]).norm();
            if ratio > TEARING {
                torn.push((a.min(b), a.max(b)));
            }
            if ratio > worst {
                (worst, worst_edge) = (ratio, (a.min(b), a.max(b)));
            }
        }
    }
    torn.sort_unstable();
    torn.dedup();
    if torn.is_empty() {
        return None;
    }
    let (a, b) = worst_edge;
    let detail = format!(
        "tearing between segments or beside what is fixed: {} edges between held nodes are displaced by more than their length, \
         worst between nodes {a} and {b}",
        torn.len()
    );
    let warning = Warning::new("tearing", detail).with("edges", torn.len() as f64);
    Some(warning.with("largest_ratio", worst))
}
