//! Stiffness of one linear elastic cell, in 3x3 blocks for each pair of its nodes.
//!
//! Full integration: K_jk = sum_q V_q [ lambda g_j g_k^T + mu g_k g_j^T + mu (g_j . g_k) I ], METHODS A2.
//!
//! Mean dilatation (B-bar; Hughes 1980; Simo, Taylor, Pister 1985): the volume change of each point is
//! replaced by its mean over the cell, tr eps -> (1/V) sum_q V_q div u, so that
//! K_jk = sum_q V_q mu [ g_k g_j^T + (g_j . g_k) I - 2/3 g_j g_k^T ] + K V gbar_j gbar_k^T
//! with K the bulk modulus and gbar_j = (1/V) sum_q V_q g_j. One volume change a cell does not lock
//! as nu goes to 1/2.

use super::assembly::InvertedCell;
use super::reference_cell;
use crate::element::MAX_NODES;
use crate::material::LinearElastic;
use crate::mesh::{CellShape, Vector, VolumeMesh};
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
    let mut blocks = vec![[[0.0; 3]; 3]; count * count];
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
        let (lambda, mu) = (lambda * point.volume, mu * point.volume);
        for (entry, block) in blocks.iter_mut().enumerate() {
            let pair = [&point.gradients[entry / count], &point.gradients[entry % count]];
            add_pair(block, pair, lambda, mu);
        }
    }
    if dilatation == Dilatation::Mean {
        let factor = material.bulk_modulus() / volume;
        for (entry, block) in blocks.iter_mut().enumerate() {
            let (gj, gk) = (&mean_gradients[entry / count], &mean_gradients[entry % count]);
            for (r, row) in block.iter_mut().enumerate() {
                row.iter_mut().zip(gk).for_each(|(value, gk)| *value += gj[r] * gk * factor);
            }
        }
    }
    Some(blocks)
}

/// block += lambda g_j g_k^T + mu g_k g_j^T + mu (g_j . g_k) I, with moduli times the volume of a point
/// (METHODS A2).
#[inline]
pub(super) fn add_pair(block: &mut Block, [gj, gk]: [&Vector; 2], lambda: f64, mu: f64) {
    let diagonal = mu * gj.dot(gk);
    for (r, row) in block.iter_mut().enumerate() {
        for (c, value) in row.iter_mut().enumerate() {
            *value += lambda * gj[r] * gk[c] + mu * gk[r] * gj[c];
        }
        row[r] += diagonal;
    }
}

/// The volume of a tetrahedron in mm³ and the gradients of its barycentric coordinates in 1/mm.
pub(super) fn tetrahedron(
    mesh: &VolumeMesh,
    cell: usize,
) -> Result<(f64, [Vector; 4]), InvertedCell> {
    let nodes = mesh.cells.nodes(cell);
    let side = |k: usize| mesh.nodes[nodes[k] as usize] - mesh.nodes[nodes[0] as usize];
    let (a, b, c) = (side(1), side(2), side(3));
    let normal = b.cross(&c);
    let six_volumes = a.dot(&normal);
    if six_volumes.is_nan() || six_volumes <= 0.0 {
        return Err(InvertedCell { cell });
    }
    let (g1, g2, g3) = (normal / six_volumes, c.cross(&a) / six_volumes, a.cross(&b) / six_volumes);
    Ok((six_volumes / 6.0, [-(g1 + g2 + g3), g1, g2, g3]))
}
