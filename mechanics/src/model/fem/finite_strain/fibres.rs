//! The course of fibres through the cells of a mesh.

use crate::material::hyperelastic::Fibres;
use crate::material::hyperelastic::point::FibreAtPoint;
use crate::mesh::Vector;

/// Fibres that only pull: those of each law, and for each cell their direction at rest, of length 1 or zero where it has none.
/// Empty where there are none.
#[derive(Clone, Copy, Debug, Default)]
pub struct FibreField<'a> {
    pub of_law: &'a [Option<Fibres>],
    pub of_cell: &'a [Vector],
}

impl<'a> FibreField<'a> {
    /// Those of a cell of a law.
    #[inline]
    pub fn along(&self, law: u16, cell: usize) -> Option<FibreAtPoint<'a>> {
        let law = self.of_law.get(usize::from(law))?.as_ref()?;
        let direction = *self.of_cell.get(cell)?;
        (direction != Vector::zeros()).then_some(FibreAtPoint { law, direction })
    }
}
