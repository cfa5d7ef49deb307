//! A plan applied to a response.

use crate::jobs::result::warnings::rank;
use crate::schema::WarningDocument;
use crate::schema::applied::AppliedSummary;
use mechanics::mesh::Vector;
use mechanics::prediction::{NUMERICAL_ERROR_LARGE, SKIN_OVERLAPS};

/// The skin for one plan.
pub struct Applied {
    /// In mm, at each node of the description.
    pub displacement: Vec<Vector>,
    pub summary: AppliedSummary,
    pub warnings: Vec<WarningDocument>,
    /// Whether the moved skin was looked at.
    pub skin_checked: bool,
    /// Whether edges between segments were looked at, which responses of earlier programs do not have.
    pub tearing_checked: bool,
}

/// Codes that need the mesh inside the skin, the surfaces of bones, or landmarks. What stands for `large-rotation` and `large-strain` is
/// the estimate of the response, a mean over the skin: these two are of its largest part.
const NEVER_MEASURED: [&str; 13] = [
    NUMERICAL_ERROR_LARGE,
    "cells-inverted",
    "bones-overlap",
    "bone-in-tissue",
    "bone-through-skin",
    "large-rotation",
    "large-strain",
    "tissue-may-buckle",
    "skin-outruns-plan",
    "sliding-off-wall",
    "landmark-far",
    "landmarks-crowded",
    "landmarks-swapped",
];

impl Applied {
    /// With the warnings of the case and the plan, and those of the summary.
    pub fn new(
        displacement: Vec<Vector>,
        summary: AppliedSummary,
        warnings: Vec<WarningDocument>,
        tearing_checked: bool,
    ) -> Self {
        let skin_checked = false;
        let applied = Applied { displacement, summary, warnings, skin_checked, tearing_checked };
        applied.warned(summary.warnings())
    }

    /// With further warnings, the most serious first.
    pub fn warned(mut self, further: Vec<WarningDocument>) -> Self {
        self.warnings.extend(further);
        self.warnings.sort_by_key(|warning| rank(&warning.code));
        self
    }

    /// The codes of warnings that nobody looked for: never what the mesh leaves out, which is of a plan and not of a response.
    pub fn not_measured(&self) -> Vec<String> {
        let skin = (!self.skin_checked).then_some(SKIN_OVERLAPS);
        let torn = (!self.tearing_checked).then_some("tearing");
        NEVER_MEASURED.into_iter().chain(torn).chain(skin).map(str::to_owned).collect()
    }

    /// f32 little-endian, three a node.
    pub fn to_bytes(&self) -> Vec<u8> {
        let values = self.displacement.iter().flat_map(|moved| [moved.x, moved.y, moved.z]);
        values.flat_map(|value| (value as f32).to_le_bytes()).collect()
    }

    /// Three numbers a node with the digits that f32 columns carry.
    pub fn to_triples(&self) -> Vec<[f32; 3]> {
        let moved = self.displacement.iter();
        moved.map(|moved| [moved.x as f32, moved.y as f32, moved.z as f32]).collect()
    }
}
