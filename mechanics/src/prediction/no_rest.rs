//! Why tissue at finite strain finds no rest: bones that pass through each other.

use super::scene::Scene;
use crate::boundary::tearing::turned_edges;
use crate::model::problem::ModelError;
use crate::solver::SolverError;

/// The error of a solution, with the edges of cells that its bones turn round.
pub(super) fn no_rest(scene: &Scene, error: ModelError) -> ModelError {
    let finds_none = matches!(
        error,
        ModelError::Standstill { .. } | ModelError::Solver(SolverError::NotConverged { .. })
    );
    let turned = || turned_edges(&scene.mesh, &scene.conditions);
    let Some(turned) = finds_none.then(turned).flatten() else { return error };
    let told = turned.told(|class| scene.class_name(class));
    let (edges, cells) = (turned.edges, turned.cells);
    ModelError::BonesPass { cause: Box::new(error), edges, cells, told }
}
