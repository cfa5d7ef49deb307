//! A tetrahedron with functions on its edges, integrated in closed form, with its pressures where it has any.
//!
//! int grad phi_ij = V (g_i + g_j),   int grad phi_ij (x) grad phi_ij = 4 V / 5 (2 g_i g_i + 2 g_j g_j + g_i g_j + g_j g_i),
//! int L_k grad phi_ij = V/5 [ (1 + delta_ki) g_j + (1 + delta_kj) g_i ].

use nalgebra::Matrix3;

use super::edge_equations::EdgeEquation;
use super::edge_functions::MAX_EDGES;
use super::points::gradient_of;
use crate::element::MAX_NODES;
use crate::element::tetrahedron10::EDGES;
use crate::material::ElasticTensor;
use crate::mesh::{Vector, VolumeMesh};
use crate::model::fem::cell_stiffness::tetrahedron;
use crate::model::problem::InvertedCell;
use crate::solver::Block;

/// The pressures of the corners in kPa, and the shear modulus that stabilises them.
pub(super) struct CornerPressures {
    pub values: [f64; 4],
    pub mu: f64,
}

pub(super) struct Simplex {
    volume: f64,
    gradients: [Vector; 4],
    /// What no pressure carries.
    tensor: ElasticTensor,
    pressures: Option<CornerPressures>,
}

impl Simplex {
    pub fn new(
        mesh: &VolumeMesh,
        cell: usize,
        tensor: ElasticTensor,
        pressures: Option<CornerPressures>,
    ) -> Result<Self, InvertedCell> {
        let (volume, gradients) = tetrahedron(mesh, cell)?;
        Ok(Simplex { volume, gradients, tensor, pressures })
    }

    /// Writes r and D of each edge where the corners are displaced.
    pub fn equations(&self, displacement: &[Vector], equations: &mut [EdgeEquation; MAX_EDGES]) {
        let g = &self.gradients;
        let stress = self.tensor.stress(&gradient_of(displacement, g)) * self.volume;
        let squares = g.map(|g| g * g.transpose());
        for (equation, [i, j]) in equations.iter_mut().zip(EDGES) {
            equation.residual = -(stress * (g[i] + g[j]));
            equation.stiffness = self.stiffness([i, j], [&squares[i], &squares[j]]);
            if let Some(CornerPressures { values: p, .. }) = &self.pressures {
                let all: f64 = p.iter().sum();
                equation.residual -=
                    (g[j] * (all + p[i]) + g[i] * (all + p[j])) * (self.volume / 5.0);
            }
        }
    }

    /// D of the edge between two corners, g g^T of which are given.
    fn stiffness(&self, [i, j]: [usize; 2], squares: [&Matrix3<f64>; 2]) -> Matrix3<f64> {
        let (gi, gj) = (&self.gradients[i], &self.gradients[j]);
        let weight = 0.8 * self.volume;
        if self.tensor.fibre.is_none() {
            let sum = gi + gj;
            let g = squares[0] + squares[1] + sum * sum.transpose();
            let (lambda, mu) = (self.tensor.lambda * weight, self.tensor.mu * weight);
            return g * (lambda + mu) + Matrix3::from_diagonal_element(mu * g.trace());
        }
        let mut block: Block = [[0.0; 3]; 3];
        for (a, b, times) in [(gi, gi, 2.0), (gj, gj, 2.0), (gi, gj, 1.0), (gj, gi, 1.0)] {
            self.tensor.add_pair(&mut block, [a, b], times * weight);
        }
        Matrix3::from_fn(|r, c| block[r][c])
    }

    /// The forces on the corners of coefficients of the edges.
    pub fn forces(&self, of_edges: &[Vector; MAX_EDGES]) -> [Vector; MAX_NODES] {
        let g = &self.gradients;
        let slopes = EDGES.map(|[i, j]| g[i] + g[j]);
        let stress = self.tensor.stress(&gradient_of(&of_edges[..6], &slopes)) * self.volume;
        let mut forces = [Vector::zeros(); MAX_NODES];
        forces.iter_mut().zip(g).for_each(|(force, slope)| *force = stress * slope);
        forces
    }

    /// int L_k div b + (M - Mbar) p / mu of each corner, where the cell has pressures.
    pub fn volumes(&self, of_edges: &[Vector; MAX_EDGES]) -> Option<[f64; 4]> {
        let CornerPressures { values: p, mu } = self.pressures.as_ref()?;
        let (g, v) = (&self.gradients, self.volume);
        let all: f64 = p.iter().sum();
        let mut volumes = p.map(|own| (v / 20.0 * (all + own) - v / 16.0 * all) / mu);
        for (b, [i, j]) in of_edges.iter().zip(EDGES) {
            let (along_i, along_j) = (b.dot(&g[i]) * v / 5.0, b.dot(&g[j]) * v / 5.0);
            volumes.iter_mut().for_each(|volume| *volume += along_i + along_j);
            volumes[i] += along_j;
            volumes[j] += along_i;
        }
        Some(volumes)
    }
}
