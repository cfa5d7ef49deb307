//! Thickness-preserving warp: parameters and description.

use serde::{Deserialize, Serialize};
use serde_json::json;
use utoipa::ToSchema;

use super::document::{Description, parameter};
use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::model::thickness_warp::ThicknessWarp;

/// Parameters of the thickness-preserving warp.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ThicknessWarpDocument {
    /// Bones up to this much farther than the nearest one have weights, decreasing with distance; 0 follows the
    /// nearest bone alone, with jumps where another becomes the nearest.
    #[serde(default)]
    #[schema(default = 0.0, minimum = 0.0, maximum = 200.0)]
    pub blend_radius_mm: f64,
}

impl ThicknessWarpDocument {
    /// The method of the numerics.
    pub fn to_method(self, at: &Pointer, faults: &mut Faults) -> ThicknessWarp {
        faults.check_range(&at.key("blend_radius_mm"), self.blend_radius_mm, 0.0..=200.0, "mm");
        ThicknessWarp { blend_radius: self.blend_radius_mm }
    }
}

/// Its description in `GET /v1/methods`.
pub(super) fn description() -> Description {
    Description {
        title: "thickness-preserving warp: tissue moves with the nearest bone",
        assumptions: &[
            "every point keeps its distance to the nearest bone, and moves as that bone does",
            "no mechanics: volume is not preserved, materials and sliding are ignored, reactions are 0, and \
                loads are refused",
            "bone is each boundary face whose nodes are all constrained in all directions",
            "where another bone becomes the nearest, tissue jumps (`warp-jumps`); a blend radius \
                reduces that at the cost of thickness there",
        ],
        reads: &[
            "case.segments",
            "case.fixed",
            "plan.segments",
            "plan.prescribed",
            "spec.thickness_warp",
        ],
        parameters: vec![parameter(
            "blend_radius_mm",
            "bones up to this much farther than the nearest have weights",
            json!(0.0),
            "[0, 200]",
        )],
    }
}
