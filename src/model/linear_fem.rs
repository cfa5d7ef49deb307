//! Linear elastic finite elements at small strain (METHODS A2, A13; paper 001, eq. 1-4).
//!
//! K u = f with u given at held nodes: K_ff u_f = f_f - K_fb u_b. Nodes that slide are written in a
//! frame whose first axis is their normal, so that every condition holds single unknowns.

use std::collections::BTreeMap;

use nalgebra::Matrix3;

use super::assembly::{InvertedCell, Tissue, rotate_into_frames};
use crate::boundary::Hold;
use crate::mesh::Vector;
use crate::solver::{self, BlockMatrix, LinearSystem, Solution, SolverError, Tolerance};

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
    /// Solves for each of several load cases, for which the tissue is assembled once.
    pub fn solve_cases(
        &self,
        cases: &[LoadCase],
        observer: &dyn Observer,
    ) -> Result<Vec<Equilibrium>, LinearFemError> {
        let one = |case: &LoadCase| {
            let mut holds = self.holds.to_vec();
            for (hold, values) in holds.iter_mut().zip(&case.held) {
                hold.set_values(values);
            }
            let tissue = Tissue { ..self.tissue };
            let problem = Problem { tissue, holds: &holds, forces: &case.forces, ..*self };
            problem.solve(observer)
        };
        cases.iter().map(one).collect()
    }

    /// Solves for equilibrium.
    pub fn solve(&self, observer: &dyn Observer) -> Result<Equilibrium, LinearFemError> {
        // 1. The matrix, with sliding nodes in their own frames.
        observer.assembling();
        let assembled = self.tissue.assemble(&|| !observer.is_stopped())?;
        let mut matrix = assembled.ok_or(SolverError::Stopped)?;
        rotate_into_frames(&mut matrix, self.holds);

        // 2. What is known, and the forces it leaves on the free unknowns.
        let held = self.held_unknowns();
        let known = self.known_displacement();
        let acting = self.acting_forces();
        let right_hand_side = right_hand_side(&matrix, &held, &known, &acting);

        // 3. The free unknowns.
        observer.solving();
        let axes = self.own_axes();
        let system = LinearSystem {
            matrix: &matrix,
            held: &held,
            right_hand_side: &right_hand_side,
            positions: &self.tissue.mesh.nodes,
            axes: &axes,
        };
        let watch = |iteration, residual| observer.iterated(iteration, residual);
        let solution = solver::solve(&system, &self.tolerance, &watch)?;

        // 4. Displacement and reactions, back in the frame of the coordinates.
        let total: Vec<f64> = known.iter().zip(&solution.unknowns).map(|(b, x)| b + x).collect();
        let mut internal = vec![0.0; total.len()];
        matrix.multiply(&total, &mut internal);
        let reactions = self.reactions(&internal, &acting);
        let displacement = self.to_coordinates(&total);
        if displacement.iter().any(|u| !u.iter().all(|value| value.is_finite())) {
            return Err(SolverError::NotFinite.into());
        }
        let unknowns = held.iter().filter(|held| !**held).count();
        Ok(Equilibrium { displacement, reactions, solution, unknowns })
    }

    /// True for unknowns along held axes, and for nodes without a cell, which nothing couples.
    fn held_unknowns(&self) -> Vec<bool> {
        let mut held = vec![true; 3 * self.forces.len()];
        for (_, nodes) in self.tissue.mesh.cells.iter() {
            for &node in nodes {
                held[3 * node as usize..3 * node as usize + 3].fill(false);
            }
        }
        for hold in self.holds {
            let first = 3 * hold.node as usize;
            held[first..first + hold.count()].fill(true);
        }
        held
    }

    fn own_axes(&self) -> BTreeMap<usize, Matrix3<f64>> {
        let turned = self.holds.iter().filter(|hold| !hold.is_aligned());
        turned.map(|hold| (hold.node as usize, *hold.axes())).collect()
    }

    fn known_displacement(&self) -> Vec<f64> {
        let mut known = vec![0.0; 3 * self.forces.len()];
        for hold in self.holds {
            let first = 3 * hold.node as usize;
            known[first..first + 3].copy_from_slice(hold.values().as_slice());
        }
        known
    }

    /// Nodal forces with those of sliding nodes in their frames.
    fn acting_forces(&self) -> Vec<f64> {
        let mut acting: Vec<f64> =
            self.forces.iter().flat_map(|force| [force.x, force.y, force.z]).collect();
        for hold in self.holds.iter().filter(|hold| !hold.is_aligned()) {
            let local = hold.axes().transpose() * self.forces[hold.node as usize];
            let first = 3 * hold.node as usize;
            acting[first..first + 3].copy_from_slice(local.as_slice());
        }
        acting
    }

    /// K u - f along the held axes of each hold.
    fn reactions(&self, internal: &[f64], acting: &[f64]) -> Vec<Vector> {
        self.holds
            .iter()
            .map(|hold| {
                let first = 3 * hold.node as usize;
                let local = Vector::from_fn(|k, _| match k < hold.count() {
                    true => internal[first + k] - acting[first + k],
                    false => 0.0,
                });
                hold.axes() * local
            })
            .collect()
    }

    fn to_coordinates(&self, total: &[f64]) -> Vec<Vector> {
        let mut displacement: Vec<Vector> =
            total.chunks_exact(3).map(Vector::from_column_slice).collect();
        for hold in self.holds.iter().filter(|hold| !hold.is_aligned()) {
            let local = displacement[hold.node as usize];
            displacement[hold.node as usize] = hold.axes() * local;
        }
        displacement
    }
}

/// f - K u_b of the free unknowns, zero for held ones.
fn right_hand_side(matrix: &BlockMatrix, held: &[bool], known: &[f64], acting: &[f64]) -> Vec<f64> {
    let mut result = vec![0.0; known.len()];
    matrix.multiply(known, &mut result);
    for (index, value) in result.iter_mut().enumerate() {
        *value = if held[index] { 0.0 } else { acting[index] - *value };
    }
    result
}
