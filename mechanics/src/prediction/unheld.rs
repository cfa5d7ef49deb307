//! Tissue that nothing keeps in place: a plan that moves all bones alike carries it away as one, without deforming
//! it.
//!
//! Something stays where a node is fixed or prescribed, slides on a wall that stays, or belongs to a segment that the
//! plan leaves where it is.

use super::case::Plan;
use super::check::Check;
use super::error_code::SceneErrorCode;
use crate::boundary::Conditions;
use crate::mesh::{TriangleSurface, Vector, Warning};
use crate::plan::doubt::farthest_apart;
use crate::plan::{PlannedSegment, RigidMovement};

/// Movements that take no point of the tissue farther apart than this are one movement, in mm.
const ALIKE: f64 = 1e-6;

/// The code of the error and of the warning.
const NOTHING_HELD: &str = "nothing-held";

/// What to do about it.
const CURE: &str = "name in `fixed` what stays, or allow it with `allow_unfixed`";

/// A skin goes along as one where no edge of it changes its length by more than this share of it.
const STRETCHED: f64 = 1e-4;

/// A skin that moves by less than this, in mm, goes nowhere.
const CARRIED_MM: f64 = 0.05;

/// The warning of a skin that goes along as one, whatever the conditions say that hold it: a wall beside which all
/// moves, prescribed nodes that move too, something fixed in another part of the mesh. `moved` says where a point of
/// the surface comes to lie. Ends at the first edge that is stretched.
pub fn carried_away(rest: &TriangleSurface, moved: impl Fn(usize) -> Vector) -> Option<Warning> {
    let place = |point: u32| (rest.points[point as usize], moved(point as usize));
    let is_stretched = |[from, to]: [u32; 2]| {
        let ((from, moved_from), (to, moved_to)) = (place(from), place(to));
        let length = (to - from).norm();
        ((moved_to - moved_from).norm() - length).abs() > STRETCHED * length
    };
    let edges = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
    if rest.triangles.iter().flat_map(edges).any(is_stretched) {
        return None;
    }
    let points = rest.points.iter().enumerate();
    let farthest = points.map(|(point, at)| (moved(point) - at).norm()).fold(0.0, f64::max);
    let detail = format!(
        "the skin goes along as one, by up to {farthest:.3} mm, and no edge of it is stretched by more than 0.01 %: \
         what holds the tissue goes with it; {CURE}"
    );
    (farthest > CARRIED_MM)
        .then(|| Warning::new(NOTHING_HELD, detail).with("farthest_mm", farthest))
}

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
                [alone] => format!("the only segment, {:?}", alone.name),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::RigidMovement;

    #[test]
    fn a_skin_that_turns_and_moves_as_one_is_told_and_one_that_stretches_is_not() {
        let points = [[0.0, 0.0, 0.0], [30.0, 0.0, 0.0], [0.0, 30.0, 0.0], [30.0, 30.0, 9.0]];
        let points = points.map(Vector::from).to_vec();
        let rest =
            TriangleSurface { points, triangles: vec![[0, 1, 2], [1, 3, 2]], node_ids: None };
        let turn = |by: f64| {
            let angles = Vector::new(0.0, 0.3 * by, 0.2 * by);
            RigidMovement::about_pivot(
                angles,
                Vector::new(5.0, 5.0, 0.0),
                Vector::new(by, 0.0, 0.0),
            )
        };
        let carried = |by: f64, along: f64| {
            let movement = turn(by);
            carried_away(&rest, |point| {
                let at = rest.points[point];
                at + movement.displacement(&at) + Vector::new(0.0, 0.0, along * at.x)
            })
        };
        let told = carried(4.0, 0.0).expect("the whole skin goes along");
        assert_eq!(told.code, "nothing-held");
        assert!(told.numbers[0].1 > 4.0, "{told:?}");
        // One that stretches by 0.1 %, and one that hardly moves.
        assert_eq!(carried(4.0, 1e-3), None);
        assert_eq!(carried(0.001, 0.0), None);
    }
}
