//! Stiffness of one linear elastic cell, in 3x3 blocks for each pair of its nodes.
//!
//! Full integration: K_jk = sum_q V_q g_j.C.g_k, isotropic
//! K_jk = sum_q V_q [ lambda g_j g_k^T + mu g_k g_j^T + mu (g_j . g_k) I ] (docs/methods.md#linear-elasticity);
//! with fibres: `material::elastic_tensor`.
//!
//! Mean dilatation (B-bar; Hughes 1980; Simo, Taylor, Pister 1985): the volume change of each point is
//! replaced by its mean over the cell, eps -> dev eps + 1/3 (1/V sum_q V_q div u) 1, so that with
//! C = C_dev + C_vol (`ElasticTensor::split_volume`)
//! K_jk = sum_q V_q g_j.C_dev.g_k + V gbar_j.C_vol.gbar_k, gbar_j = (1/V) sum_q V_q g_j.
//! Isotropic, C_dev has lambda = -2/3 mu, and C_vol is the bulk modulus K alone. One volume change a hexahedron
//! does not lock as nu goes to 1/2; one a wedge does, two standing where a hexahedron has one.

use crate::element::MAX_NODES;
use crate::material::ElasticTensor;
use crate::mesh::{CellShape, Vector, VolumeMesh};
use crate::model::problem::InvertedCell;
use crate::model::reference_cell;
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
    tensor: &ElasticTensor,
    dilatation: Dilatation,
) -> Option<Vec<Block>> {
    let reference = reference_cell(shape);
    let count = reference.node_count;
    let mut blocks = vec![[[0.0; 3]; 3]; count * count];
    let (at_points, of_mean) = match dilatation {
        Dilatation::Pointwise => (*tensor, None),
        Dilatation::Mean => {
            let (of_shape, of_volume) = tensor.split_volume();
            (of_shape, Some(of_volume))
        }
    };
    let mut volume = 0.0;
    let mut mean_gradients = [Vector::zeros(); MAX_NODES];
    for point in &reference.points {
        let point = point.at(corners)?;
        volume += point.volume;
        for (mean, gradient) in mean_gradients.iter_mut().zip(&point.gradients) {
            *mean += gradient * point.volume;
        }
        for (entry, block) in blocks.iter_mut().enumerate() {
            let pair = [&point.gradients[entry / count], &point.gradients[entry % count]];
            at_points.add_pair(block, pair, point.volume);
        }
    }
    if let Some(of_volume) = of_mean {
        for (entry, block) in blocks.iter_mut().enumerate() {
            let pair = [&mean_gradients[entry / count], &mean_gradients[entry % count]];
            of_volume.add_pair(block, pair, 1.0 / volume);
        }
    }
    Some(blocks)
}

/// The volume of a tetrahedron in mm³ and the gradients of its barycentric coordinates in 1/mm.
pub(in crate::model) fn tetrahedron(
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
    let inverse = 1.0 / six_volumes;
    let (g1, g2, g3) = (normal * inverse, c.cross(&a) * inverse, a.cross(&b) * inverse);
    Ok((six_volumes / 6.0, [-(g1 + g2 + g3), g1, g2, g3]))
}
