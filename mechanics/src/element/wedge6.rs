//! Six-node wedge: linear on the unit triangle times linear on [-1, 1].

use super::reference_cell::{GAUSS, Vector};
use super::{MAX_NODES, ReferenceCell, ReferencePoint};

pub(super) fn reference_cell() -> ReferenceCell {
    let (near, far) = (1.0 / 6.0, 2.0 / 3.0);
    let points = [-GAUSS, GAUSS]
        .into_iter()
        .flat_map(|z| {
            [(near, near), (far, near), (near, far)].map(|(x, y)| point([x, y, z], 1.0 / 6.0))
        })
        .collect();
    ReferenceCell { node_count: 6, points, centre: point([1.0 / 3.0, 1.0 / 3.0, 0.0], 1.0) }
}

fn point([x, y, z]: [f64; 3], weight: f64) -> ReferencePoint {
    let triangle = [1.0 - x - y, x, y];
    let slopes = [(-1.0, -1.0), (1.0, 0.0), (0.0, 1.0)];
    let mut values = [0.0; MAX_NODES];
    let mut gradients = [Vector::zeros(); MAX_NODES];
    for (layer, sign) in [(0, -1.0), (1, 1.0)] {
        let along = (1.0 + sign * z) / 2.0;
        for (corner, (dx, dy)) in slopes.into_iter().enumerate() {
            values[3 * layer + corner] = triangle[corner] * along;
            gradients[3 * layer + corner] =
                Vector::new(dx * along, dy * along, triangle[corner] * sign / 2.0);
        }
    }
    ReferencePoint { weight, values, gradients }
}
