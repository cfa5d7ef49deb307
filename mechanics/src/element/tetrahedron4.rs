//! Four-node tetrahedron: N = (1 - x - y - z, x, y, z) on the unit tetrahedron.

use super::reference_cell::Vector;
use super::{MAX_NODES, ReferenceCell, ReferencePoint};

pub(super) fn reference_cell() -> ReferenceCell {
    let mut values = [0.0; MAX_NODES];
    values[..4].fill(0.25);
    let mut gradients = [Vector::zeros(); MAX_NODES];
    gradients[..4].copy_from_slice(&[
        -(Vector::x() + Vector::y() + Vector::z()),
        Vector::x(),
        Vector::y(),
        Vector::z(),
    ]);
    let centre = ReferencePoint { weight: 1.0 / 6.0, values, gradients };
    ReferenceCell { node_count: 4, points: vec![centre.clone()], centre }
}
