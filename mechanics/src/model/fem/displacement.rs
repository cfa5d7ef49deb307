//! Linear elastic finite elements at small strain (METHODS A2, A13; paper 001, eq. 1-4).
//!
//! K u = f with u given at held nodes: K_ff u_f = f_f - K_fb u_b. Nodes that slide are written in a
//! frame whose first axis is their normal, so that every condition holds single unknowns.

use rayon::prelude::*;

use super::assembly::Tissue;
use crate::boundary::Hold;
use crate::mesh::Vector;
use crate::model::dofs::nodes_of_cells;
use crate::model::dofs::{Constrained, Known, number, product_at_holds};
use crate::model::problem::{Equilibrium, LoadCase, ModelError};
use crate::progress::{Phase, Progress};
use crate::solver::half_matrix::HalfMatrix;
use crate::solver::{self, Solution, SolverError, System, Tolerance, Unknowns};

/// A mechanical problem: tissue, what holds it and what acts on it.
pub struct Problem<'a> {
    pub tissue: Tissue<'a>,
    pub holds: &'a [Hold],
    /// For each node, in mN.
    pub forces: &'a [Vector],
    pub tolerance: Tolerance,
}

impl Problem<'_> {
    /// Solves for equilibrium.
    pub fn solve(&self, progress: &dyn Progress) -> Result<Equilibrium, ModelError> {
        let held = self.holds.iter().map(|hold| *hold.values()).collect();
        let case = LoadCase { held, forces: self.forces.to_vec() };
        let mut equilibria = self.solve_cases(&[case], progress)?;
        Ok(equilibria.remove(0))
    }

    /// Solves for each of several load cases, for which the tissue is assembled once.
    pub fn solve_cases(
        &self,
        cases: &[LoadCase],
        progress: &dyn Progress,
    ) -> Result<Vec<Equilibrium>, ModelError> {
        self.solve_cases_by(cases, progress, &|system, right_hand_sides| {
            solver::solve(system, right_hand_sides, &self.tolerance, progress)
        })
    }

    /// The same with a solver of the caller's choice.
    pub(super) fn solve_cases_by(
        &self,
        cases: &[LoadCase],
        progress: &dyn Progress,
        solve: SolveBy,
    ) -> Result<Vec<Equilibrium>, ModelError> {
        progress.phase(Phase::Assemble);
        let mesh = self.tissue.mesh;
        let numbering = number(&nodes_of_cells(mesh), &mesh.nodes, self.holds);
        let assembled = self.tissue.assemble(&numbering, progress)?;
        let matrix = assembled.ok_or(SolverError::Stopped)?;
        let constrained = Constrained { holds: self.holds, numbering: &numbering };
        let positions = &mesh.nodes;
        let assembled = Assembled { constrained, matrix, positions };
        solve_displacement(assembled, cases, progress, solve)
    }
}

/// How a system is solved for several right-hand sides.
pub(super) type SolveBy<'a> =
    &'a dyn Fn(&System, &[Unknowns]) -> Result<Vec<Solution>, SolverError>;

/// A stiffness matrix over numbered nodes at positions.
pub(super) struct Assembled<'a> {
    pub constrained: Constrained<'a>,
    pub matrix: HalfMatrix<f64, 3>,
    pub positions: &'a [Vector],
}

/// Solves for displacements alone, for each load case.
pub(super) fn solve_displacement(
    assembled: Assembled,
    cases: &[LoadCase],
    progress: &dyn Progress,
    solve: SolveBy,
) -> Result<Vec<Equilibrium>, ModelError> {
    // 1. What is known, and the forces it leaves on the free unknowns.
    progress.phase(Phase::Solve);
    let Assembled { constrained, matrix, positions } = assembled;
    let system = constrained.system(matrix, positions);
    let known: Vec<Known> = cases.par_iter().map(|case| constrained.known(case)).collect();
    let right_hand_sides: Vec<Unknowns> =
        known.par_iter().map(|known| known.right_hand_side(&system)).collect();

    // 2. The free unknowns.
    let solutions =
        solve(&system, &right_hand_sides).map_err(|error| constrained.in_nodes(error))?;

    // 3. Displacement and reactions, back along the axes of the coordinates.
    let equilibrium = |(known, solution): (Known, Solution)| {
        let total = known.total(&solution.unknowns);
        let internal = product_at_holds(&system, &total);
        Equilibrium {
            displacement: constrained.displacement(&total),
            reactions: constrained.reactions(&internal, &known.force),
            solver: solution.report,
            warnings: Vec::new(),
        }
    };
    let equilibria: Vec<Equilibrium> =
        known.into_par_iter().zip(solutions).map(equilibrium).collect();
    check_finite(&equilibria)?;
    Ok(equilibria)
}

/// No answer has a value that is not a number.
pub(in crate::model) fn check_finite(equilibria: &[Equilibrium]) -> Result<(), SolverError> {
    let vectors = equilibria.iter().flat_map(|e| e.displacement.iter().chain(&e.reactions));
    match vectors.flatten().all(|value| value.is_finite()) {
        true => Ok(()),
        false => Err(SolverError::NotFinite),
    }
}
