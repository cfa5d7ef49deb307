//! Elements that lock as Poisson's ratio goes to 1/2.

use super::method::{MethodKind, Unknowns};
use super::scene::{Scene, Tetrahedron};
use crate::material::LinearElastic;
use crate::material::law_series::LawSeries;
use crate::mesh::{CellShape, Warning};
use crate::model::fem::cell_stiffness::Dilatation;

/// Poisson's ratio above which elements without mean dilatation are known to lock (docs/verification.md#v4,
/// docs/verification.md#v29).
const LOCKING: f64 = 0.45;

/// The volume term of a law's second order above which it counts at points.
const VOLUME_COUNTS: f64 = 5.0;

impl Scene {
    /// Whether elements that do not lock serve a tissue: any of linear elasticity, some of finite strain.
    pub(super) fn shares_volume(&self, tissue: &LinearElastic) -> bool {
        self.settings.method.kind() != MethodKind::FemNonlinear
            || tissue.hyperelastic().law.shares_volume()
    }

    /// The warning of cells that share volume at first order and at second order take it point by point, as their law has it.
    pub fn second_order_locking(&self) -> Option<Warning> {
        let counts = |material: &LinearElastic| {
            let series = material.stated_law().and_then(LawSeries::of);
            material.poisson_ratio() > LOCKING
                && series.is_some_and(|law| law.volume_term().abs() > VOLUME_COUNTS)
        };
        let counts: Vec<bool> = self.materials.iter().map(counts).collect();
        let dilatation = self.tissue().dilatation;
        let is_plain = |shape: CellShape| match shape {
            CellShape::Tet4 => self.tetrahedron() == Tetrahedron::Plain,
            CellShape::Hex8 | CellShape::Wedge6 => dilatation(shape) == Dilatation::Pointwise,
        };
        let cells = self.mesh.cells.iter().zip(&self.material_of_cell);
        let count = cells
            .filter(|((shape, _), material)| counts[usize::from(**material)] && !is_plain(*shape))
            .count();
        let detail = format!(
            "{count} cells have a law whose energy of volume is not that of ln J, and a Poisson ratio above {LOCKING}: their second order \
             takes it point by point, and may be several times too large"
        );
        let warning = Warning::new("locking", detail).with("cells", count as f64);
        let largest = self.materials.iter().map(LinearElastic::poisson_ratio).fold(0.0, f64::max);
        (count > 0).then(|| warning.with("largest_poisson_ratio", largest))
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
