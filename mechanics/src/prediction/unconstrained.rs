//! Unconstrained tissue: parts whose constraints all move alike, or let them follow. Such a part is not deformed, and a
//! prediction says nothing about it.
//!
//! What is judged is each connected part of the mesh, from the values at which it is held: prescribed nodes that all
//! move too, a wall along which everything slides, something fixed in another part are no hold. A part with a tenth of
//! the skin or more is refused; a smaller one, an island of tissue on a bone, is told.

use super::case::Plan;
use super::check::Check;
use super::error_code::SceneErrorCode;
use crate::boundary::{ConnectedPart, Freedom, Holder};
use crate::mesh::Warning;
use crate::plan::{PlannedSegment, RigidMovement};

/// The code of the error and of the warning.
pub const NOTHING_HELD: &str = "nothing-held";

/// What to do about it.
const CURE: &str = "name in `fixed` what stays, or allow it with `allow_unfixed` (contact with other parts is no constraint)";

/// Parts that go along as one with a plan.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RigidlyCarried {
    /// Of parts with much of the skin: what is refused.
    pub refused: Vec<String>,
    /// Of the others.
    pub told: Vec<Warning>,
}

/// The parts that move rigidly under given movements of the segments.
pub fn rigidly_carried(
    parts: &[ConnectedPart],
    movement: impl Fn(u32) -> RigidMovement + Copy,
) -> RigidlyCarried {
    let mut found = RigidlyCarried::default();
    for part in parts {
        let Some(carried) = part.carried(movement) else { continue };
        let (which, farthest) = (part_of(part, parts.len()), carried.farthest);
        let detail = format!(
            "{which} would move rigidly, by up to {farthest:.3} mm, without deformation: nothing is fixed, or what constrains it moves alike \
             or leaves it free to follow; {CURE}"
        );
        match part.has_much_skin() {
            true => found.refused.push(detail),
            false => found.told.push(
                Warning::new(NOTHING_HELD, detail)
                    .with("farthest_mm", farthest)
                    .with("nodes", part.nodes as f64)
                    .with("skin_share", part.skin_share),
            ),
        }
    }
    found
}

/// A part in the words of a sentence.
fn part_of(part: &ConnectedPart, parts: usize) -> String {
    match parts {
        1 => "the tissue".to_owned(),
        _ => format!(
            "the part of {} nodes that contains node {}, with {:.0} % of the skin,",
            part.nodes,
            part.first_node,
            100.0 * part.skin_share
        ),
    }
}

/// What remains free of a part whose segments move, if anything does.
fn left_free(part: &ConnectedPart, stays: impl Fn(u32) -> bool) -> Option<Freedom> {
    let freedom = part.freedom(|holder| match holder {
        Holder::Rest | Holder::Prescribed => true,
        Holder::Segment(segment) => stays(segment),
    });
    (part.segments().next().is_some() && freedom.count() > 0).then_some(freedom)
}

impl Check<'_> {
    /// Refuses a plan that moves a part of the tissue rigidly, and warns of a case that allows it.
    pub(super) fn unconstrained(
        &mut self,
        plan: &Plan,
        segments: &[PlannedSegment],
        parts: &[ConnectedPart],
    ) {
        if self.case.allow_unfixed {
            return;
        }
        let found = rigidly_carried(parts, |segment| segments[segment as usize].movement);
        self.warnings.extend(found.told);
        let is_refused = !found.refused.is_empty();
        for detail in found.refused {
            self.problems.add("/case/fixed", SceneErrorCode::NothingHeld, detail);
        }
        let still = RigidMovement::default();
        let is_still = segments.iter().all(|segment| segment.movement == still);
        let acts = plan.states_loads() || !plan.prescribed.is_empty();
        if is_refused || (is_still && acts) {
            return;
        }
        let much = parts.iter().filter(|part| part.has_much_skin());
        for part in much {
            let stays = |segment: u32| !is_still && segments[segment as usize].movement == still;
            let Some(freedom) = left_free(part, stays) else { continue };
            let names: Vec<String> =
                part.segments().map(|of| format!("{:?}", segments[of as usize].name)).collect();
            let (which, names) = (part_of(part, parts.len()), names.join(", "));
            let detail = match is_still {
                true => format!(
                    "{which} may {freedom}, but for segments that a plan may move: one that moves {names} alike in \
                     such a way would carry it along as one; {CURE}"
                ),
                false => format!(
                    "nothing that stays holds {which}: it may {freedom}, but for segments that move, {names}; {CURE}"
                ),
            };
            let count = part.segments().count() as f64;
            let warning = Warning::new(NOTHING_HELD, detail).with("segments", count);
            self.warnings.push(warning.with("free_movements", freedom.count() as f64));
        }
    }
}
