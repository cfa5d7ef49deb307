//! What a reader must know of an answer that is not adequate.

use super::accepted::{Accepted, MeanErrors};
use crate::mesh::Warning;
use crate::prediction::Prediction;
use crate::prediction::skin::Skin;
use crate::prediction::skin_overlap::{Deepest, SKIN_OVERLAPS, deeper_than_at_rest};

/// The warning where the skin newly passes through itself, deeper than the error that is accepted: no estimate has that.
pub(super) fn overlap(
    skin: &Skin,
    prediction: &Prediction,
    accepted: &Accepted,
) -> Option<Warning> {
    prediction.warnings.iter().find(|warning| warning.code == SKIN_OVERLAPS)?;
    let wanted = accepted.skin_mm;
    let Deepest { depth, at } = deeper_than_at_rest(skin, &skin.moved(&prediction.displacement))
        .filter(|deepest| deepest.depth > wanted)?;
    let detail = format!(
        "the skin passes through itself {depth:.2} mm deeper than at rest, and {wanted:.3} mm were to be met: no error of a model \
         without contact has that; `contact` asks for one with it"
    );
    let warning = Warning::new("tolerance-not-met", detail).with("accepted_mm", wanted);
    let warning = warning.with("depth_mm", depth);
    Some(warning.with("x_mm", at.x).with("y_mm", at.y).with("z_mm", at.z))
}

/// The warning where the expected error is larger than the accepted one, or not known.
pub(super) fn not_met(error: Option<&MeanErrors>, accepted: &Accepted) -> Warning {
    let wanted = accepted.skin_mm;
    let Some(error) = error else {
        let detail = "how far the skin is off is not known".to_owned();
        return Warning::new("tolerance-not-met", detail).with("accepted_mm", wanted);
    };
    let skin = error.skin_mm;
    let detail = match accepted
        .regions_mm
        .iter()
        .find(|(name, accepted)| error.regions_mm.get(*name).is_none_or(|error| error > *accepted))
    {
        Some((name, wanted)) if skin <= accepted.skin_mm => {
            let own = error.regions_mm.get(name).copied().unwrap_or(f64::NAN);
            format!(
                "{name:?} is expected to be off by {own:.3} mm in the mean, and {wanted:.3} mm were to be met"
            )
        }
        Some(_) | None => format!(
            "the skin that moves is expected to be off by {skin:.3} mm in the mean, and {wanted:.3} mm were to be met: no adequate \
             model fits the mesh, the time and the case"
        ),
    };
    let warning = Warning::new("tolerance-not-met", detail).with("accepted_mm", wanted);
    warning.with("expected_mm", skin)
}
