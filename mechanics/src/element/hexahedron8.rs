//! Eight-node hexahedron: N_i = (1 + a_i x)(1 + b_i y)(1 + c_i z) / 8 on [-1, 1]^3.

use super::reference_cell::{GAUSS, Vector};
use super::{MAX_NODES, ReferenceCell, ReferencePoint};

const CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

pub(super) fn reference_cell() -> ReferenceCell {
    let points = CORNERS.iter().map(|corner| point(corner.map(|c| c * GAUSS), 1.0)).collect();
    ReferenceCell { node_count: 8, points, centre: point([0.0; 3], 8.0) }
}

fn point([x, y, z]: [f64; 3], weight: f64) -> ReferencePoint {
    let mut values = [0.0; MAX_NODES];
    let mut gradients = [Vector::zeros(); MAX_NODES];
    for (node, [a, b, c]) in CORNERS.into_iter().enumerate() {
        let (fx, fy, fz) = (1.0 + a * x, 1.0 + b * y, 1.0 + c * z);
        values[node] = fx * fy * fz / 8.0;
        gradients[node] = Vector::new(a * fy * fz, fx * b * fz, fx * fy * c) / 8.0;
    }
    ReferencePoint { weight, values, gradients }
}
