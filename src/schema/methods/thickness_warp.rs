//! What `GET /v1/methods` tells of `thickness_warp`.

use serde_json::json;

use super::document::{MethodDocument, parameter, words};
use super::name::MethodName;

pub(super) fn document() -> MethodDocument {
    MethodDocument {
        name: MethodName::ThicknessWarp,
        title: "thickness-preserving warp: tissue rides on the nearest bone".to_owned(),
        assumptions: words(&[
            "every point keeps its distance to the nearest bone, and moves as that bone does",
            "no mechanics: volume is not preserved, materials and sliding are ignored, reactions are 0, and \
                loads are refused",
            "bone is where all nodes of a boundary face are held in all directions",
            "where another bone becomes the nearest, tissue jumps: told as `warp-jumps`; a blend radius \
                softens that and gives up thickness there",
        ]),
        elements: Vec::new(),
        cells: words(&["tet4", "hex8", "wedge6"]),
        reads: words(&[
            "case.segments",
            "case.fixed",
            "plan.segments",
            "plan.prescribed",
            "spec.thickness_warp",
        ]),
        parameters: vec![parameter(
            "blend_radius_mm",
            "bones up to this much farther than the nearest take part",
            json!(0.0),
            "[0, 200]",
        )],
    }
}
