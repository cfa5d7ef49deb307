//! Lips of a scan: whether they are apart on the midline.

use super::head::Head;
use crate::mesh::Warning;

/// The mouth lies so far below the tip of the nose, in mm.
const BELOW_NOSE: [f64; 2] = [12.0, 80.0];
/// Lips are looked for so far above and below a gap, in mm.
const LIP: f64 = 25.0;
/// A gap between lips is at least so much deeper than both; folds of closed skin are flatter. In mm.
const DEEP: f64 = 10.0;

pub(super) fn finding(head: &Head<'_>) -> Option<Warning> {
    let height = gap(head)? as f64 * head.level_height();
    let detail = format!(
        "the mouth is open: lips are about {height:.1} mm apart on the midline; the prediction begins with them so"
    );
    Some(Warning::new("mouth-open", detail).with("gap_mm", height))
}

/// The levels of the gap between the lips.
fn gap(head: &Head<'_>) -> Option<usize> {
    let profile = head.profile(&head.skin.tissue);
    let nose = head.nose(&profile)?;
    let [highest, lowest] = BELOW_NOSE.map(|mm| head.below(nose, mm));
    let lip = (LIP / head.level_height()).ceil() as usize;
    let is_deep = |level: usize| {
        let foremost = |levels: std::ops::Range<usize>| {
            levels.map(|level| profile[level]).fold(f64::INFINITY, f64::min)
        };
        let below = foremost(level.saturating_sub(lip)..level);
        let above = foremost(level + 1..(level + lip + 1).min(nose));
        profile[level] - below.max(above) >= DEEP
    };
    let deep = (lowest..highest).filter(|&level| is_deep(level)).count();
    (deep > 0).then_some(deep)
}
