//! A system of displacements and pressures: its matrices, right-hand sides and solutions.

use super::choice::Solver;
use super::sparse_rows::SparseRows;
use super::system::{Solution, System, Unknowns};

/// K u + B^T p and B u - C p for the free displacements u and all pressures p.
pub struct MixedSystem<'a> {
    /// K.
    pub stiffness: &'a System,
    pub coupling: &'a Coupling,
    /// Keeps the hierarchy of K.
    pub solver: &'a Solver,
}

impl MixedSystem<'_> {
    pub(super) fn free_unknowns(&self) -> usize {
        self.stiffness.free_unknowns() + self.coupling.mass.len()
    }
}

/// f and h.
#[derive(Clone, Debug)]
pub struct MixedRightHandSide {
    pub forces: Unknowns,
    /// One for each pressure.
    pub volumes: Vec<[f64; 1]>,
}

/// The displacements as a solution, and the pressures.
#[derive(Clone, Debug)]
pub struct MixedSolution {
    pub solution: Solution,
    pub pressures: Vec<[f64; 1]>,
}

/// The coupling of pressures to displacements and to each other.
pub struct Coupling {
    /// B: a row for each pressure, a column for each row of K.
    pub divergence: SparseRows<[f64; 3]>,
    /// B^T.
    pub gradient: SparseRows<[f64; 3]>,
    /// C.
    pub compliance: SparseRows<f64>,
    /// D.
    pub mass: Vec<f64>,
}

impl Coupling {
    /// W of each pressure, |B_i| / D_i: it turns a volume that is left over into the forces that its pressure would put on the
    /// nodes around it.
    pub fn weights(&self) -> Vec<f64> {
        let length = |row: usize| -> f64 {
            let squares = self.divergence.row(row).flat_map(|(_, b)| b.map(|b| b * b));
            squares.sum::<f64>().sqrt()
        };
        let mass = self.mass.iter().enumerate();
        mass.map(|(row, mass)| length(row) / mass).collect()
    }

    /// Memory in MB.
    pub fn megabytes(&self) -> f64 {
        let vectors = self.divergence.megabytes() + self.gradient.megabytes();
        vectors + self.compliance.megabytes() + 8e-6 * self.mass.len() as f64
    }
}
