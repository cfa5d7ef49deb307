//! Models: boundary conditions, materials and mesh in, nodal displacement out.

pub mod cell_state;
pub mod dofs;
pub mod fem;
pub mod mass_spring;
pub mod parts;
pub mod problem;
pub mod spline;
pub mod thickness_warp;

use crate::element::{self, ReferenceCell};
use crate::mesh::CellShape;

/// Shape functions and quadrature of a cell shape.
pub fn reference_cell(shape: CellShape) -> &'static ReferenceCell {
    match shape {
        CellShape::Tet4 => element::tetrahedron4(),
        CellShape::Hex8 => element::hexahedron8(),
        CellShape::Wedge6 => element::wedge6(),
    }
}
