//! Plan document: the movements of the segments of a case, and loads.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::movement::{MovementContext, MovementDocument, RestrictionDocument, RotationOrder};
use super::{inner, load};
use crate::schema::case::document::FrameName;
use crate::schema::case::selection::SelectionDocument;
use crate::schema::code::ErrorCode;
use crate::schema::osteotomy::conversion::{OsteotomyContext, PlannedOsteotomy};
use crate::schema::osteotomy::document::OsteotomyDocument;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::{Matrix4x4, PartialTriple, Triple};
use mechanics::mesh::{Frame, Vector};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{Plan, Prescribed};

pub use super::inner::{ActivationDocument, GrowthDocument};
pub use super::load::LoadDocument;

/// Movements, loads and prescribed displacements; coordinates in `frame`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PlanDocument {
    /// Distinguishes it from other plans of the case; no effect on results.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub name: Option<String>,
    /// Segments that are not named stay.
    #[serde(default)]
    pub segments: Vec<PlanSegmentDocument>,
    /// Default: the frame of the case.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub frame: Option<FrameName>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub prescribed: Vec<PrescribedDocument>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub loads: Vec<LoadDocument>,
    /// Regions whose tissue gains or loses volume.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub growth: Vec<GrowthDocument>,
    /// Active muscles.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub activations: Vec<ActivationDocument>,
    /// Cuts through the bone of a scan, for a case made from one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub osteotomy: Option<OsteotomyDocument>,
}

/// A segment of the case, or a node set of its volume mesh, and its movement in exactly one of three forms:
/// `translation_mm` with `rotation_deg`, `matrix4x4`, or `sequence`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PlanSegmentDocument {
    pub name: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub translation_mm: Option<Triple>,
    /// About x, y and z.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub rotation_deg: Option<Triple>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub rotation_order: Option<RotationOrder>,
    /// Required if a rotation is not 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub pivot_mm: Option<Triple>,
    /// Row-major, last row 0 0 0 1, orthonormal to 1e-6 with determinant +1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub matrix4x4: Option<Matrix4x4>,
    /// Of a movement by `translation_mm` and `rotation_deg`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub restrict_to: Option<RestrictionDocument>,
    /// Applied one after the other, the first entry first, all in the fixed frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub sequence: Option<Vec<MovementDocument>>,
}

/// Prescribed displacements of nodes: exactly one of `displacement_mm` and `array`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PrescribedDocument {
    pub nodes: SelectionDocument,
    /// Null leaves a component free.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub displacement_mm: Option<PartialTriple>,
    /// A point array of the volume mesh with three components, in mm in the frame of the case.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub array: Option<String>,
}

/// The context of checking a plan.
pub struct PlanContext<'a> {
    pub frame: Frame,
    /// The centre of the mesh's bounding box in mm; `None` if there is no mesh yet.
    pub centre: Option<Vector>,
    pub limits: &'a Limits,
}

impl PlanDocument {
    /// The cuts of a plan for a scan in `frame`, taken out of it, with its segments checked against theirs. `None` if
    /// there are none or they have faults.
    pub fn take_osteotomy(
        &mut self,
        at: &Pointer,
        frame: Frame,
        limits: &Limits,
        faults: &mut Faults,
    ) -> Option<PlannedOsteotomy> {
        let document = self.osteotomy.take()?;
        let context =
            OsteotomyContext { mirrored_axes: self.mirrored_axes(at, frame, faults), limits };
        let is_cut = |name: &str| document.segments.iter().any(|cut| cut.name.trim() == name);
        for (index, segment) in self.segments.iter().enumerate() {
            let name = segment.name.trim();
            if !is_cut(name) {
                let detail = format!("the osteotomy has no segment `{name}`");
                let at = at.key("segments").index(index).key("name");
                faults.add(&at, ErrorCode::UnknownSegment, detail);
            }
        }
        document.to_osteotomy(&at.key("osteotomy"), &context, faults)
    }

    /// Its movements and loads.
    pub fn unnamed(&self) -> PlanDocument {
        PlanDocument { name: None, ..self.clone() }
    }

    pub fn check_name(&self, at: &Pointer, limits: &Limits, faults: &mut Faults) {
        if let Some(name) = &self.name {
            faults.check_name(&at.key("name"), name, limits.name_characters as usize);
        }
    }

    /// The plan in the frame of the case, whose segments are known. Faulty parts are added to `faults`, and omitted from
    /// the plan.
    pub fn to_plan(&self, at: &Pointer, context: &PlanContext, faults: &mut Faults) -> Plan {
        if self.osteotomy.is_some() {
            let detail = "the case has a mesh with its segments, and no scan with bone to cut";
            faults.add(&at.key("osteotomy"), ErrorCode::NoScan, detail);
        }
        let limits = context.limits;
        self.check_name(at, limits, faults);
        let context = MovementContext {
            mirrored_axes: self.mirrored_axes(at, context.frame, faults),
            centre: context.centre,
            limits: context.limits,
        };
        Plan {
            segments: self.to_segments(&at.key("segments"), &context, faults),
            prescribed: self.to_prescribed(&at.key("prescribed"), &context, faults),
            loads: load::to_loads(&self.loads, &at.key("loads"), &context, faults),
            growth: inner::to_growth(&self.growth, &at.key("growth"), limits, faults),
            activations: inner::to_activations(
                &self.activations,
                &at.key("activations"),
                limits,
                faults,
            ),
        }
    }

    /// Every surface of its selections, with its place; some may be names of bones of the case.
    pub fn surface_references_mut(&mut self) -> Vec<(Pointer, &mut String)> {
        let root = Pointer::root();
        let mut found = Vec::new();
        for (index, entry) in self.prescribed.iter_mut().enumerate() {
            let at = root.key("prescribed").index(index).key("nodes");
            entry.nodes.surfaces_mut(&at, &mut found);
        }
        for (index, load) in self.loads.iter_mut().enumerate() {
            let at = root.key("loads").index(index);
            if let Some(nodes) = &mut load.nodes {
                nodes.surfaces_mut(&at.key("nodes"), &mut found);
            }
            if let Some(faces) = &mut load.faces {
                faces.surfaces_mut(&at.key("faces"), &mut found);
            }
        }
        found
    }

    /// Whether x and y change sign between the plan and the case.
    fn mirrored_axes(&self, at: &Pointer, case_frame: Frame, faults: &mut Faults) -> bool {
        let plan_frame = self.frame.map_or(case_frame, Frame::from);
        if plan_frame == case_frame {
            return false;
        }
        if plan_frame == Frame::Unspecified || case_frame == Frame::Unspecified {
            let detail = format!(
                "the plan is in frame {plan_frame}, the case in {case_frame}: state the `frame` of the one without (for a mesh or a \
                 scan on the command line, `--frame LPS`; else that of its upload)"
            );
            faults.add(&at.key("frame"), ErrorCode::FrameConflict, detail);
        }
        true
    }

    fn to_segments(
        &self,
        at: &Pointer,
        context: &MovementContext,
        faults: &mut Faults,
    ) -> Vec<PlannedSegment> {
        faults.check_length(at, self.segments.len(), context.limits.list_entries as usize);
        let mut names = BTreeSet::new();
        let mut planned = Vec::new();
        for (index, segment) in self.segments.iter().enumerate() {
            let at = at.index(index);
            let name = segment.name.trim();
            faults.check_name(&at.key("name"), name, context.limits.name_characters as usize);
            if !names.insert(name) {
                let detail = format!("segment `{name}` is named more than once");
                faults.add(&at.key("name"), ErrorCode::DuplicateName, detail);
            }
            if let Some(movement) = segment.to_movement(&at, context, faults) {
                context.check_whole(&at, &movement, faults);
                let name = name.to_owned();
                planned.push(PlannedSegment { name, movement });
            }
        }
        planned
    }

    fn to_prescribed(
        &self,
        at: &Pointer,
        context: &MovementContext,
        faults: &mut Faults,
    ) -> Vec<Prescribed> {
        faults.check_length(at, self.prescribed.len(), context.limits.list_entries as usize);
        let entries = self.prescribed.iter().enumerate();
        entries
            .filter_map(|(index, entry)| entry.to_prescribed(&at.index(index), context, faults))
            .collect()
    }
}

impl PlanSegmentDocument {
    fn to_movement(
        &self,
        at: &Pointer,
        context: &MovementContext,
        faults: &mut Faults,
    ) -> Option<RigidMovement> {
        let single = MovementDocument {
            translation_mm: self.translation_mm,
            rotation_deg: self.rotation_deg,
            rotation_order: self.rotation_order,
            pivot_mm: self.pivot_mm,
            matrix4x4: self.matrix4x4,
            restrict_to: self.restrict_to,
        };
        let forms = [single.has_pivot_form(), self.matrix4x4.is_some(), self.sequence.is_some()];
        let given = forms.into_iter().filter(|&form| form).count();
        let names = "`translation_mm` with `rotation_deg`, `matrix4x4`, `sequence`";
        if !faults.check_one_of(at, given, names) {
            return None;
        }
        let Some(sequence) = &self.sequence else {
            return single.to_movement(at, context, faults);
        };
        let at = at.key("sequence");
        if sequence.is_empty() {
            faults.add(&at, ErrorCode::MissingField, "a sequence has at least one movement");
        }
        faults.check_length(&at, sequence.len(), context.limits.list_entries as usize);
        let mut whole = Some(RigidMovement::default());
        for (index, entry) in sequence.iter().enumerate() {
            let next = entry.to_movement(&at.index(index), context, faults);
            whole = whole.zip(next).map(|(before, next)| before.then(&next));
        }
        whole
    }
}

impl PrescribedDocument {
    fn to_prescribed(
        &self,
        at: &Pointer,
        context: &MovementContext,
        faults: &mut Faults,
    ) -> Option<Prescribed> {
        let nodes = self.nodes.to_selection(&at.key("nodes"), context.limits, faults);
        let given = usize::from(self.displacement_mm.is_some()) + usize::from(self.array.is_some());
        if !faults.check_one_of(at, given, "`displacement_mm`, `array`") {
            return None;
        }
        if let Some(array) = self.array.clone() {
            return Some(Prescribed::FromArray { nodes: nodes?, array });
        }
        let components = self.displacement_mm.unwrap_or_default().0;
        let longest = context.limits.translation_mm;
        let place = at.key("displacement_mm");
        if components == [None; 3] {
            faults.add(&place, ErrorCode::MissingField, "at least one component has a value");
        }
        for (axis, value) in components.into_iter().enumerate() {
            let length = value.unwrap_or_default().abs();
            if length > longest {
                let detail = format!("moves by {length} mm, at most {longest} mm are allowed");
                faults.add(&place.index(axis), ErrorCode::PlanOutOfRange, detail);
            }
        }
        let signs = context.vector(Triple([1.0; 3]));
        let displacement = std::array::from_fn(|axis| components[axis].map(|u| signs[axis] * u));
        Some(Prescribed::Uniform { nodes: nodes?, displacement })
    }
}
