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

/// Poisson's ratio up to which hexahedra with mean dilatation are corrected by what is estimated of their error.
const CORRECTED_WELL: f64 = 0.43;

/// The share of cells in a mesh from which what they do counts. So many wedges lock, two changes of volume standing where a
/// hexahedron has one.
const MANY: f64 = 0.25;

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
            series.is_some_and(|law| law.volume_term().abs() > VOLUME_COUNTS)
        };
        let counts: Vec<bool> = self.materials.iter().map(counts).collect();
        let locks = |shape, material: usize| counts[material] && !self.is_pointwise(shape);
        let detail = format!(
            "have a law whose energy of volume is not that of ln J, and a Poisson ratio above {LOCKING}: their second order \
             takes it point by point, and may be several times too large"
        );
        self.warning_of(locks, &detail)
    }

    /// The warning of cells that lock.
    pub(super) fn locking(&self) -> Option<Warning> {
        if self.settings.method.properties().unknowns != Unknowns::Elements {
            return None;
        }
        let has_many_wedges = self.are_many(|shape, _| shape == CellShape::Wedge6);
        let locks = |shape, material: usize| {
            let is_quadratic =
                shape == CellShape::Tet4 && self.tetrahedron() == Tetrahedron::Quadratic;
            let shares = self.shares_volume(&self.materials[material]);
            let is_one_of_many = shape == CellShape::Wedge6 && has_many_wedges;
            !is_quadratic && (self.is_pointwise(shape) || !shares || is_one_of_many)
        };
        let detail = format!(
            "of plain elements, or wedges in a mesh with many, have a Poisson ratio above {LOCKING}: they lock, and the skin moves too little"
        );
        self.warning_of(locks, &detail)
    }

    /// Whether the estimated discretisation error, added to an answer, often leaves more than four fifths of it: with mean dilatation
    /// in wedges, and in hexahedra near the incompressible limit (docs/estimates.md, "What is taken").
    pub(super) fn correction_gains_little(&self) -> bool {
        let is_near = |own: &LinearElastic| own.poisson_ratio() > CORRECTED_WELL;
        let is_near: Vec<bool> = self.materials.iter().map(is_near).collect();
        let gains_little = |shape, material: usize| match shape {
            CellShape::Tet4 => false,
            CellShape::Wedge6 => !self.is_pointwise(shape),
            CellShape::Hex8 => is_near[material] && !self.is_pointwise(shape),
        };
        self.are_many(gains_little)
    }

    fn are_many(&self, counts: impl Fn(CellShape, usize) -> bool) -> bool {
        self.cells_that(counts) as f64 >= MANY * self.mesh.cells.len() as f64
    }

    /// How many cells count, by their shape and the number of their material.
    fn cells_that(&self, counts: impl Fn(CellShape, usize) -> bool) -> usize {
        let cells = self.mesh.cells.iter().zip(&self.material_of_cell);
        cells.filter(|((shape, _), own)| counts(*shape, usize::from(**own))).count()
    }

    /// Whether linear cells of a shape take volume point by point at first order.
    fn is_pointwise(&self, shape: CellShape) -> bool {
        match shape {
            CellShape::Tet4 => self.tetrahedron() == Tetrahedron::Plain,
            CellShape::Hex8 | CellShape::Wedge6 => {
                (self.tissue().dilatation)(shape) == Dilatation::Pointwise
            }
        }
    }

    /// The warning of those cells near the incompressible limit that lock, by shape and material.
    fn warning_of(
        &self,
        locks: impl Fn(CellShape, usize) -> bool,
        detail: &str,
    ) -> Option<Warning> {
        let ratios: Vec<f64> = self.materials.iter().map(LinearElastic::poisson_ratio).collect();
        let count = self.cells_that(|shape, own| ratios[own] > LOCKING && locks(shape, own));
        let largest = ratios.into_iter().fold(0.0, f64::max);
        let warning = || {
            Warning::new("locking", format!("{count} cells {detail}"))
                .with("cells", count as f64)
                .with("largest_poisson_ratio", largest)
        };
        (count > 0).then(warning)
    }
}
