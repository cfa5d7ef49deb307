//! Quadratic functions of the edges of a cell, zero at its corners and one in the middle of their edge.
//!
//! phi_ij = 4 N_i N_j / S, S the sum of the shape functions of the corners that the edge shares its direction with: all four
//! of a tetrahedron, the three of its triangle for an edge in the triangle of a wedge, its two ends otherwise. On a tetrahedron
//! 4 L_i L_j, on a hexahedron (1 - x²)(1 + b y)(1 + c z) / 4, on a wedge 4 L_i L_j (1 + c z) / 2 and L_i (1 - z²). With the
//! shape functions of the corners they span the serendipity element, and agree where cells of different shapes meet.

use std::sync::LazyLock;

use crate::element::MAX_NODES;
use crate::mesh::{CellShape, Vector};
use crate::model::reference_cell;

/// The most edges a cell has.
pub(in crate::model::fem) const MAX_EDGES: usize = 12;

/// Values and gradients at one point, in the order of the edges of the shape.
pub(in crate::model::fem) struct AtPoint {
    pub values: [f64; MAX_EDGES],
    pub gradients: [Vector; MAX_EDGES],
}

/// Values of the shape functions of the corners at a point, and their gradients.
pub(in crate::model::fem) struct Corners<'a> {
    pub values: &'a [f64; MAX_NODES],
    pub gradients: &'a [Vector; MAX_NODES],
}

/// The functions of all edges at a point inside a cell.
pub(in crate::model::fem) fn at_point(shape: CellShape, corners: &Corners) -> AtPoint {
    let mut all = AtPoint { values: [0.0; MAX_EDGES], gradients: [Vector::zeros(); MAX_EDGES] };
    for (number, ends) in shape.edges().iter().enumerate() {
        let &[i, j] = ends;
        let (n, g) = (corners.values, corners.gradients);
        let (mut sum, mut slope) = (0.0, Vector::zeros());
        for &k in shares(shape, ends) {
            sum += n[k];
            slope += g[k];
        }
        let product = n[i] * n[j];
        all.values[number] = 4.0 * product / sum;
        all.gradients[number] =
            ((g[i] * n[j] + g[j] * n[i]) - slope * (product / sum)) * (4.0 / sum);
    }
    all
}

/// The functions of all edges at the quadrature points of a reference cell.
pub(super) fn reference_edges(shape: CellShape) -> &'static [AtPoint] {
    static OF_SHAPES: LazyLock<[Vec<AtPoint>; 3]> = LazyLock::new(|| {
        [CellShape::Tet4, CellShape::Hex8, CellShape::Wedge6].map(|shape| {
            let corners = reference_cell(shape)
                .points
                .iter()
                .map(|point| Corners { values: &point.values, gradients: &point.gradients });
            corners.map(|corners| at_point(shape, &corners)).collect()
        })
    });
    let [of_tetrahedra, of_hexahedra, of_wedges] = &*OF_SHAPES;
    match shape {
        CellShape::Tet4 => of_tetrahedra,
        CellShape::Hex8 => of_hexahedra,
        CellShape::Wedge6 => of_wedges,
    }
}

/// The corners whose shape functions make S.
fn shares(shape: CellShape, ends: &'static [usize; 2]) -> &'static [usize] {
    match shape {
        CellShape::Tet4 => &[0, 1, 2, 3],
        CellShape::Hex8 => ends,
        CellShape::Wedge6 => match ends.map(|corner| corner < 3) {
            [true, true] => &[0, 1, 2],
            [false, false] => &[3, 4, 5],
            [true, false] | [false, true] => ends,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::VolumeMesh;
    use crate::mesh::sample::block;

    fn cell(shape: CellShape) -> VolumeMesh {
        block(Vector::new(2.0, 2.0, 2.0), [1, 1, 1], shape)
    }

    #[test]
    fn corner_and_edge_functions_show_every_quadratic_field_and_its_gradient() {
        // f = x² + 2 x y - z² + y z: the edge coefficient is f in the middle less the mean of the ends.
        let f = |x: &Vector| x.x * x.x + 2.0 * x.x * x.y - x.z * x.z + x.y * x.z;
        let slope =
            |x: &Vector| Vector::new(2.0 * x.x + 2.0 * x.y, 2.0 * x.x + x.z, -2.0 * x.z + x.y);
        for shape in [CellShape::Tet4, CellShape::Hex8, CellShape::Wedge6] {
            let mesh = cell(shape);
            let corners: Vec<Vector> = mesh.corners(0).collect();
            for reference in &reference_cell(shape).points {
                let point = reference.at(&corners).unwrap();
                let (values, gradients) = (&reference.values, &point.gradients);
                let edge = at_point(shape, &Corners { values, gradients });
                let (mut x, mut value, mut gradient) = (Vector::zeros(), 0.0, Vector::zeros());
                for (a, corner) in corners.iter().enumerate() {
                    x += corner * values[a];
                    value += f(corner) * values[a];
                    gradient += gradients[a] * f(corner);
                }
                for (number, &[i, j]) in shape.edges().iter().enumerate() {
                    let middle = f(&((corners[i] + corners[j]) * 0.5));
                    let b = middle - 0.5 * (f(&corners[i]) + f(&corners[j]));
                    value += b * edge.values[number];
                    gradient += edge.gradients[number] * b;
                }
                assert!((value - f(&x)).abs() < 1e-14, "{shape:?} {value} {}", f(&x));
                assert!((gradient - slope(&x)).norm() < 1e-13, "{shape:?}");
            }
        }
    }
}
