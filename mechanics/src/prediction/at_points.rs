//! What a case or a plan states of nodes, on meshes that are finer than those it is stated of.

use std::collections::BTreeSet;

use super::case::{Case, Load, Plan};
use super::check::Check;
use super::scene::Scene;
use crate::boundary::NodeSelection;
use crate::mesh::Warning;
use crate::model::problem::InvertedCell;
use crate::progress::StopQuery;

/// The warning where conditions or forces act at points, which a refined mesh feels less and less, or without end.
pub fn points_refined(scene: &Scene) -> Result<Option<Warning>, InvertedCell> {
    let mut held: BTreeSet<u32> = BTreeSet::new();
    for stated in &scene.stated {
        let without = stated.nodes_without_extent(&scene.mesh, &scene.boundary);
        // Some at the rim of a surface are usual.
        if 2 * without.len() > stated.nodes.len() {
            held.extend(without);
        }
    }
    let forces = scene.nodes_with_forces()?;
    let Some(&first) = held.iter().chain(&forces).next() else { return Ok(None) };
    let at = scene.mesh.nodes[first as usize];
    let detail = format!(
        "{} nodes are held that fill no face of the boundary and no cell together, and forces act at {} nodes, the first at ({:.1}, {:.1}, \
         {:.1}) mm: a refined mesh keeps them as points or lines, which hold less and yield more the finer it is; neither the answer nor its \
         estimate has a limit there. State a surface, cells or a traction, or do not refine",
        held.len(),
        forces.len(),
        at.x,
        at.y,
        at.z
    );
    let warning = Warning::new("points-refined", detail);
    let warning = warning.with("held_nodes", held.len() as f64);
    Ok(Some(warning.with("forces", forces.len() as f64)))
}

impl Plan {
    /// The same for any mesh that is cut from that of a case: forces stay at the nodes that have them there.
    pub fn at_nodes_of(&self, case: &Case) -> Plan {
        let mut plan = self.clone();
        if !plan.loads.iter().any(|load| matches!(load, Load::Force { .. })) {
            return plan;
        }
        let boundary = case.volume.boundary_faces();
        let stop = StopQuery::never();
        let mut check = Check::new(case, &boundary, &stop);
        for load in &mut plan.loads {
            if let Load::Force { nodes, .. } = load {
                let selected = check.select(nodes, "/plan/loads");
                // What selects nothing is refused where a scene is made of it.
                if !selected.is_empty() {
                    *nodes = NodeSelection::Nodes(selected);
                }
            }
        }
        plan
    }
}
