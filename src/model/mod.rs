//! Ways of modelling: conditions, materials and mesh in, nodal displacement out.

pub mod assembly;
mod constrained;
pub mod equilibrium;
pub mod linear_fem;
pub mod load;
pub mod mass_spring;
pub mod mass_tensor;
pub mod membrane;
pub mod quadratic;
pub mod spline;
pub mod stabilised;
pub mod stiffness;
pub mod strain;
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
