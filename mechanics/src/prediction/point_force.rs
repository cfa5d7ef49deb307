//! Forces at nodes that have no extent: under a force at a point, displacement has no limit as cells become smaller.

use std::collections::BTreeSet;

use super::check::Check;
use super::stated::nodes_without_extent;
use crate::boundary::Constraint;
use crate::mesh::Warning;

impl Check<'_> {
    /// Warns of a load whose nodes, those that may move, are for the most part points, lines or sheets inside the tissue.
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
        points.retain(is_free);
        let first = *points.first().filter(|_| 2 * points.len() > free)?;
        let at = mesh.nodes[first as usize];
        let detail = format!(
            "the force at {pointer} acts at {} nodes that fill no face of the boundary and no cell together, the first at ({:.1}, {:.1}, \
             {:.1}) mm: a force at a point or along a line has no limit as cells become smaller, where it acts the displacement grows \
             without end, and no estimate shows it. State a traction on faces",
            points.len(),
            at.x,
            at.y,
            at.z
        );
        let warning = Warning::new("point-force", detail).with("nodes", points.len() as f64);
        Some(warning.with("x_mm", at.x).with("y_mm", at.y).with("z_mm", at.z))
    }
}
