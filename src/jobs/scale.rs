//! Scale of a mesh: whether its size in its unit is plausible for a head or a part of one.

use super::source::StoredShape;
use crate::schema::ErrorCode;
use crate::schema::Problem;
use crate::schema::case::document::LengthUnit;
use mechanics::mesh::Warning;

/// Diagonals of the bounding boxes of heads and their parts, in mm.
const USUAL_DIAGONAL_MM: std::ops::RangeInclusive<f64> = 50.0..=600.0;
/// Beyond these the unit is wrong, unless any scale is permitted.
const POSSIBLE_DIAGONAL_MM: std::ops::RangeInclusive<f64> = 5.0..=5000.0;

/// The diagonal of the bounding box of a mesh, in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshSize {
    pub diagonal: f64,
    pub units: LengthUnit,
}

impl MeshSize {
    /// The size of a mesh that was read; an image is in mm.
    pub fn of(shape: &StoredShape, units: LengthUnit) -> Self {
        let ((low, high), units) = match shape {
            StoredShape::Volume(volume) => (volume.bounds().into(), units),
            StoredShape::Surface(surface) => (surface.bounds(), units),
            StoredShape::Image(image) => (image.bounds(), LengthUnit::Mm),
        };
        MeshSize { diagonal: (high - low).norm(), units }
    }

    /// Refuses a size that no head has, unless any scale is permitted; a warning if it is unusual.
    pub fn check(self, allow_any_scale: bool) -> Result<Option<Warning>, Problem> {
        let diagonal_mm = self.diagonal * self.units.in_mm();
        if USUAL_DIAGONAL_MM.contains(&diagonal_mm) {
            return Ok(None);
        }
        let fits = |unit: &LengthUnit| {
            *unit != self.units && USUAL_DIAGONAL_MM.contains(&(self.diagonal * unit.in_mm()))
        };
        let fitting = [LengthUnit::Mm, LengthUnit::M, LengthUnit::Um].into_iter().find(fits);
        let hint =
            fitting.map_or(String::new(), |unit| format!("; in {} it would fit", unit.name()));
        let detail = format!(
            "the diagonal of the bounding box is {diagonal_mm:.4} mm, that of a head or its parts 50 to 600 mm{hint}"
        );
        if POSSIBLE_DIAGONAL_MM.contains(&diagonal_mm) || allow_any_scale {
            let warning = Warning::new("units-suspect", detail);
            return Ok(Some(warning.with("diagonal_mm", diagonal_mm)));
        }
        let problem =
            Problem::new(ErrorCode::UnitsSuspect, detail).with("diagonal_mm", diagonal_mm);
        Err(match fitting {
            Some(unit) => problem.with("suggested_units", unit.name()),
            None => problem,
        })
    }
}
