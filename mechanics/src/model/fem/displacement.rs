//! Linear elastic finite elements at small strain (Zachow et al. 2006, eq. 1-4; docs/methods.md#linear-elasticity).
//!
//! K u = f with u given at held nodes: K_ff u_f = f_f - K_fb u_b. Nodes that slide are written in a
//! frame whose first axis is their normal, so that every condition holds single unknowns.

use rayon::prelude::*;

use super::assembly::Tissue;
use crate::boundary::Constraint;
use crate::mesh::Vector;
use crate::model::dofs::{
    Constrained, DofMap, PrescribedValues, nodes_of_cells, number, product_at_constraints,
};
use crate::model::problem::{Equilibrium, LoadCase, ModelError};
use crate::progress::{Phase, Progress};
use crate::solver::{Solution, SolverError, System, Tolerance, Unknowns};

/// A mechanical problem: tissue, what holds it and what acts on it.
pub struct Problem<'a> {
    pub tissue: Tissue<'a>,
    pub constraints: &'a [Constraint],
    /// For each node, in mN.
    pub forces: &'a [Vector],
    pub tolerance: Tolerance,
}

impl Problem<'_> {
    /// Solves for each of several load cases with a solver of the caller's choice, which is the end of the matrix.
    pub(super) fn solve_cases_by(
        &self,
        cases: &[LoadCase],
        progress: &dyn Progress,
        solve: SolveBy,
    ) -> Result<Vec<Equilibrium>, ModelError> {
        progress.phase(Phase::Assemble);
        let dof_map = self.dof_map();
        let matrix = self.tissue.assemble(&dof_map, progress)?.ok_or(SolverError::Stopped)?;
        let constrained = Constrained { constraints: self.constraints, dof_map: &dof_map };
        let system = constrained.system(matrix, &self.tissue.mesh.nodes);
        solve_displacement(&constrained, &system, cases, progress, solve)
    }

    /// Of the nodes of the mesh.
    pub(super) fn dof_map(&self) -> DofMap {
        let mesh = self.tissue.mesh;
        number(&nodes_of_cells(mesh), &mesh.nodes, self.constraints)
    }
}

/// How a system is solved for several right-hand sides.
pub(super) type SolveBy<'a> =
    &'a dyn Fn(&System, &[Unknowns]) -> Result<Vec<Solution>, SolverError>;

/// Solves for displacements alone, for each load case.
pub(super) fn solve_displacement(
    constrained: &Constrained,
    system: &System,
    cases: &[LoadCase],
    progress: &dyn Progress,
    solve: SolveBy,
) -> Result<Vec<Equilibrium>, ModelError> {
    // 1. What is known, and the forces it leaves on the free unknowns.
    progress.phase(Phase::Solve);
    let known: Vec<PrescribedValues> =
        cases.par_iter().map(|case| constrained.known(case)).collect();
    let right_hand_sides: Vec<Unknowns> =
        known.par_iter().map(|known| known.right_hand_side(system)).collect();

    // 2. The free unknowns.
    let solutions =
        solve(system, &right_hand_sides).map_err(|error| constrained.in_nodes(error))?;

    // 3. Displacement and reactions, back along the axes of the coordinates.
    let equilibrium = |(known, solution): (PrescribedValues, Solution)| {
        let total = known.total(&solution.unknowns);
        let internal = product_at_constraints(system, &total);
        Equilibrium {
            displacement: constrained.displacement(&total),
            reactions: constrained.reactions(&internal, &known.force),
            solver: solution.report,
            warnings: Vec::new(),
            states: Default::default(),
        }
    };
    let equilibria: Vec<Equilibrium> =
        known.into_par_iter().zip(solutions).map(equilibrium).collect();
    check_finite(&equilibria)?;
    Ok(equilibria)
}

/// No answer has a value that is not a number.
pub(in crate::model) fn check_finite<'a>(
    equilibria: impl IntoIterator<Item = &'a Equilibrium>,
) -> Result<(), SolverError> {
    let of = |e: &'a Equilibrium| e.displacement.iter().chain(&e.reactions);
    match equilibria.into_iter().flat_map(of).flatten().all(|value| value.is_finite()) {
        true => Ok(()),
        false => Err(SolverError::NotFinite),
    }
}
