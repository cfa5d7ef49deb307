//! Cost of a refined reference solution before it is solved: its meshes, their unknowns and the solves on them.

use super::levels::cells_at;
use super::truth::{
    PLANS_A_SEGMENT, coarsest, in_contact, is_in_contact, is_of_segments, moved_segments,
};
use super::variant::{Strain, StudyScene, Truth, Variant};
use crate::mesh::CellShape;
use crate::prediction::{ElementChoice, Plan};

/// Edges for each node of a mesh whose edges carry nodes as well: eight times its nodes come of one halving.
const WITH_EDGES: f64 = 8.0;

/// Cost of a refined reference solution.
#[derive(Clone, Debug, PartialEq)]
pub struct TruthCost {
    /// Coarsest first: the finest, and one or two before it that tell its error.
    pub meshes: Vec<TruthMesh>,
    /// Solved on each mesh: one, or one with contact and one without.
    pub truths: usize,
    pub strain: Strain,
}

/// One mesh of a refined truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TruthMesh {
    pub cells: f64,
    /// Of each solve.
    pub unknowns: f64,
    /// For all plans and materials, with contact and without; unit movements of a segment count as the plans that cost as much.
    pub solves: usize,
}

/// The cost of the truth that the rows of these variants are held against; none where nothing is solved for it.
pub fn truth_cost<'a>(
    scene: &StudyScene,
    variants: impl IntoIterator<Item = &'a Variant>,
) -> Option<TruthCost> {
    let Truth::Refined { times, element, strain } = scene.truth else { return None };
    let volume = &scene.case.volume;
    let (touching, others): (Vec<&Variant>, Vec<&Variant>) =
        variants.into_iter().partition(|variant| is_in_contact(scene, variant));
    let with = if touching.is_empty() { 0 } else { scene.plans.len() * scene.materials.len() };
    let each = scene.materials.iter().map(|materials| scene.plans_of(materials));
    let without = match others.is_empty() {
        true => 0,
        false => each.map(|plans| solves(scene, &plans, strain)).sum(),
    };
    let solves = with + without;
    let element = if others.is_empty() { in_contact(element) } else { element };
    let is_quadratic = element == ElementChoice::Quadratic
        && volume.cells.iter().any(|(shape, _)| shape == CellShape::Tet4);
    let per_node = if is_quadratic { 3.0 * WITH_EDGES } else { 3.0 };
    let mesh = |level| TruthMesh {
        cells: cells_at(volume.cells.len(), level),
        unknowns: per_node * cells_at(volume.nodes.len(), level),
        solves,
    };
    let truths = [with, without].iter().filter(|solves| **solves > 0).count();
    Some(TruthCost { meshes: (coarsest(times)..=times).map(mesh).collect(), truths, strain })
}

/// Solves of plans on one mesh with one material.
fn solves(scene: &StudyScene, plans: &[(String, Plan)], strain: Strain) -> usize {
    if strain == Strain::Finite {
        return plans.len();
    }
    let sums = plans.iter().filter(|(_, plan)| is_of_segments(plan, &scene.case)).count();
    let columns = PLANS_A_SEGMENT * moved_segments(plans, &scene.case).len();
    if columns == 0 { plans.len() } else { plans.len() - sums + sums.min(columns) }
}
