//! Size of a head or a part of one, by which the unit of a mesh is doubted.

use std::ops::RangeInclusive;

use mechanics::mesh::Warning;

/// Diagonals of the bounding boxes of heads and their parts, in mm.
pub const USUAL_DIAGONAL_MM: RangeInclusive<f64> = 50.0..=600.0;

/// The warning of a mesh that may be in another unit.
pub fn units_suspect(diagonal_mm: f64, detail: String) -> Warning {
    Warning::new("units-suspect", detail).with("diagonal_mm", diagonal_mm)
}
