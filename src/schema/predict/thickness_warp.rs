//! `thickness_warp` of a spec: what the warp has to be told.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::model::thickness_warp::ThicknessWarp;

/// What only the thickness-preserving warp has to be told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ThicknessWarpDocument {
    /// Bones up to this much farther than the nearest one take part, the less the farther; 0 follows the
    /// nearest bone alone, and jumps where another one becomes the nearest.
    #[serde(default)]
    #[schema(default = 0.0, minimum = 0.0, maximum = 200.0)]
    pub blend_radius_mm: f64,
}

impl ThicknessWarpDocument {
    /// The method of the path.
    pub fn to_method(self, at: &Pointer, faults: &mut Faults) -> ThicknessWarp {
        faults.check_range(&at.key("blend_radius_mm"), self.blend_radius_mm, 0.0..=200.0, "mm");
        ThicknessWarp { blend_radius: self.blend_radius_mm }
    }
}
