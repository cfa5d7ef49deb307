//! Comparison of a predicted skin.

use super::input::{PredictInput, Prepared};
use crate::jobs::clock::Observed;
use crate::jobs::compare::{ComparisonFindings, Pair};
use crate::jobs::failure::JobError;
use crate::jobs::result::skin::PredictedSkin;
use crate::schema::Pointer;
use mechanics::mesh::Frame;

/// Compares the predicted skin with the surface of the spec, if any.
pub fn compare_skin(
    input: &PredictInput,
    prepared: &Prepared,
    skin: &PredictedSkin,
    clock: &Observed,
) -> Result<Option<ComparisonFindings>, JobError> {
    let (Some(spec), Some(meshes)) = (&input.spec.compare_to, &prepared.compared) else {
        return Ok(None);
    };
    let at = Pointer::root().key("spec").key("compare_to");
    let frame = prepared.case.frame;
    let stated = (frame != Frame::Unspecified).then_some(frame);
    let pair = Pair {
        prediction: &skin.surface,
        prediction_frame: stated,
        displacement: Some(&skin.displacement),
        skin_regions: &prepared.scene.skin.regions,
        meshes,
        at,
    };
    pair.compare(spec, clock).map(Some)
}
