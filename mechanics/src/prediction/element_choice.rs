//! The choice of finite elements.

use super::listed::listed;
use crate::mesh::CellShape;

pub(super) const EVERY_SHAPE: &[CellShape] = &[CellShape::Tet4, CellShape::Hex8, CellShape::Wedge6];
pub(super) const TETRAHEDRA: &[CellShape] = &[CellShape::Tet4];

listed! {
    /// The element for tetrahedra and the treatment of volume change in the other cells.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum ElementChoice {
        /// The same as `Stabilised`: no element locks.
        #[default]
        Auto,
        /// Full integration for every shape; locks above a Poisson ratio of 0.45, with a warning.
        Plain,
        /// Mean dilatation for hex8 and wedge6, the plain element for tet4.
        MeanDilatation,
        /// Mean dilatation for hex8 and wedge6, displacement and stabilised pressure for tet4.
        Stabilised,
        /// Tetrahedra with a node in the middle of each edge; refused for other shapes.
        Quadratic,
    }
}

impl ElementChoice {
    /// As documents call it.
    pub fn name(self) -> &'static str {
        match self {
            ElementChoice::Auto => "auto",
            ElementChoice::Plain => "plain",
            ElementChoice::MeanDilatation => "mean_dilatation",
            ElementChoice::Stabilised => "stabilised",
            ElementChoice::Quadratic => "quadratic",
        }
    }

    /// The shapes of cells that it is made of.
    pub fn shapes(self) -> &'static [CellShape] {
        match self {
            ElementChoice::Quadratic => TETRAHEDRA,
            ElementChoice::Auto
            | ElementChoice::Plain
            | ElementChoice::MeanDilatation
            | ElementChoice::Stabilised => EVERY_SHAPE,
        }
    }
}
