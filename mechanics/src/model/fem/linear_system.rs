//! Linear finite elements of first order, assembled once for any number of load cases and residuals: degree-of-freedom
//! map, matrices, and factor or preconditioner.

use rayon::prelude::*;

use super::displacement::{Problem, check_finite, solve_displacement};
use super::displacement_pressure::{PressureCells, check_memory, couple, shear_stiffness};
use crate::boundary::Constraint;
use crate::mesh::Vector;
use crate::model::dofs::{Constrained, DofMap, PrescribedValues, product_at_constraints};
use crate::model::problem::{Equilibrium, LoadCase, ModelError};
use crate::progress::{Phase, Progress};
use crate::solver::lanes::Lanes;
use crate::solver::mixed_system::{Coupling, MixedRightHandSide, MixedSolution, MixedSystem};
use crate::solver::preconditioned::Preconditioned;
use crate::solver::{Solver, SolverError, System, Tolerance, Unknowns, mixed};

/// K, for tetrahedra with pressures B and C beside it, and what was made to solve with them.
pub struct LinearSystem<'a> {
    pub constraints: &'a [Constraint],
    pub dof_map: DofMap,
    /// K; where there are pressures without what they carry.
    pub stiffness: System,
    pub pressures: Option<Pressures>,
    tolerance: Tolerance,
    solver: Solver,
}

/// The coupling of pressures to displacements, and the cells that have them.
pub struct Pressures {
    pub coupling: Coupling,
    pub cells: PressureCells,
}

impl Pressures {
    /// Adds int N_a 3 eps_g dV of each pressure: a quarter of what a cell grows by at each of its corners.
    fn add_grown(&self, grown: &[f64], volumes: &mut [[f64; 1]]) {
        for (&cell, numbers) in self.cells.cells.iter().zip(&self.cells.pressures) {
            let Some(grown) = grown.get(cell as usize) else { return };
            numbers.iter().for_each(|&number| volumes[number as usize][0] += grown / 4.0);
        }
    }
}

/// An equilibrium and the pressures p = lambda div u in kPa that belong to it, of tissue that grows p = lambda (div u - 3 eps_g);
/// none without pressures.
pub struct Solved {
    pub equilibrium: Equilibrium,
    pub pressures: Vec<f64>,
}

/// Residual of the equations of a solution.
#[derive(Clone, Debug, Default)]
pub struct Residual {
    /// For each node, in mN. What acts along held axes does nothing.
    pub forces: Vec<Vector>,
    /// For each pressure, in mm³; empty where nothing is left over of them.
    pub volumes: Vec<f64>,
}

/// Correction of a solution for a residual, with constraints kept.
pub struct Correction {
    /// For each node, in mm.
    pub displacement: Vec<Vector>,
    /// In kPa.
    pub pressures: Vec<f64>,
    pub iterations: usize,
    /// The remaining relative residual.
    pub relative_residual: f64,
}

impl Problem<'_> {
    /// Solves for equilibrium without pressures.
    pub fn solve(&self, progress: &dyn Progress) -> Result<Equilibrium, ModelError> {
        let held = self.constraints.iter().map(|constraint| *constraint.values()).collect();
        let case = LoadCase { held, forces: self.forces.to_vec(), ..LoadCase::default() };
        let mut equilibria = self.solve_cases(&[case], progress)?;
        Ok(equilibria.remove(0))
    }

    /// Solves for each of several load cases without pressures; the tissue is assembled once.
    pub fn solve_cases(
        &self,
        cases: &[LoadCase],
        progress: &dyn Progress,
    ) -> Result<Vec<Equilibrium>, ModelError> {
        let solved = LinearSystem::plain(self, progress)?.solve(cases, progress)?;
        Ok(solved.into_iter().map(|solved| solved.equilibrium).collect())
    }
}

impl<'a> LinearSystem<'a> {
    /// Displacements alone.
    pub fn plain(problem: &Problem<'a>, progress: &dyn Progress) -> Result<Self, ModelError> {
        progress.phase(Phase::Assemble);
        let dof_map = problem.dof_map();
        let matrix = problem.tissue.assemble(&dof_map, progress)?.ok_or(SolverError::Stopped)?;
        let constrained = Constrained { constraints: problem.constraints, dof_map: &dof_map };
        let stiffness = constrained.system(matrix, &problem.tissue.mesh.nodes);
        Ok(LinearSystem::of(problem, dof_map, stiffness, None))
    }

    /// Displacements, and the pressures of tetrahedra.
    pub fn mixed(problem: &Problem<'a>, progress: &dyn Progress) -> Result<Self, ModelError> {
        progress.phase(Phase::Assemble);
        let tissue = &problem.tissue;
        let dof_map = problem.dof_map();
        let constrained = Constrained { constraints: problem.constraints, dof_map: &dof_map };
        let assembled = shear_stiffness(tissue, &dof_map, progress)?;
        let matrix = assembled.ok_or(SolverError::Stopped)?;
        let stiffness = constrained.system(matrix, &tissue.mesh.nodes);
        let cells = PressureCells::new(tissue, &dof_map);
        let coupling = couple(tissue, &constrained, &cells)?;
        check_memory(&stiffness, &coupling, problem.tolerance.memory_mb)?;
        let pressures = Pressures { coupling, cells };
        Ok(LinearSystem::of(problem, dof_map, stiffness, Some(pressures)))
    }

    fn of(
        problem: &Problem<'a>,
        dof_map: DofMap,
        stiffness: System,
        pressures: Option<Pressures>,
    ) -> Self {
        let Problem { constraints, tolerance, .. } = *problem;
        LinearSystem {
            constraints,
            dof_map,
            stiffness,
            pressures,
            tolerance,
            solver: Solver::default(),
        }
    }

    /// Solves for each load case.
    pub fn solve(
        &self,
        cases: &[LoadCase],
        progress: &dyn Progress,
    ) -> Result<Vec<Solved>, ModelError> {
        let Some(pressures) = &self.pressures else {
            let solve = |system: &System, sides: &[Unknowns]| {
                self.solver.solve(system, sides, &self.tolerance, progress)
            };
            let (constrained, system) = (self.constrained(), &self.stiffness);
            let solved = solve_displacement(&constrained, system, cases, progress, &solve)?;
            let without = |equilibrium| Solved { equilibrium, pressures: Vec::new() };
            return Ok(solved.into_iter().map(without).collect());
        };
        self.solve_mixed(pressures, cases, progress)
    }

    /// Displacements and pressures for each load case.
    fn solve_mixed(
        &self,
        pressures: &Pressures,
        cases: &[LoadCase],
        progress: &dyn Progress,
    ) -> Result<Vec<Solved>, ModelError> {
        let coupling = &pressures.coupling;
        // 1. What is known, and what it leaves to the free unknowns.
        progress.phase(Phase::Solve);
        let (constrained, stiffness) = (self.constrained(), &self.stiffness);
        let known: Vec<PrescribedValues> =
            cases.par_iter().map(|case| constrained.known(case)).collect();
        let side = |(known, case): (&PrescribedValues, &LoadCase)| {
            let mut volumes = vec![[0.0]; coupling.mass.len()];
            coupling.divergence.contract(&known.displacement, &mut volumes);
            volumes.iter_mut().for_each(|[volume]| *volume = -*volume);
            pressures.add_grown(&case.grown, &mut volumes);
            MixedRightHandSide { forces: known.right_hand_side(stiffness), volumes }
        };
        let right_hand_sides: Vec<MixedRightHandSide> =
            known.par_iter().zip(cases).map(side).collect();

        // 2. The free displacements and the pressures.
        let system = MixedSystem { stiffness, coupling, solver: &self.solver };
        let solutions = mixed::solve(&system, &right_hand_sides, &self.tolerance, progress)?;

        // 3. Displacement and reactions, back along the axes of the coordinates.
        let solved = |(known, mixed): (PrescribedValues, MixedSolution)| {
            let total = known.total(&mixed.solution.unknowns);
            let internal = self.internal_at_constraints(&total, &mixed.pressures);
            let equilibrium = Equilibrium {
                displacement: constrained.displacement(&total),
                reactions: constrained.reactions(&internal, &known.force),
                solver: mixed.solution.report,
                warnings: Vec::new(),
                states: Default::default(),
            };
            Solved { equilibrium, pressures: mixed.pressures.into_flattened() }
        };
        let solved: Vec<Solved> = known.into_par_iter().zip(solutions).map(solved).collect();
        check_finite(solved.iter().map(|solved| &solved.equilibrium))?;
        Ok(solved)
    }

    /// What each residual changes, to a relative residual that may be as loose as 0.1; where less is reached, what
    /// was found until then. Eight residuals are solved for together.
    pub fn solve_for(
        &self,
        residuals: &[Residual],
        relative_residual: f64,
        progress: &dyn Progress,
    ) -> Result<Vec<Correction>, ModelError> {
        let (constrained, stiffness) = (self.constrained(), &self.stiffness);
        let forces = |residual: &Residual| constrained.free_forces(stiffness, &residual.forces);
        let solutions: Vec<MixedSolution> = match &self.pressures {
            Some(Pressures { coupling, .. }) => {
                let side = |residual: &Residual| {
                    let mut volumes = residual.volumes.clone();
                    volumes.resize(coupling.mass.len(), 0.0);
                    let volumes = volumes.into_iter().map(|volume| [volume]).collect();
                    MixedRightHandSide { forces: forces(residual), volumes }
                };
                let sides: Vec<MixedRightHandSide> = residuals.par_iter().map(side).collect();
                let system = MixedSystem { stiffness, coupling, solver: &self.solver };
                mixed::solve_best_effort(&system, &sides, relative_residual, progress)?
            }
            None => {
                let sides: Vec<Unknowns> = residuals.par_iter().map(forces).collect();
                let loose =
                    self.solver.solve_best_effort(stiffness, &sides, relative_residual, progress);
                let solved = loose.map_err(|error| constrained.in_nodes(error))?;
                let without = |solution| MixedSolution { solution, pressures: Vec::new() };
                solved.into_iter().map(without).collect()
            }
        };
        Ok(solutions.into_par_iter().map(|mixed| self.mixed_correction(mixed)).collect())
    }

    /// Reaction forces of constraints on tissue that a correction displaces, with internal forces in mN at each node
    /// beside those of K.
    pub fn reactions(&self, correction: &Correction, beside: &[Vector]) -> Vec<Vector> {
        let constrained = self.constrained();
        let held = vec![Vector::zeros(); self.constraints.len()];
        let known = constrained.known(&LoadCase {
            held,
            forces: beside.iter().map(|force| -force).collect(),
            ..LoadCase::default()
        });
        let mut total: Vec<[[f64; 1]; 3]> = self
            .dof_map
            .by_row(&correction.displacement)
            .iter()
            .map(|u| [[u.x], [u.y], [u.z]])
            .collect();
        for constraint in self.constraints.iter().filter(|constraint| !constraint.is_aligned()) {
            let own =
                constraint.axes().transpose() * correction.displacement[constraint.node as usize];
            total[self.dof_map.row(constraint.node)] = [[own.x], [own.y], [own.z]];
        }
        let mut internal = product_at_constraints(&self.stiffness, &total);
        if let Some(Pressures { coupling, .. }) = &self.pressures {
            let pressures: Vec<[f64; 1]> = correction.pressures.iter().map(|&p| [p]).collect();
            coupling.gradient.add_expanded(&pressures, &mut internal);
        }
        constrained.reactions(&internal, &known.force)
    }

    fn mixed_correction(&self, mixed: MixedSolution) -> Correction {
        let MixedSolution { solution, pressures } = mixed;
        let unknowns = solution.unknowns.into_flattened().into_iter().map(|value| [value]);
        let found: Vec<[f64; 1]> = unknowns.chain(pressures).collect();
        let report = &solution.report;
        self.correction(&found, report.iterations, report.relative_residual)
    }

    /// A correction of its unknowns, three for each free row and then the pressures.
    pub(super) fn correction(
        &self,
        found: &[[f64; 1]],
        iterations: usize,
        relative_residual: f64,
    ) -> Correction {
        let (_, pressures) = found.split_at(3 * self.stiffness.ordering.free);
        Correction {
            displacement: self.constrained().displacement(&self.stiffness.by_row(found)),
            pressures: pressures.as_flattened().to_vec(),
            iterations,
            relative_residual,
        }
    }

    /// A negated residual, in the order and with the weights of `preconditioned`.
    pub(super) fn negated(&self, residual: &Residual) -> Vec<[f64; 1]> {
        let forces = self.constrained().free_forces(&self.stiffness, &residual.forces);
        let mut volumes = residual.volumes.clone();
        if let Some(own) = &self.pressures {
            let weights = own.coupling.weights();
            volumes.resize(weights.len(), 0.0);
            volumes.iter_mut().zip(&weights).for_each(|(volume, weight)| *volume *= weight);
        }
        forces.into_flattened().into_iter().chain(volumes).map(|value| [-value]).collect()
    }

    /// Memory of matrices, hierarchy and vectors, in MB.
    pub fn megabytes(&self) -> f64 {
        match &self.pressures {
            Some(Pressures { coupling, .. }) => mixed::megabytes(&self.stiffness, coupling),
            None => self.stiffness.megabytes(),
        }
    }

    /// The matrix with what approximates its inverse.
    pub(super) fn preconditioned(
        &self,
        progress: &dyn Progress,
    ) -> Result<Preconditioned<'_>, SolverError> {
        let coupling = self.pressures.as_ref().map(|pressures| &pressures.coupling);
        let multigrid = self.solver.hierarchy(&self.stiffness, progress)?;
        Ok(Preconditioned::new(&self.stiffness, coupling, multigrid))
    }

    /// Internal forces of displacements and pressures by row, where something is held.
    pub(super) fn internal_at_constraints(
        &self,
        total: &[Lanes<f64, 3, 1>],
        pressures: &[[f64; 1]],
    ) -> Vec<Lanes<f64, 3, 1>> {
        let mut internal = product_at_constraints(&self.stiffness, total);
        if let Some(own) = &self.pressures {
            own.coupling.gradient.add_expanded(pressures, &mut internal);
        }
        internal
    }

    pub(super) fn solver(&self) -> &Solver {
        &self.solver
    }

    pub(super) fn constrained(&self) -> Constrained<'_> {
        Constrained { constraints: self.constraints, dof_map: &self.dof_map }
    }
}
