//! Stiffness of one linear elastic cell, in 3x3 blocks for each pair of its nodes.
//!
//! Full integration: K_jk = sum_q V_q [ lambda g_j g_k^T + mu g_k g_j^T + mu (g_j . g_k) I ], METHODS A2.
//!
//! Mean dilatation (B-bar; Hughes 1980; Simo, Taylor, Pister 1985): the volume change of each point is
//! replaced by its mean over the cell, tr eps -> (1/V) sum_q V_q div u, so that
//! K_jk = sum_q V_q mu [ g_k g_j^T + (g_j . g_k) I - 2/3 g_j g_k^T ] + K V gbar_j gbar_k^T
//! with K the bulk modulus and gbar_j = (1/V) sum_q V_q g_j. One volume change a cell does not lock
//! as nu goes to 1/2.

use nalgebra::Matrix3;

use super::reference_cell;
use crate::element::{MAX_NODES, PhysicalPoint};
use crate::material::LinearElastic;
use crate::mesh::{CellShape, Vector};
use crate::solver::Block;

/// How the volume change of a cell is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dilatation {
    /// At each quadrature point.
    Pointwise,
    /// As its mean over the cell; the same as pointwise for a tetrahedron with one point.
    Mean,
}

/// The blocks of a cell, row by row: `node_count`² of them, in kPa mm. `None` for a cell that is
/// inverted or flat at a quadrature point.
pub fn cell_stiffness(
    shape: CellShape,
    corners: &[Vector],
    material: &LinearElastic,
    dilatation: Dilatation,
) -> Option<Vec<Block>> {
    let reference = reference_cell(shape);
    let count = reference.node_count;
    let mut blocks = vec![Matrix3::zeros(); count * count];
    let mu = material.shear_modulus();
    let mut volume = 0.0;
    let mut mean_gradients = [Vector::zeros(); MAX_NODES];
    for point in &reference.points {
        let point = point.at(corners)?;
        volume += point.volume;
        for (mean, gradient) in mean_gradients.iter_mut().zip(&point.gradients) {
            *mean += gradient * point.volume;
        }
        let lambda = match dilatation {
            Dilatation::Pointwise => material.lambda(),
            Dilatation::Mean => -2.0 / 3.0 * mu,
        };
        add_point(&mut blocks, count, &point, lambda, mu);
    }
    if dilatation == Dilatation::Mean {
        let factor = material.bulk_modulus() / volume;
        for j in 0..count {
            for k in 0..count {
                blocks[j * count + k] += mean_gradients[j] * mean_gradients[k].transpose() * factor;
            }
        }
    }
    let rows =
        |block: &Matrix3<f64>| std::array::from_fn(|i| std::array::from_fn(|j| block[(i, j)]));
    Some(blocks.iter().map(rows).collect())
}

/// V [ lambda g_j g_k^T + mu g_k g_j^T + mu (g_j . g_k) I ] for all pairs of nodes.
fn add_point(
    blocks: &mut [Matrix3<f64>],
    count: usize,
    point: &PhysicalPoint,
    lambda: f64,
    mu: f64,
) {
    let (lambda, mu) = (lambda * point.volume, mu * point.volume);
    for j in 0..count {
        for k in 0..count {
            let (gj, gk) = (&point.gradients[j], &point.gradients[k]);
            let mut block = gj * gk.transpose() * lambda + gk * gj.transpose() * mu;
            let diagonal = mu * gj.dot(gk);
            for component in 0..3 {
                block[(component, component)] += diagonal;
            }
            blocks[j * count + k] += block;
        }
    }
}
