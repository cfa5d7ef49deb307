//! Linear elastic finite elements at small strain (METHODS A2, A13; paper 001, eq. 1-4).
//!
//! K u = f with u given at held nodes: K_ff u_f = f_f - K_fb u_b. Nodes that slide are written in a
//! frame whose first axis is their normal, so that every condition holds single unknowns.

use rayon::prelude::*;

use super::assembly::{InvertedCell, Numbering, Tissue, partly_held, turn_into_axes};
use crate::boundary::Hold;
use crate::mesh::Vector;
use crate::solver::lanes::Lanes;
use crate::solver::{self, Solution, SolverError, System, Tolerance, Unknowns};

/// What the solution tells and asks while it runs.
pub trait Observer {
    fn assembling(&self);
    fn solving(&self);
    /// Whether to go on after an iteration with this relative residual.
    fn iterated(&self, iteration: usize, relative_residual: f64) -> bool;
    fn is_stopped(&self) -> bool;
}

/// A mechanical problem: tissue, what holds it and what acts on it.
pub struct Problem<'a> {
    pub tissue: Tissue<'a>,
    pub holds: &'a [Hold],
    /// For each node, in mN.
    pub forces: &'a [Vector],
    pub tolerance: Tolerance,
}

/// One of several things that happen to the same tissue.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadCase {
    /// For each hold its displacement in mm along its held axes, in its frame.
    pub held: Vec<Vector>,
    /// For each node, in mN.
    pub forces: Vec<Vector>,
}

/// Nodal displacement in mm, and for each hold the force in mN that it exerts on the tissue.
pub struct Equilibrium {
    pub displacement: Vec<Vector>,
    pub reactions: Vec<Vector>,
    pub solution: Solution,
    /// Unknowns that are not held.
    pub unknowns: usize,
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LinearFemError {
    #[error(transparent)]
    Inverted(#[from] InvertedCell),
    #[error(transparent)]
    Solver(#[from] SolverError),
}

impl Problem<'_> {
    /// Solves for equilibrium.
    pub fn solve(&self, observer: &dyn Observer) -> Result<Equilibrium, LinearFemError> {
        let held = self.holds.iter().map(|hold| *hold.values()).collect();
        let case = LoadCase { held, forces: self.forces.to_vec() };
        let mut equilibria = self.solve_cases(&[case], observer)?;
        Ok(equilibria.remove(0))
    }

    /// Solves for each of several load cases, for which the tissue is assembled once.
    pub fn solve_cases(
        &self,
        cases: &[LoadCase],
        observer: &dyn Observer,
    ) -> Result<Vec<Equilibrium>, LinearFemError> {
        // 1. The matrix, with sliding nodes along their own axes.
        observer.assembling();
        let numbering = Numbering::new(self.tissue.mesh, &self.held_nodes());
        let assembled = self.tissue.assemble(&numbering, &|| !observer.is_stopped())?;
        let mut matrix = assembled.ok_or(SolverError::Stopped)?;
        let partly_held = partly_held(self.holds, &numbering);
        turn_into_axes(&mut matrix, &partly_held);
        let mut positions = vec![Vector::zeros(); matrix.rows()];
        for (position, &row) in self.tissue.mesh.nodes.iter().zip(&numbering.layout.place) {
            positions[row as usize] = *position;
        }
        let layout = numbering.layout.clone();
        let system = System { layout, matrix, partly_held, positions };

        // 2. What is known, and the forces it leaves on the free unknowns.
        observer.solving();
        let known: Vec<Known> = cases.par_iter().map(|case| self.known(case, &numbering)).collect();
        let right_hand_sides: Vec<Unknowns> =
            known.par_iter().map(|known| known.right_hand_side(&system)).collect();

        // 3. The free unknowns.
        let watch = |iteration, residual| observer.iterated(iteration, residual);
        let solutions = solver::solve(&system, &right_hand_sides, &self.tolerance, &watch)
            .map_err(|error| in_nodes(error, &numbering))?;

        // 4. Displacement and reactions, back along the axes of the coordinates.
        let finished: Vec<Equilibrium> = known
            .into_par_iter()
            .zip(solutions)
            .map(|(known, solution)| self.equilibrium(known, solution, &system, &numbering))
            .collect();
        let displacements = finished.iter().flat_map(|equilibrium| &equilibrium.displacement);
        if displacements.flatten().any(|value| !value.is_finite()) {
            return Err(SolverError::NotFinite.into());
        }
        Ok(finished)
    }

    /// True for nodes held in all directions, and for nodes without a cell, which nothing couples.
    fn held_nodes(&self) -> Vec<bool> {
        let mut held = vec![true; self.tissue.mesh.nodes.len()];
        for (_, nodes) in self.tissue.mesh.cells.iter() {
            nodes.iter().for_each(|&node| held[node as usize] = false);
        }
        self.holds
            .iter()
            .filter(|hold| hold.count() == 3)
            .for_each(|hold| held[hold.node as usize] = true);
        held
    }

    fn known(&self, case: &LoadCase, numbering: &Numbering) -> Known {
        let rows = self.tissue.mesh.nodes.len();
        let mut known = Known { displacement: vec![[[0.0]; 3]; rows], force: vec![[0.0; 3]; rows] };
        for (force, &row) in case.forces.iter().zip(&numbering.layout.place) {
            known.force[row as usize] = (*force).into();
        }
        for (hold, values) in self.holds.iter().zip(&case.held) {
            let row = numbering.row(hold.node);
            known.displacement[row] =
                std::array::from_fn(|k| [if k < hold.count() { values[k] } else { 0.0 }]);
            if !hold.is_aligned() {
                let own = hold.axes().transpose() * case.forces[hold.node as usize];
                known.force[row] = own.into();
            }
        }
        known
    }

    fn equilibrium(
        &self,
        known: Known,
        solution: Solution,
        system: &System,
        numbering: &Numbering,
    ) -> Equilibrium {
        let Known { displacement: mut total, force } = known;
        for (total, unknowns) in total.iter_mut().zip(&solution.unknowns) {
            for (total, unknown) in total.iter_mut().zip(unknowns) {
                total[0] += unknown;
            }
        }
        let reactions = self.reactions(&total, &force, system, numbering);
        let mut displacement: Vec<Vector> = numbering
            .layout
            .place
            .iter()
            .map(|&row| Vector::from(total[row as usize].map(|[value]| value)))
            .collect();
        for hold in self.holds.iter().filter(|hold| !hold.is_aligned()) {
            let own = displacement[hold.node as usize];
            displacement[hold.node as usize] = hold.axes() * own;
        }
        let held: usize =
            system.partly_held.iter().flat_map(|row| row.held).filter(|held| *held).count();
        let unknowns = 3 * system.layout.free - held;
        Equilibrium { displacement, reactions, solution, unknowns }
    }

    /// K u - f along the held axes of each hold.
    fn reactions(
        &self,
        total: &[Lanes<f64, 3, 1>],
        force: &[[f64; 3]],
        system: &System,
        numbering: &Numbering,
    ) -> Vec<Vector> {
        let internal = product_at_holds(system, total);
        self.holds
            .iter()
            .map(|hold| {
                let row = numbering.row(hold.node);
                let own = Vector::from_fn(|k, _| match k < hold.count() {
                    true => internal[row][k][0] - force[row][k],
                    false => 0.0,
                });
                hold.axes() * own
            })
            .collect()
    }
}

/// What a load case states, by row, along the axes of the rows.
struct Known {
    /// Zero where free.
    displacement: Vec<Lanes<f64, 3, 1>>,
    force: Unknowns,
}

impl Known {
    /// f - K u_b of the free unknowns, zero for held ones.
    fn right_hand_side(&self, system: &System) -> Unknowns {
        let product = product_at_holds(system, &self.displacement);
        let mut result: Unknowns = self.force[..system.layout.free].to_vec();
        for (value, [x, y, z]) in result.iter_mut().zip(&product) {
            *value = [value[0] - x[0], value[1] - y[0], value[2] - z[0]];
        }
        for partly in &system.partly_held {
            for (value, _) in result[partly.row].iter_mut().zip(partly.held).filter(|(_, h)| *h) {
                *value = 0.0;
            }
        }
        result
    }
}

/// K x where it is of use: in the rows of held nodes, and what held nodes do to free ones. Partly held
/// nodes lie among the free ones, and with them every row counts.
fn product_at_holds(system: &System, x: &[Lanes<f64, 3, 1>]) -> Vec<Lanes<f64, 3, 1>> {
    let mut product = vec![[[0.0]; 3]; x.len()];
    let first = if system.partly_held.is_empty() { system.layout.free } else { 0 };
    system.matrix.add_rows(first..x.len(), x, &mut product);
    product
}

/// A row of the solver is a node of the mesh.
fn in_nodes(error: SolverError, numbering: &Numbering) -> SolverError {
    match error {
        SolverError::NotPositiveDefinite { row } => {
            let node = numbering.layout.place.iter().position(|&place| place as usize == row);
            SolverError::NotPositiveDefinite { row: node.unwrap_or(row) }
        }
        other => other,
    }
}
