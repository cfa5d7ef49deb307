//! Equations that were solved loosely, because that was asked for.

use crate::mesh::Warning;

/// A residual above this is told of: skin was off by .2 µm with it, by .2 mm with a thousand times as
/// much (docs/case.md#how-it-is-computed).
const LOOSE: f64 = 1e-6;

/// A warning where the relative residual that was wanted, and that was reached, is above that. No estimate of an error
/// contains what it adds.
pub fn solved_loosely(wanted: f64, reached: f64) -> Option<Warning> {
    if wanted.min(reached) <= LOOSE {
        return None;
    }
    let detail = format!(
        "the equations were solved to a relative residual of {reached:.1e}, as `tolerance` of {wanted:e} requests: the error that this adds is \
         in no estimate; request {LOOSE:e} or less"
    );
    let warning = Warning::new("solved-loosely", detail);
    Some(warning.with("relative_residual", reached).with("wanted_residual", wanted))
}
