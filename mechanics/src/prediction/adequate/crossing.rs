//! Self-intersection of the skin: an error that no estimate of a model without contact contains.

use super::accepted::Accepted;
use crate::mesh::Warning;
use crate::prediction::Prediction;
use crate::prediction::skin::Skin;
use crate::prediction::skin_overlap::{Deepest, SKIN_OVERLAPS, added_overlap};

/// The warning where the skin newly passes through itself, deeper than the error that is accepted: no estimate has that.
pub(super) fn overlap(
    skin: &Skin,
    prediction: &Prediction,
    accepted: &Accepted,
) -> Option<Warning> {
    prediction.warnings.iter().find(|warning| warning.code == SKIN_OVERLAPS)?;
    let wanted = accepted.skin_mm;
    let Deepest { depth, at } = added_overlap(skin, &skin.moved(&prediction.displacement))
        .filter(|deepest| deepest.depth > wanted)?;
    let detail = format!(
        "the skin passes through itself {depth:.2} mm deeper than at rest, and {wanted:.3} mm were to be met: no error of a model \
         without contact has that; `contact` asks for one with it"
    );
    let warning = Warning::new("tolerance-not-met", detail).with("accepted_mm", wanted);
    let warning = warning.with("depth_mm", depth);
    Some(warning.with("x_mm", at.x).with("y_mm", at.y).with("z_mm", at.z))
}
