//! Elements that lock as Poisson's ratio goes to 1/2.

use super::method::{MethodKind, Unknowns};
use super::scene::{Scene, Tetrahedron};
use crate::material::LinearElastic;
use crate::mesh::{CellShape, Warning};
use crate::model::fem::cell_stiffness::Dilatation;

/// Poisson's ratio above which elements without mean dilatation are known to lock (docs/verification.md#v4,
/// docs/verification.md#v29).
const LOCKING: f64 = 0.45;

impl Scene {
    /// Whether elements that do not lock serve a tissue: any of linear elasticity, some of finite strain.
    pub(super) fn shares_volume(&self, tissue: &LinearElastic) -> bool {
        self.settings.method.kind() != MethodKind::FemNonlinear
            || tissue.hyperelastic().law.shares_volume()
    }

    /// The warning of cells that lock.
    pub(super) fn locking(&self) -> Option<Warning> {
        let dilatation = self.tissue().dilatation;
        let cells = self.mesh.cells.iter().zip(&self.material_of_cell);
        let locks = |shape: CellShape, material: u16| {
            let nu = self.materials[material as usize].poisson_ratio();
            let tetrahedron = (shape == CellShape::Tet4).then(|| self.tetrahedron());
            let is_plain = tetrahedron.is_none_or(|own| own == Tetrahedron::Plain);
            let is_pointwise = is_plain && dilatation(shape) == Dilatation::Pointwise;
            nu > LOCKING
                && tetrahedron != Some(Tetrahedron::Quadratic)
                && (is_pointwise || !self.shares_volume(&self.materials[material as usize]))
        };
        let has_elements = self.settings.method.properties().unknowns == Unknowns::Elements;
        let locking = cells.filter(|((shape, _), material)| locks(*shape, **material)).count();
        let largest = self.materials.iter().map(LinearElastic::poisson_ratio).fold(0.0, f64::max);
        let detail = format!(
            "{locking} cells of plain elements have a Poisson ratio above {LOCKING}: they lock, and the skin moves too little"
        );
        let warning = Warning::new("locking", detail).with("cells", locking as f64);
        (locking > 0 && has_elements).then(|| warning.with("largest_poisson_ratio", largest))
    }
}
