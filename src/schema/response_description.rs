//! Description of a response: the layout of its columns, and the data to apply a plan.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::code::ErrorCode;
use super::inner_column::{InnerColumnDocument, inner_amounts};
use super::response_edges::{ResponseEdgesDocument, torn};
use super::response_part::ResponsePartDocument;
use super::second_order::{ColumnsDocument, LinearityDocument, SecondOrderDocument};
use super::{CornerPair, Triple, WarningDocument};
use crate::schema::case::document::FrameName;
use crate::schema::engine::EngineDocument;
use crate::schema::plan::document::{PlanContext, PlanDocument, PlanSegmentDocument};
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use crate::schema::wire::problem::Problem;
use mechanics::boundary::ConnectedPart;
use mechanics::mesh::ignored::listed;
use mechanics::mesh::{Frame, Vector, Warning};
use mechanics::plan::RigidMovement;
use mechanics::plan::doubt::{MovedSegment, nothing_moves, suspect_units, too_far};
use mechanics::prediction::{RigidlyCarried, is_normal_turned, normal_turned, rigidly_carried};
use mechanics::response::linearity::LINEAR_RANGE_MM;
use mechanics::response::{Columns, InnerLoad, Linearity, ResponseSegment, SampledSecond};

/// Description of a response: the layout of its columns, and the data to apply a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ResponseDescription {
    /// The job that built it; absent in results of the command line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub job: Option<String>,
    /// SHA-256 over everything that determines the columns.
    pub key: String,
    pub engine: EngineDocument,
    pub frame: FrameName,
    /// Column 12 s + 4 i + j of the s-th segment multiplies (R - I)_ij (j < 3) or t_i (j = 3).
    pub segments: Vec<ResponseSegmentDocument>,
    /// Growth and muscles, a column each after those of the segments.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inner_columns: Vec<InnerColumnDocument>,
    /// The regions of the case; absent in responses of earlier programs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub regions: Vec<String>,
    /// Segments of the case that are fixed.
    pub staying: Vec<String>,
    /// Nodes of the volume mesh, ascending: the order within a column.
    pub node_ids: Vec<u32>,
    pub columns: ColumnsDocument,
    pub linearity: LinearityDocument,
    /// Absent of a response of order 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub second_order: Option<SecondOrderDocument>,
    /// The centre of the bounding box of the mesh; its displacement is limited.
    pub mesh_centre_mm: Triple,
    /// The diagonal of that box: no segment may move farther. 0 if unknown.
    #[serde(default)]
    pub mesh_diagonal_mm: f64,
    /// Whether plans may move tissue rigidly.
    #[serde(default)]
    pub allow_unfixed: bool,
    /// Connected parts of the mesh, and their constraints.
    #[serde(default)]
    pub parts: Vec<ResponsePartDocument>,
    /// Where a plan may tear the tissue; absent in responses of earlier programs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub edges_between: Option<Vec<ResponseEdgesDocument>>,
    /// Of the case and its mesh, independent of the plan: each applied plan repeats them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<WarningDocument>,
}

/// A segment that the columns can move: x' = x + (R - I)(x - centre) + t.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ResponseSegmentDocument {
    pub name: String,
    /// The origin of x: the mean of the segment's nodes.
    pub centre_mm: Triple,
    /// The box around the segment's nodes.
    pub box_mm: CornerPair,
    /// Whether tissue slides on a wall that moves with the segment.
    #[serde(default)]
    pub carries_wall: bool,
}

impl ResponseSegmentDocument {
    /// The lowest and the highest corner of its box.
    fn corners(&self) -> [Vector; 2] {
        let CornerPair([a, b, c, d, e, f]) = self.box_mm;
        [Vector::new(a, b, c), Vector::new(d, e, f)]
    }
}

/// A plan as factors of the columns of a response.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanAmounts {
    /// One for each segment.
    pub movements: Vec<RigidMovement>,
    /// Of each column of growth and muscles.
    pub inner: Vec<f64>,
    /// On the numbers as they were stated.
    pub doubts: Vec<Warning>,
}

/// The origin of a response.
pub struct ResponseOrigin {
    pub job: Option<String>,
    pub key: String,
    pub frame: Frame,
    pub mesh_centre: Vector,
    pub regions: Vec<String>,
    pub staying: Vec<String>,
    pub columns: ColumnsDocument,
    pub second_order: Option<SecondOrderDocument>,
    pub warnings: Vec<WarningDocument>,
}

impl ResponseDescription {
    pub fn new(columns: &Columns, origin: ResponseOrigin) -> Self {
        let segments = columns.segments.iter().zip(&columns.linearity.boxes);
        let segments = segments.zip(&columns.carries_wall);
        let names: Vec<String> = columns.segments.iter().map(|of| of.name.clone()).collect();
        let parts = columns.parts.iter().map(|part| ResponsePartDocument::new(part, &names));
        ResponseDescription {
            job: origin.job,
            key: origin.key,
            engine: EngineDocument::this(),
            frame: origin.frame.into(),
            segments: segments
                .map(|((segment, [low, high]), &carries_wall)| ResponseSegmentDocument {
                    name: segment.name.clone(),
                    centre_mm: segment.centre.into(),
                    box_mm: CornerPair([low.x, low.y, low.z, high.x, high.y, high.z]),
                    carries_wall,
                })
                .collect(),
            inner_columns: columns.inner.iter().map(InnerColumnDocument::new).collect(),
            regions: origin.regions,
            staying: origin.staying,
            node_ids: columns.nodes.clone(),
            columns: origin.columns,
            linearity: LinearityDocument {
                thickness_mm: columns.linearity.thickness,
                something_stays: columns.linearity.something_stays,
                second_order_mm: columns.linearity.sampled.iter().map(|of| of.second).collect(),
                second_order_coupling: columns.linearity.coupling.clone(),
                range_mm: LINEAR_RANGE_MM,
            },
            second_order: origin.second_order,
            mesh_centre_mm: origin.mesh_centre.into(),
            mesh_diagonal_mm: columns.diagonal,
            allow_unfixed: columns.allow_unfixed,
            parts: parts.collect(),
            edges_between: Some(ResponseEdgesDocument::all(&columns.edges_between, &names)),
            warnings: origin.warnings,
        }
    }

    pub fn response_segments(&self) -> Vec<ResponseSegment> {
        let segments = self.segments.iter();
        segments
            .map(|segment| ResponseSegment {
                name: segment.name.clone(),
                centre: segment.centre_mm.into(),
            })
            .collect()
    }

    /// The subjects of its columns of growth and muscles.
    pub fn inner_loads(&self) -> Vec<InnerLoad> {
        self.inner_columns.iter().map(InnerColumnDocument::to_load).collect()
    }

    pub fn to_linearity(&self) -> Linearity {
        Linearity {
            thickness: self.linearity.thickness_mm,
            something_stays: self.linearity.something_stays,
            boxes: self.segments.iter().map(ResponseSegmentDocument::corners).collect(),
            sampled: { self.segments.iter().zip(&self.linearity.second_order_mm) }
                .map(|(segment, &second)| SampledSecond {
                    centre: segment.centre_mm.into(),
                    second,
                })
                .collect(),
            coupling: self.linearity.second_order_coupling.clone(),
        }
    }

    /// One movement for each segment of the response, and the amount of each of its other columns; segments absent in the plan
    /// stay. Pointers start at `/plan`.
    pub fn amounts(&self, plan: &PlanDocument, limits: &Limits) -> Result<PlanAmounts, Problem> {
        let mut faults = Faults::default();
        let at = Pointer::root().key("plan");
        for (name, is_empty) in [
            ("prescribed", plan.prescribed.is_empty()),
            ("loads", plan.loads.is_empty()),
            ("osteotomy", plan.osteotomy.is_none()),
        ] {
            if !is_empty {
                let detail = format!("a response takes movements of segments and no `{name}`");
                faults.add(&at.key(name), ErrorCode::NotInResponse, detail);
            }
        }
        let segments_only = PlanDocument {
            segments: plan.segments.clone(),
            frame: plan.frame,
            ..PlanDocument::default()
        };
        let centre = self.mesh_centre_mm.into();
        let context = PlanContext { frame: self.frame.into(), centre: Some(centre), limits };
        let planned = segments_only.to_plan(&at, &context, &mut faults).segments;
        for (index, segment) in plan.segments.iter().enumerate() {
            let name = segment.name.trim();
            let movement = planned.iter().find(|planned| planned.name == name);
            let moves =
                movement.is_some_and(|planned| planned.movement != RigidMovement::default());
            let place = at.key("segments").index(index).key("name");
            self.check_name(name, moves, &place, &mut faults);
        }
        let known = (self.inner_columns.as_slice(), self.regions.as_slice());
        let (inner, suspect) = inner_amounts(known, plan, &at, limits, &mut faults);
        faults.into_result()?;
        let by_name: BTreeMap<&str, RigidMovement> =
            planned.iter().map(|segment| (segment.name.as_str(), segment.movement)).collect();
        let of = |segment: &ResponseSegmentDocument| by_name.get(segment.name.trim()).copied();
        let movements: Vec<RigidMovement> =
            self.segments.iter().map(|segment| of(segment).unwrap_or_default()).collect();
        self.check_whole(plan, &movements, &at)?;
        let doubts = plan.doubts().into_iter().chain(suspect).collect();
        Ok(PlanAmounts { movements, inner, doubts })
    }

    /// Refuses what a prediction of the same plan refuses: segments that go too far, and a face that moves rigidly.
    fn check_whole(
        &self,
        plan: &PlanDocument,
        movements: &[RigidMovement],
        at: &Pointer,
    ) -> Result<(), Problem> {
        let is_known = self.mesh_diagonal_mm > 0.0;
        let diagonal = if is_known { self.mesh_diagonal_mm } else { f64::INFINITY };
        if let Some(far) = too_far(&self.moved(movements), diagonal) {
            let named = |own: &PlanSegmentDocument| own.name.trim() == far.name().trim();
            let index = plan.segments.iter().position(named).unwrap_or_default();
            let at = at.key("segments").index(index);
            return Err(Problem::at(&at, ErrorCode::PlanOutOfRange, far.to_string()));
        }
        match self.rigidly_carried(movements).refused.into_iter().next() {
            Some(detail) => Err(Problem::at(at, ErrorCode::NothingHeld, detail)),
            None => Ok(()),
        }
    }

    /// The parts that a plan would move rigidly, if that is not allowed.
    fn rigidly_carried(&self, movements: &[RigidMovement]) -> RigidlyCarried {
        if self.allow_unfixed {
            return RigidlyCarried::default();
        }
        let segments: Vec<String> = self.segments.iter().map(|of| of.name.clone()).collect();
        let parts: Vec<ConnectedPart> =
            self.parts.iter().map(|part| part.to_part(&segments)).collect();
        rigidly_carried(&parts, |segment| movements[segment as usize])
    }

    /// Warnings on the skin of a plan: of the plan, then of the case.
    pub fn warnings_of(&self, amounts: &PlanAmounts) -> Vec<WarningDocument> {
        let movements = &amounts.movements[..];
        let still = movements.iter().all(|movement| *movement == RigidMovement::default())
            && amounts.inner.iter().all(|amount| *amount == 0.0);
        let order = if self.second_order.is_some() { 2 } else { 1 };
        let turned = self
            .carriers(movements)
            .filter_map(|(name, movement)| normal_turned(name, movement, order));
        let warnings = still.then(nothing_moves).into_iter();
        let warnings = warnings.chain(suspect_units(&self.moved(movements)));
        let warnings = warnings.chain(amounts.doubts.iter().cloned()).chain(turned);
        let warnings = warnings.chain(self.rigidly_carried(movements).told);
        let warnings = warnings.chain(self.torn(movements));
        let of_plan = warnings.map(|warning| WarningDocument::from(&warning));
        of_plan.chain(self.warnings.iter().cloned()).collect()
    }

    fn torn(&self, movements: &[RigidMovement]) -> Option<Warning> {
        let segments: Vec<&str> = self.segments.iter().map(|of| of.name.as_str()).collect();
        torn(self.edges_between.as_ref()?, &segments, movements)
    }

    /// Whether a wall turns with its segment, so that what linearity leaves out is not known.
    pub fn is_wall_turned(&self, movements: &[RigidMovement]) -> bool {
        self.carriers(movements).any(|(_, movement)| is_normal_turned(movement))
    }

    /// The segments that carry walls.
    fn carriers<'a>(
        &'a self,
        movements: &'a [RigidMovement],
    ) -> impl Iterator<Item = (&'a str, &'a RigidMovement)> {
        let pairs = self.segments.iter().zip(movements).filter(|(of, _)| of.carries_wall);
        pairs.map(|(of, movement)| (of.name.as_str(), movement))
    }

    fn moved<'a>(&'a self, movements: &'a [RigidMovement]) -> Vec<MovedSegment<'a>> {
        let segments = self.segments.iter().zip(movements);
        segments
            .map(|(segment, movement)| {
                let (name, corners) = (segment.name.as_str(), segment.corners());
                MovedSegment { name, movement, corners }
            })
            .collect()
    }

    fn check_name(&self, name: &str, moves: bool, at: &Pointer, faults: &mut Faults) {
        let mut known = self.segments.iter().map(|segment| segment.name.trim());
        if known.any(|known| known == name) {
            return;
        }
        if !self.staying.iter().any(|staying| staying.trim() == name) {
            let names = listed(self.segments.iter().map(|other| &other.name));
            let detail = format!("the case has no segment {name:?}; the response moves {names}");
            faults.add(at, ErrorCode::UnknownSegment, detail);
        } else if moves {
            let detail =
                format!("the response was built without segment {name:?}, which cannot move");
            faults.add(at, ErrorCode::NotInResponse, detail);
        }
    }
}
