//! A muscle on a mesh: the stress of its cells for each kPa with which it pulls.

use crate::model::fem::inner_stress::{CellStress, InnerStress};

/// A muscle, whether it pulls or not.
#[derive(Clone, Debug, PartialEq)]
pub struct MuscleField {
    pub name: String,
    /// w f (x) f of its cells, ascending.
    pub cells: Vec<CellStress>,
}

impl MuscleField {
    /// What it exerts in a mesh of so many cells when it pulls with `stress` in kPa.
    pub fn pulling(&self, cells: usize, stress: f64) -> InnerStress {
        let mut inner = InnerStress::default();
        inner.pull(cells, &self.cells, stress);
        inner
    }
}
