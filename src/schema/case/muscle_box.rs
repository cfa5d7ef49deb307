//! The box of a strap muscle, given by numbers.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::Triple;
use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::mesh::{TriangleSurface, Vector};
use mechanics::muscle::strap::box_surface;

/// Farthest coordinate of a point of a muscle in mm.
pub(super) const FARTHEST_MM: f64 = 1e8;

/// The volume of a box over that of one with the same axes at right angles, at and below which it is flat.
const FLAT: f64 = 1e-6;

/// A box, in mm in the frame of the case.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MuscleBoxDocument {
    pub centre: Triple,
    /// From the centre to the centres of three faces.
    #[schema(value_type = Vec<Triple>, min_items = 3, max_items = 3)]
    pub half_axes: [Triple; 3],
}

impl MuscleBoxDocument {
    pub(super) fn to_surface(self, at: &Pointer, faults: &mut Faults) -> Option<TriangleSurface> {
        let [a, b, c] = self.half_axes.map(Vector::from);
        let rows = [(at.key("centre"), self.centre)].into_iter().chain(
            (0..).zip(self.half_axes).map(|(axis, own)| (at.key("half_axes").index(axis), own)),
        );
        for (place, own) in rows {
            for (axis, &coordinate) in own.0.iter().enumerate() {
                let range = -FARTHEST_MM..=FARTHEST_MM;
                faults.check_range(&place.index(axis), coordinate, range, "mm");
            }
        }
        let (volume, cube) = (a.dot(&b.cross(&c)), a.norm() * b.norm() * c.norm());
        if !(volume.abs() > FLAT * cube && cube > 0.0) {
            let detail =
                format!("a box needs a volume, this one has {:.3} mm³", 8.0 * volume.abs());
            faults.add(&at.key("half_axes"), ErrorCode::OutOfRange, detail);
            return None;
        }
        Some(box_surface(Vector::from(self.centre), [a, b, c]))
    }
}
