//! Conditions of all nodes, and refusals of those that contradict each other by the names of their segments.

use std::collections::BTreeMap;

use super::case::Plan;
use super::check::Check;
use super::error_code::SceneErrorCode;
use crate::boundary::conditions::combine;
use crate::boundary::{ConditionError, Conditions, HeldNodes, NodeClass};
use crate::plan::PlannedSegment;

impl Check<'_> {
    /// None where a contradiction was noted. `segments` are those of the case, then the node sets that the plan names.
    pub(super) fn conditions(
        &mut self,
        held: &HeldNodes,
        (plan, segments): (&Plan, &[PlannedSegment]),
    ) -> Conditions {
        combine(&self.case.volume.nodes, held).unwrap_or_else(|error| {
            self.refuse_conflict(&error, plan, segments);
            let classes = vec![NodeClass::Free; self.case.volume.nodes.len()];
            Conditions {
                classes,
                constraints: Vec::new(),
                walls: BTreeMap::new(),
                shared: Vec::new(),
                warnings: Vec::new(),
            }
        })
    }

    fn refuse_conflict(
        &mut self,
        error: &ConditionError,
        plan: &Plan,
        segments: &[PlannedSegment],
    ) {
        let (pointer, detail) = match error {
            ConditionError::TwoMovements { node, first, second, distance } => {
                let [one, other] = [*first, *second].map(|number| segments[number].name.as_str());
                let of_case = self.case.segments.len();
                let place = |name: &str| plan.segments.iter().position(|own| own.name == name);
                let index = place(other).or_else(|| place(one)).unwrap_or_default();
                let apart = format!("to places {distance:.3e} mm apart");
                let detail = match (*first < of_case, *second < of_case) {
                    (true, false) => format!(
                        "the plan moves node set {other:?} of the mesh, of which node {node} also belongs to segment {one:?} of the \
                         case: they move it {apart}. State the movement for {one:?} instead, or leave {other:?} out of the plan"
                    ),
                    (true, true) => format!(
                        "segments {one:?} and {other:?} of the case both have node {node}, and the plan moves it {apart} (a segment \
                         that it does not name stays): move both alike, or define them in the case without nodes in common"
                    ),
                    (false, _) => format!(
                        "the plan moves node sets {one:?} and {other:?} of the mesh, which both have node {node}, {apart}: move both \
                         alike, or leave one of them out of the plan"
                    ),
                };
                (format!("/plan/segments/{index}"), detail)
            }
            ConditionError::TwoValues { .. } | ConditionError::PrescribedAgainstJoined { .. } => {
                ("/plan".to_owned(), error.to_string())
            }
        };
        self.problems.add(pointer, SceneErrorCode::PlanConflict, detail);
    }
}
