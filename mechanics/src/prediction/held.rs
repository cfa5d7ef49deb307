//! Boundary conditions of a scene: selections of nodes, checks of segments, fixed, sliding and prescribed nodes.

use super::case::{Plan, Prescribed, Settings};
use super::check::Check;
use super::error_code::SceneErrorCode;
use super::stated::{StatedCondition, StatedHold};
use crate::boundary::{HeldNodes, NodeSelection, SelectionError, Selector};
use crate::mesh::ignored::listed;
use crate::mesh::volume::BoundaryFace;
use crate::mesh::{ArrayUse, bounds_of};
use crate::plan::doubt::{MovedSegment, suspect_units, too_far};
use crate::plan::{PlannedSegment, RigidMovement};

impl Check<'_> {
    /// The selected nodes, ascending; none where they cannot be selected, which is noted as a problem, or after a stop.
    pub(super) fn select(&mut self, selection: &NodeSelection, pointer: &str) -> Vec<u32> {
        let selected = self.selected(selection);
        selected.unwrap_or_else(|error| {
            self.problems.selection(pointer, &error);
            Vec::new()
        })
    }

    /// The nodes of a selection, ascending; none once the check is to stop.
    pub(super) fn selected(
        &mut self,
        selection: &NodeSelection,
    ) -> Result<Vec<u32>, SelectionError> {
        if self.stop.is_asked() {
            return Ok(Vec::new());
        }
        let mut selector = Selector {
            mesh: &self.case.volume,
            surfaces: &self.case.surfaces,
            boundary_nodes: &self.boundary_nodes,
            is_in_cell: &self.is_in_cell,
            distances: &mut self.distances,
            stop: self.stop,
        };
        selector.select(selection)
    }

    /// The boundary faces all of whose nodes are listed.
    pub(super) fn faces_within(&self, nodes: &[u32]) -> Vec<BoundaryFace> {
        let listed = |node: &u32| nodes.binary_search(node).is_ok();
        self.boundary.iter().filter(|face| face.nodes().iter().all(listed)).copied().collect()
    }

    pub(super) fn held_nodes(
        &mut self,
        plan: &Plan,
        settings: &Settings,
    ) -> (Vec<PlannedSegment>, HeldNodes) {
        let mut held = HeldNodes::default();
        let segments = self.segments(plan, &mut held);
        for (index, selection) in self.case.fixed.iter().enumerate() {
            let pointer = format!("/case/fixed/{index}");
            let nodes = self.select(selection, &pointer);
            held.fixed.extend(&nodes);
            self.state(pointer, None, nodes, StatedHold::Fixed);
        }
        self.walls(&segments, settings, &mut held);
        self.prescribed(plan, &mut held);
        (segments, held)
    }

    /// Notes a condition, for its reaction force.
    pub(super) fn state(
        &mut self,
        pointer: String,
        segment: Option<u32>,
        nodes: Vec<u32>,
        constraints: StatedHold,
    ) {
        self.stated.push(StatedCondition { pointer, segment, nodes, constraints });
    }

    /// The segments of the case with their movements, then those that the plan names after node sets.
    fn segments(&mut self, plan: &Plan, held: &mut HeldNodes) -> Vec<PlannedSegment> {
        let mut segments: Vec<PlannedSegment> = Vec::new();
        for (index, segment) in self.case.segments.iter().enumerate() {
            if segments.iter().any(|other| other.name == segment.name) {
                let detail = format!("segment {:?} is defined twice", segment.name);
                self.problems.add(
                    format!("/case/segments/{index}/name"),
                    SceneErrorCode::DuplicateSegment,
                    detail,
                );
            }
            let planned = plan.segments.iter().find(|planned| planned.name == segment.name);
            let movement = planned.map_or_else(RigidMovement::default, |planned| planned.movement);
            let nodes = self.select(&segment.nodes, &format!("/case/segments/{index}/nodes"));
            let (pointer, number) = (format!("/case/segments/{index}"), Some(index as u32));
            self.state(pointer, number, nodes.clone(), StatedHold::Joined);
            held.joined.push((nodes, movement));
            segments.push(PlannedSegment { name: segment.name.clone(), movement });
        }
        for (index, planned) in plan.segments.iter().enumerate() {
            let pointer = format!("/plan/segments/{index}/name");
            if plan.segments[..index].iter().any(|other| other.name == planned.name) {
                let detail = format!("segment {:?} is named twice", planned.name);
                self.problems.add(pointer, SceneErrorCode::DuplicateSegment, detail);
            } else if !segments.iter().any(|segment| segment.name == planned.name) {
                match self.case.volume.node_set(&planned.name) {
                    Some(nodes) if !nodes.is_empty() => {
                        let own = NodeSelection::NodeSet(planned.name.clone());
                        let nodes = self.select(&own, &pointer);
                        let number = Some(segments.len() as u32);
                        let pointer = format!("/plan/segments/{index}");
                        self.state(pointer, number, nodes.clone(), StatedHold::Joined);
                        held.joined.push((nodes, planned.movement));
                        segments.push(planned.clone());
                    }
                    _ => {
                        let known = listed(segments.iter().map(|segment| &segment.name));
                        let detail = format!(
                            "the case has neither a segment nor a node set {:?}; its segments: {known}",
                            planned.name
                        );
                        self.problems.add(pointer, SceneErrorCode::UnknownSegment, detail);
                    }
                }
            }
        }
        segments
    }

    /// Refuses segments that go farther than the face is long or than is allowed, and warns of movements in other units.
    pub(super) fn plan_size(&mut self, plan: &Plan, segments: &[PlannedSegment], held: &HeldNodes) {
        let place = |node: &u32| self.case.volume.nodes[*node as usize];
        let corners = |nodes: &[u32]| bounds_of(nodes.iter().map(place));
        let moved = segments.iter().zip(&held.joined).filter_map(|(segment, (nodes, movement))| {
            Some(MovedSegment { name: &segment.name, movement, corners: corners(nodes)? })
        });
        let moved: Vec<MovedSegment> = moved.collect();
        let [low, high] = self.case.volume.bounds();
        if let Some(far) = too_far(&moved, (high - low).norm()) {
            let index = plan.segments.iter().position(|planned| planned.name == far.name());
            let pointer = format!("/plan/segments/{}", index.unwrap_or_default());
            self.problems.add(pointer, SceneErrorCode::PlanOutOfRange, far.to_string());
        }
        self.warnings.extend(suspect_units(&moved));
    }

    fn prescribed(&mut self, plan: &Plan, held: &mut HeldNodes) {
        for (index, entry) in plan.prescribed.iter().enumerate() {
            let pointer = format!("/plan/prescribed/{index}");
            match entry {
                Prescribed::Uniform { nodes, displacement } => {
                    let nodes = self.select(nodes, &format!("{pointer}/nodes"));
                    held.prescribed.extend(nodes.iter().map(|&node| (node, *displacement)));
                    let components = displacement.map(|component| component.is_some());
                    self.state(pointer, None, nodes, StatedHold::Components(components));
                }
                Prescribed::FromArray { nodes, array } => {
                    let nodes = self.select(nodes, &format!("{pointer}/nodes"));
                    let Some(values) = self.case.volume.node_vectors.get(array) else {
                        let volume = &self.case.volume;
                        let detail = volume.missing_array(ArrayUse::PointVectors, array);
                        self.problems.add(
                            format!("{pointer}/array"),
                            SceneErrorCode::UnknownArray,
                            detail,
                        );
                        continue;
                    };
                    let value = |node: u32| values[node as usize];
                    let whole = |node: u32| [value(node).x, value(node).y, value(node).z].map(Some);
                    held.prescribed.extend(nodes.iter().map(|&node| (node, whole(node))));
                    self.state(pointer, None, nodes, StatedHold::Components([true; 3]));
                }
            }
        }
    }
}
