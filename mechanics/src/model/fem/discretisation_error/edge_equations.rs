//! The equation of each edge by itself.

use nalgebra::Matrix3;
use rayon::prelude::*;

use super::held_edges::HeldEdges;
use super::inner_modes::Modes;
use crate::mesh::Vector;

/// D b = r of one edge.
#[derive(Clone, Copy, Debug)]
pub(in crate::model::fem) struct EdgeEquation {
    pub residual: Vector,
    pub stiffness: Matrix3<f64>,
}

impl EdgeEquation {
    pub const ZERO: EdgeEquation = EdgeEquation {
        residual: Vector::new(0.0, 0.0, 0.0),
        stiffness: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    };
}

/// Those of all edges.
pub(super) struct EdgeEquations {
    pub residual: Vec<Vector>,
    pub stiffness: Vec<Matrix3<f64>>,
    /// What the inner modes of each cell do; empty where no cell has any.
    pub modes: Vec<Modes>,
}

impl EdgeEquations {
    pub fn zeros(count: usize) -> Self {
        EdgeEquations {
            residual: vec![Vector::zeros(); count],
            stiffness: vec![Matrix3::zeros(); count],
            modes: Vec::new(),
        }
    }

    pub fn add(&mut self, edge: usize, equation: &EdgeEquation) {
        self.residual[edge] += equation.residual;
        self.stiffness[edge] += equation.stiffness;
    }

    /// sum b . r.
    pub fn work(&self, steps: &[Vector]) -> f64 {
        self.residual.iter().zip(steps).map(|(r, b)| r.dot(b)).sum()
    }

    /// b = D^-1 r of every edge along the axes that nothing holds; zero where there is nothing to solve.
    pub fn steps(&self, held: &HeldEdges) -> Vec<Vector> {
        let numbered = self.residual.par_iter().zip(&self.stiffness).enumerate();
        numbered.map(|(edge, (r, d))| held.step(edge, r, d)).collect()
    }
}
