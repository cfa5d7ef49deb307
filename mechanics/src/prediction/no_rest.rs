//! Why tissue at finite strain finds no rest: bones that pass through each other.

use crate::boundary::tearing::turned_edges;
use crate::boundary::{Conditions, NodeClass};
use crate::mesh::VolumeMesh;
use crate::model::problem::ModelError;
use crate::solver::SolverError;

/// The error of a solution, with the edges of cells that its bones turn round, and names for what holds nodes.
pub(super) fn no_rest(
    error: ModelError,
    mesh: &VolumeMesh,
    conditions: &Conditions,
    name: impl Fn(NodeClass) -> String,
) -> ModelError {
    let finds_none = matches!(
        error,
        ModelError::Standstill { .. }
            | ModelError::ContactAlternates { .. }
            | ModelError::Solver(SolverError::NotConverged { .. })
    );
    let turned = || turned_edges(mesh, conditions);
    let Some(turned) = finds_none.then(turned).flatten() else { return error };
    let told = turned.told(name);
    let (edges, cells) = (turned.edges, turned.cells);
    ModelError::BonesPass { cause: Box::new(error), edges, cells, told }
}
