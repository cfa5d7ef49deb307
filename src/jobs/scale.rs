//! Scale of a mesh: whether its size in its unit is plausible for a head or a part of one.

use super::source::StoredShape;
use crate::schema::ErrorCode;
use crate::schema::Problem;
use crate::schema::case::document::LengthUnit;
use crate::schema::case::size::{USUAL_DIAGONAL_MM, units_suspect};
use mechanics::mesh::Warning;

/// Beyond these the unit is wrong, unless any scale is permitted.
const POSSIBLE_DIAGONAL_MM: std::ops::RangeInclusive<f64> = 5.0..=5000.0;

/// Units that the file of an image may state, as in place of which other one, and by how much its lengths change.
const IMAGE_UNITS: [(&str, f64); 4] = [
    ("mm in place of m, or um of mm", 1e-3),
    ("m in place of mm, or mm of um", 1e3),
    ("um in place of m", 1e-6),
    ("m in place of um", 1e6),
];

/// The diagonal of the bounding box of a mesh, in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshSize {
    pub diagonal: f64,
    pub units: LengthUnit,
    /// The unit is mm, whichever the file of the image states.
    pub of_image: bool,
}

impl MeshSize {
    /// The size of a mesh that was read; an image is in mm.
    pub fn of(shape: &StoredShape, units: LengthUnit) -> Self {
        let ((low, high), units) = match shape {
            StoredShape::Volume(volume) => (volume.bounds().into(), units),
            StoredShape::Surface(surface) => (surface.bounds(), units),
            StoredShape::Image(image) => (image.bounds(), LengthUnit::Mm),
        };
        let of_image = matches!(shape, StoredShape::Image(_));
        MeshSize { diagonal: (high - low).norm(), units, of_image }
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
        let units = [LengthUnit::Mm, LengthUnit::M, LengthUnit::Um];
        let fitting = units.into_iter().find(|unit| !self.of_image && fits(unit));
        let hint = match fitting {
            Some(unit) => format!("; in {} it would fit", unit.name()),
            None => self.image_hint(diagonal_mm),
        };
        let (shortest, longest) = USUAL_DIAGONAL_MM.into_inner();
        let detail = format!(
            "the diagonal of the bounding box is {diagonal_mm:.4} mm, that of a head or its parts {shortest} to {longest} mm{hint}"
        );
        if POSSIBLE_DIAGONAL_MM.contains(&diagonal_mm) || allow_any_scale {
            return Ok(Some(units_suspect(diagonal_mm, detail)));
        }
        let problem =
            Problem::new(ErrorCode::UnitsSuspect, detail).with("diagonal_mm", diagonal_mm);
        Err(match fitting {
            Some(unit) => problem.with("suggested_units", unit.name()),
            None => problem,
        })
    }

    /// Which unit the numbers of the file of an image would be in, from that which it states.
    fn image_hint(self, diagonal_mm: f64) -> String {
        let fits = |(_, factor): &(&str, f64)| USUAL_DIAGONAL_MM.contains(&(diagonal_mm * factor));
        let fitting = IMAGE_UNITS.into_iter().filter(|_| self.of_image).find(fits);
        fitting.map_or(String::new(), |(words, _)| {
            format!("; if its file stated {words}, it would fit")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    use mechanics::image::{ImageVolume, Placement, Voxels};
    use mechanics::mesh::Vector;

    #[test]
    fn an_image_is_told_the_unit_that_its_file_would_have_to_state() {
        let hint = |step: f64| {
            let steps = [Vector::x() * step, Vector::y() * step, Vector::z() * step];
            let placement = Placement { origin: Vector::zeros(), steps };
            let image = ImageVolume::new([2, 2, 2], placement, Voxels::I16(vec![0; 8])).unwrap();
            let size = MeshSize::of(&StoredShape::Image(Arc::new(image)), LengthUnit::Mm);
            size.check(false).unwrap_err().detail
        };
        // 150 mm that the file calls 150 m, and 150 mm that it calls 150 um.
        let [long, short] = [150e3, 150e-3].map(hint);
        assert!(
            long.ends_with("if its file stated mm in place of m, or um of mm, it would fit"),
            "{long}"
        );
        assert!(
            short.ends_with("if its file stated m in place of mm, or mm of um, it would fit"),
            "{short}"
        );
    }
}
