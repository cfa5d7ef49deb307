//! Forces at nodes that have no extent: under a force at a point, displacement has no limit as cells become smaller.

use std::collections::BTreeSet;

use super::check::Check;
use super::stated::nodes_without_extent;
use crate::boundary::Constraint;
use crate::mesh::{VolumeMesh, Warning};

impl Check<'_> {
    /// Warns of a load whose nodes, those that may move, are for the most part points, lines or sheets inside the tissue, or have some of
    /// these apart from the others; single nodes at the rim of a patch do not count.
    pub(super) fn point_force(
        &self,
        nodes: &[u32],
        constraints: &[Constraint],
        pointer: &str,
    ) -> Option<Warning> {
        let held = constraints.iter().filter(|constraint| constraint.count() == 3);
        let held: BTreeSet<u32> = held.map(|constraint| constraint.node).collect();
        let is_free = |node: &u32| !held.contains(node);
        let free = nodes.iter().filter(|node| is_free(node)).count();
        let mesh = &self.case.volume;
        let mut points = nodes_without_extent(nodes, mesh, self.boundary);
        let all = points.clone();
        points.retain(is_free);
        if 2 * points.len() <= free {
            keep_apart(&mut points, nodes, &all, mesh);
        }
        let first = *points.first()?;
        let at = mesh.nodes[first as usize];
        let count = points.len();
        let of = if count < free { format!(" of {free}") } else { String::new() };
        let detail = format!(
            "the force at {pointer} acts at {count}{of} nodes that fill no face of the boundary and no cell together, the first at ({:.1}, \
             {:.1}, {:.1}) mm: a force at a point or along a line has no limit as cells become smaller, where it acts the displacement \
             grows without end, and no estimate shows it. State a traction on faces",
            at.x, at.y, at.z
        );
        let warning = Warning::new("point-force", detail).with("nodes", count as f64);
        let warning = warning.with("of", free as f64);
        Some(warning.with("x_mm", at.x).with("y_mm", at.y).with("z_mm", at.z))
    }
}

/// Keeps those that share no cell with a node that has extent; `all` are those without.
fn keep_apart(points: &mut Vec<u32>, nodes: &[u32], all: &[u32], mesh: &VolumeMesh) {
    if points.is_empty() {
        return;
    }
    let mut is_filled = vec![false; mesh.nodes.len()];
    nodes.iter().for_each(|&node| is_filled[node as usize] = true);
    all.iter().for_each(|&node| is_filled[node as usize] = false);
    let mut is_beside = vec![false; mesh.nodes.len()];
    for (_, cell) in mesh.cells.iter() {
        if cell.iter().any(|&node| is_filled[node as usize]) {
            cell.iter().for_each(|&node| is_beside[node as usize] = true);
        }
    }
    points.retain(|&node| !is_beside[node as usize]);
}
