//! Parts of space and of the skin that a comparison measures.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::{CornerPair, Sphere};

/// A part of space: exactly one of a sphere and a box.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaceDocument {
    /// Centre and radius: x, y, z, r.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub sphere_mm: Option<Sphere>,
    /// Lowest and highest corner: x0, y0, z0, x1, y1, z1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub box_mm: Option<CornerPair>,
}

/// A region with its own measures: exactly one of a part of space, a part of the predicted skin, and the part that
/// the plan moves. Its actual surface is the part nearest to that of the prediction.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ComparedRegionDocument {
    /// Centre and radius: x, y, z, r.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub sphere_mm: Option<Sphere>,
    /// Lowest and highest corner: x0, y0, z0, x1, y1, z1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub box_mm: Option<CornerPair>,
    /// A part of the skin by its name in `skin_regions` of the case: in `skin.vtp` of a prediction it is the point array
    /// `set_NAME`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub skin_region: Option<String>,
    /// The skin that the prediction moved by more than this, in the mean over the corners of a triangle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 0.0)]
    pub moved_by_more_than_mm: Option<f64>,
}

impl PlaceDocument {
    pub fn check(&self, at: &Pointer, faults: &mut Faults) {
        let given = usize::from(self.sphere_mm.is_some()) + usize::from(self.box_mm.is_some());
        if !faults.check_one_of(at, given, "`sphere_mm`, `box_mm`") {
            return;
        }
        if let Some(Sphere([.., radius])) = self.sphere_mm {
            faults.check_range(&at.key("sphere_mm").index(3), radius, 1e-6..=1e6, "mm");
        }
        if let Some(CornerPair([x0, y0, z0, x1, y1, z1])) = self.box_mm
            && !(x0 < x1 && y0 < y1 && z0 < z1)
        {
            let detail = "each coordinate of the lowest corner is below that of the highest";
            faults.add(&at.key("box_mm"), ErrorCode::OutOfRange, detail);
        }
    }
}

impl ComparedRegionDocument {
    pub(super) fn check(&self, at: &Pointer, faults: &mut Faults) {
        let PlaceDocument { sphere_mm, box_mm } = self.place();
        let forms = [
            sphere_mm.is_some(),
            box_mm.is_some(),
            self.skin_region.is_some(),
            self.moved_by_more_than_mm.is_some(),
        ];
        let given = forms.into_iter().filter(|&form| form).count();
        let names = "`sphere_mm`, `box_mm`, `skin_region`, `moved_by_more_than_mm`";
        if faults.check_one_of(at, given, names) && (sphere_mm.is_some() || box_mm.is_some()) {
            self.place().check(at, faults);
        }
        if let Some(length) = self.moved_by_more_than_mm {
            faults.check_range(&at.key("moved_by_more_than_mm"), length, 0.0..=1e3, "mm");
        }
    }

    /// Its part of space, if it is one.
    pub fn place(&self) -> PlaceDocument {
        PlaceDocument { sphere_mm: self.sphere_mm, box_mm: self.box_mm }
    }
}
