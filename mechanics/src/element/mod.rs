//! Shape functions, their gradients and quadrature of one cell.
//!
//! x(xi) = sum_i N_i(xi) x_i, J = dx/dxi = sum_i x_i (dN_i/dxi)^T, grad N_i = J^-T dN_i/dxi.
//! Every rule integrates the stiffness of an undistorted cell exactly.

mod hexahedron8;
mod reference_cell;
pub mod tetrahedron10;
mod tetrahedron4;
mod wedge6;
use std::sync::LazyLock;

pub use reference_cell::{MAX_NODES, PhysicalPoint, ReferenceCell, ReferencePoint};

/// The four-node tetrahedron with one point.
pub fn tetrahedron4() -> &'static ReferenceCell {
    static CELL: LazyLock<ReferenceCell> = LazyLock::new(tetrahedron4::reference_cell);
    &CELL
}

/// The eight-node hexahedron with 2 x 2 x 2 Gauss points.
pub fn hexahedron8() -> &'static ReferenceCell {
    static CELL: LazyLock<ReferenceCell> = LazyLock::new(hexahedron8::reference_cell);
    &CELL
}

/// The six-node wedge with 3 points in the triangle times 2 Gauss points along its axis.
pub fn wedge6() -> &'static ReferenceCell {
    static CELL: LazyLock<ReferenceCell> = LazyLock::new(wedge6::reference_cell);
    &CELL
}

#[cfg(test)]
mod tests {
    use super::reference_cell::Vector;
    use super::*;

    fn every_cell() -> [(&'static str, &'static ReferenceCell, f64); 3] {
        [
            ("tet4", tetrahedron4(), 1.0 / 6.0),
            ("hex8", hexahedron8(), 8.0),
            ("wedge6", wedge6(), 1.0),
        ]
    }

    #[test]
    fn shape_functions_sum_to_one_and_their_gradients_to_zero() {
        for (name, cell, _) in every_cell() {
            for point in cell.points.iter().chain([&cell.centre]) {
                assert!((point.values.iter().sum::<f64>() - 1.0).abs() < 1e-15, "{name}");
                assert!(point.gradients.iter().sum::<Vector>().norm() < 1e-15, "{name}");
            }
        }
    }

    #[test]
    fn quadrature_weights_sum_to_the_reference_volume() {
        for (name, cell, volume) in every_cell() {
            let sum: f64 = cell.points.iter().map(|point| point.weight).sum();
            assert!((sum - volume).abs() < 1e-14, "{name}: {sum}");
            assert!((cell.centre.weight - volume).abs() < 1e-14, "{name}");
        }
    }

    #[test]
    fn a_mirrored_cell_has_no_physical_point() {
        let corners = [Vector::zeros(), Vector::y(), Vector::x(), Vector::z()];
        assert!(tetrahedron4().points[0].at(&corners).is_none());
    }
}
