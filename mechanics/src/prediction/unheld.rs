//! Tissue that nothing keeps in place: a plan that moves all bones alike carries it away as one, without deforming
//! it.
//!
//! Something stays where a node is fixed or prescribed, slides on a wall that stays, or belongs to a segment that the
//! plan leaves where it is.

use super::case::Plan;
use super::check::Check;
use super::error_code::SceneErrorCode;
use crate::boundary::Conditions;
use crate::mesh::{Vector, Warning};
use crate::plan::doubt::farthest_apart;
use crate::plan::{PlannedSegment, RigidMovement};

/// Movements that take no point of the tissue farther apart than this are one movement, in mm.
const ALIKE: f64 = 1e-6;

/// The code of the error and of the warning.
const NOTHING_HELD: &str = "nothing-held";

/// What to do about it.
const CURE: &str = "name in `fixed` what stays, or allow it with `allow_unfixed`";

/// Whether all of some movements take the corners of a box to the same places.
pub fn are_alike(movements: &[RigidMovement], corners: &[Vector; 2]) -> bool {
    let Some((first, others)) = movements.split_first() else { return true };
    others.iter().all(|other| farthest_apart(first, other, corners) <= ALIKE)
}

impl Check<'_> {
    /// Refuses a plan that moves all bones alike while nothing stays, and warns of a case that may come to that.
    pub(super) fn unheld(
        &mut self,
        plan: &Plan,
        segments: &[PlannedSegment],
        conditions: &Conditions,
    ) {
        if self.case.allow_unfixed || segments.is_empty() || conditions.something_rests() {
            return;
        }
        let still = RigidMovement::default();
        let movements: Vec<RigidMovement> = segments.iter().map(|of| of.movement).collect();
        let corners = self.case.volume.bounds();
        let staying = movements.iter().filter(|movement| **movement == still).count();
        if staying == segments.len() {
            if plan.loads.is_empty() {
                let which = if segments.len() == 1 { "" } else { " that moves all segments alike" };
                let detail = format!(
                    "nothing stays: no node is fixed, prescribed or slides on a wall that stays, and a plan{which} \
                     would carry the tissue away as one; {CURE}"
                );
                self.warnings.push(nothing_held(detail, segments.len()));
            }
        } else if are_alike(&movements, &corners) {
            let farthest = farthest_apart(&movements[0], &still, &corners);
            let who = match segments {
                [alone] => format!("segment {:?}, the only one,", alone.name),
                several => format!("all {} segments alike", several.len()),
            };
            let detail = format!(
                "no node is fixed, prescribed or slides on a wall that stays, and the plan moves {who}: the tissue \
                 would go with them as one, by up to {farthest:.3} mm; {CURE}"
            );
            self.problems.add("/case/fixed", SceneErrorCode::NothingHeld, detail);
        } else if staying == 0 {
            let detail = format!(
                "nothing stays: every segment moves, and no node is fixed, prescribed or slides on a wall that \
                 stays; {CURE}"
            );
            self.warnings.push(nothing_held(detail, segments.len()));
        }
    }
}

fn nothing_held(detail: String, segments: usize) -> Warning {
    Warning::new(NOTHING_HELD, detail).with("segments", segments as f64)
}
