//! Cell sizes of a mesh, by place.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::compare::document::PlaceDocument;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::{CornerPair, Sphere};
use mechanics::mesh::Vector;
use mechanics::meshing::{MeshingSettings, RegionShape, SizeField, SizeRegion};

/// Size of the mesh: an approximate number of tetrahedra, or a cell length; fine around segments, coarse far from them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshSizeDocument {
    /// Default: 300000, if no length is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1000, maximum = 4000000)]
    pub tetrahedra: Option<u64>,
    /// The edge of the finest cubes of the lattice, in mm; each has twelve tetrahedra.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 0.5, maximum = 50.0)]
    pub finest_mm: Option<f64>,
    /// The largest ratio of cell sizes, far from segments to near them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1.0, maximum = 16.0)]
    pub coarsening: Option<f64>,
    /// Places with cells as fine as around segments, in the `frame` of the document.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fine: Vec<PlaceDocument>,
}

/// The default.
const USUAL_TETRAHEDRA: u64 = 300_000;
/// Uniform at first: the estimate of the size of a mesh is best there.
const USUAL_COARSENING: f64 = 4.0;

impl MeshSizeDocument {
    /// `mirrored`: x and y change sign between the document and the meshed body.
    pub(super) fn to_settings(
        &self,
        at: &Pointer,
        mirrored: bool,
        limits: &Limits,
        faults: &mut Faults,
    ) -> MeshingSettings {
        let coarsening = self.coarsening.unwrap_or(USUAL_COARSENING);
        faults.check_range(&at.key("coarsening"), coarsening, 1.0..=16.0, "");
        let finest = self.finest_mm.unwrap_or(2.0);
        faults.check_range(&at.key("finest_mm"), finest, 0.5..=50.0, "mm");
        let tetrahedra = match (self.tetrahedra, self.finest_mm) {
            (None, None) => Some(USUAL_TETRAHEDRA),
            (tetrahedra, _) => tetrahedra,
        };
        if let Some(tetrahedra) = tetrahedra {
            let most = limits.mesh_cells as f64;
            faults.check_range(&at.key("tetrahedra"), tetrahedra as f64, 1e3..=most, "");
            faults.check_one_of(
                at,
                1 + usize::from(self.finest_mm.is_some()),
                "`tetrahedra`, `finest_mm`",
            );
        }
        let most = limits.list_entries as usize;
        faults.check_length(&at.key("fine"), self.fine.len(), most);
        for (number, place) in self.fine.iter().enumerate() {
            place.check(&at.key("fine").index(number), faults);
        }
        let fine = self.fine.iter().filter_map(|place| shape(place, mirrored));
        let regions = fine.map(|shape| SizeRegion { shape, size: finest }).collect();
        MeshingSettings {
            size: SizeField { regions, ..SizeField::graded(finest, finest * coarsening) },
            target: tetrahedra.map(|count| count as usize),
            most_tetrahedra: limits.mesh_cells as usize,
            ..MeshingSettings::default()
        }
    }
}

/// The part of space of a place.
fn shape(place: &PlaceDocument, mirrored: bool) -> Option<RegionShape> {
    let sign = if mirrored { -1.0 } else { 1.0 };
    let turned = |x: f64, y: f64, z: f64| Vector::new(sign * x, sign * y, z);
    let ball = place
        .sphere_mm
        .map(|Sphere([x, y, z, radius])| RegionShape::Ball { centre: turned(x, y, z), radius });
    ball.or_else(|| {
        let CornerPair([x0, y0, z0, x1, y1, z1]) = place.box_mm?;
        let (one, other) = (turned(x0, y0, z0), turned(x1, y1, z1));
        Some(RegionShape::Box { low: one.inf(&other), high: one.sup(&other) })
    })
}
