//! The job of a reproduction.

use std::borrow::Cow;
use std::collections::BTreeMap;

use super::doubts::{
    BEFORE_OPERATION, base_warnings, bone_in_common, lies_on_the_other_scan, misfit, reversed_plan,
    same_scan, turned_over, undetermined_movement, unmasked,
};
use super::input::ReproduceInput;
use crate::jobs::clock::Observed;
use crate::jobs::compare::{by_landmarks, place_of, surface_of};
use crate::jobs::failure::JobError;
use crate::jobs::head::{Bone, Head, Skin};
use crate::jobs::output::{JobContext, JobOutput};
use crate::jobs::result::folder::ResultFolder;
use crate::jobs::result::provenance::{Origin, encode_result};
use crate::jobs::result::warnings::warning_documents;
use crate::jobs::source::StoredMesh;
use crate::schema::case::document::FrameName;
use crate::schema::compare::document::{MeshReference, StartName};
use crate::schema::compare::result::StandardErrorDocument;
use crate::schema::plan::document::{PlanContext, PlanSegmentDocument};
use crate::schema::predict::document::OutputName;
use crate::schema::predict::result::ResultDocument;
use crate::schema::reproduce::document::{BoneLandmarkDocument, ReproducedSegmentDocument};
use crate::schema::reproduce::result::{
    BaseFitDocument, DeviationDocument, FitDocument, PerformedDocument, ReproductionDocument,
};
use crate::schema::{Faults, Limits, Matrix4x4, PlanDocument, Pointer};
use mechanics::mesh::{Frame, TriangleSurface, Vector, Warning};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::progress::{Phase, Progress};
use mechanics::registration::performed::{
    BoneBefore, Performed, align_base, align_base_from_any, performed,
};
use mechanics::registration::{AlignmentError, RigidTransform, Start};
use mechanics::validation::LandmarkPair;

/// Time a reproduction may take, in seconds.
const WALL_S: f64 = 600.0;

/// Below this angle in radians a rotation has no axis.
const NO_TURN: f64 = 1e-9;

/// Finds the movements of an operation.
pub fn reproduce_job(
    input: &ReproduceInput,
    place: &JobContext,
    progress: &dyn Progress,
) -> Result<JobOutput, JobError> {
    let clock = Observed::start(progress, WALL_S);

    // 1. Documents and surfaces.
    let mut faults = Faults::default();
    input.spec.check(place.limits, &mut faults);
    faults.into_result()?;
    let stored = input.fetch(place.sources)?;
    let frame = stored.get(&input.spec.before.mesh).and_then(|mesh| mesh.frame);
    let planned = planned(input, frame.unwrap_or_default(), place.limits)?;
    clock.check()?;

    // 2. Bone onto bone.
    clock.phase(Phase::Compare);
    let scene = Scans { input, stored: &stored, planned: &planned, clock: &clock };
    let (reproduction, warnings) = scene.reproduce(frame)?;

    // 3. Files.
    clock.phase(Phase::Write);
    let origin = Origin {
        spec_hash: input.spec_hash(&stored),
        inputs: inputs(input, &stored),
        frame: frame.unwrap_or_default(),
        queue_s: input.queue_s,
    };
    let mut folder = ResultFolder::open(place)?;
    let told = stored.values().flat_map(|mesh| &mesh.warnings).chain(&warnings);
    let head = head(input, &planned, &reproduction);
    let result = ResultDocument {
        cephalometry: head.measures(),
        symmetry: head.symmetry(),
        reproduction: Some(reproduction),
        ..ResultDocument::new(
            input.job.clone(),
            &folder.files,
            origin.provenance(&clock),
            warning_documents(told),
        )
    };
    folder.add(OutputName::ResultJson, &encode_result(&result)?)?;
    Ok(JobOutput { result, files: folder.files, meshes: Vec::new() })
}

/// The head before the operation, as planned and as performed.
fn head(input: &ReproduceInput, planned: &[PlannedSegment], found: &ReproductionDocument) -> Head {
    let landmarks = &input.spec.bone_landmarks;
    let as_planned = |name: &str, at: &Vector| {
        let segment = planned.iter().find(|segment| segment.name == name)?;
        Some(segment.movement.apply(at))
    };
    let as_performed = |name: &str, at: &Vector| {
        let segment = found.segments.iter().find(|segment| segment.name == name)?;
        let m = segment.matrix4x4.0;
        let row =
            |k: usize| Vector::new(m[4 * k], m[4 * k + 1], m[4 * k + 2]).dot(at) + m[4 * k + 3];
        Some(Vector::new(row(0), row(1), row(2)))
    };
    let bone = Bone::before(landmarks);
    let bone = match planned {
        [] => bone,
        _ => bone.planned(landmarks, &as_planned),
    };
    let bone = bone.performed(landmarks, &as_performed);
    Head { bone, skin: Skin::default(), norms: input.spec.norms.clone() }
}

/// The planned movements, in the frame before the operation.
fn planned(
    input: &ReproduceInput,
    frame: Frame,
    limits: &Limits,
) -> Result<Vec<PlannedSegment>, JobError> {
    let Some(plan) = &input.spec.planned else { return Ok(Vec::new()) };
    let mut faults = Faults::default();
    let at = Pointer::root().key("spec").key("planned");
    let plan = plan.to_plan(&at, &PlanContext { frame, centre: None, limits }, &mut faults);
    faults.into_result()?;
    Ok(plan.segments)
}

fn inputs(
    input: &ReproduceInput,
    stored: &BTreeMap<String, StoredMesh>,
) -> Vec<crate::schema::predict::result::InputDocument> {
    let mut spec = input.spec.clone();
    let named = spec.mesh_references_mut().into_iter();
    let role =
        |at: &Pointer| at.as_str().trim_start_matches('/').trim_end_matches("/mesh").to_owned();
    named.filter_map(|(at, id)| Some(stored.get(id.as_str())?.to_input(&role(&at)))).collect()
}

/// Bone of both scans.
struct Scans<'a> {
    input: &'a ReproduceInput,
    stored: &'a BTreeMap<String, StoredMesh>,
    planned: &'a [PlannedSegment],
    clock: &'a Observed<'a>,
}

impl Scans<'_> {
    fn reproduce(
        &self,
        frame: Option<Frame>,
    ) -> Result<(ReproductionDocument, Vec<Warning>), JobError> {
        let spec = &self.input.spec;
        let at = Pointer::root().key("spec");
        let before = self.surface(&spec.before.mesh, &at.key("before"))?;
        let after = self.surface(&spec.after.mesh, &at.key("after"))?;
        let start = start(spec.base.start.unwrap_or_default(), &spec.base.landmarks)?;
        let mask = spec.base.mask.as_ref().and_then(place_of);
        let bone = BoneBefore { surface: &before, mask, start };
        let (base, start) = match spec.base.start {
            Some(name) => align_base(&bone, &after, self.clock).map(|found| (found, name)),
            None => align_base_from_any(&bone, &after, self.clock)
                .map(|(found, start)| (found, name_of(start))),
        }
        .map_err(|error| self.failed(&error))?;
        let mut warnings = base_warnings(&bone, &after, &base);
        warnings.extend(unmasked(spec, &base));
        let scans = [&before, &after];
        let surfaces = self.segment_surfaces(scans)?;
        let (mut segments, mut all, mut bones) = (Vec::new(), Vec::new(), Vec::new());
        for (segment, [own, later]) in spec.segments.iter().zip(&surfaces) {
            let bone = BoneBefore {
                surface: own,
                mask: segment.mask.as_ref().and_then(place_of),
                start: self::start(segment.start, &segment.landmarks)?,
            };
            let found =
                performed(&bone, later, &base, self.clock).map_err(|error| self.failed(&error))?;
            warnings.extend(misfit(segment, &found).or_else(|| turned_over(segment, &found)));
            warnings.extend(undetermined_movement(segment, &base, &found));
            let plan = self.planned_of(segment).map(|planned| &planned.movement);
            let swapped = match segment.before {
                Some(_) => lies_on_the_other_scan(segment, &bone, scans, &base),
                None => plan.and_then(|plan| reversed_plan(segment, &found, plan)),
            };
            warnings.extend(swapped);
            segments.push(self.document(segment, &found));
            all.push(found);
            bones.push((segment, bone));
        }
        warnings.extend(bone_in_common(&bones));
        let is_swapped = warnings.iter().any(|told| told.code == BEFORE_OPERATION);
        warnings.extend(same_scan(&before, &after, &all).filter(|_| !is_swapped));
        let plan = PlanDocument {
            segments: segments.iter().map(plan_segment).collect(),
            frame: frame.map(FrameName::from),
            ..PlanDocument::default()
        };
        let matrix4x4 = Matrix4x4(base.transform.matrix4());
        let fit = FitDocument::from(&base);
        let base = BaseFitDocument { matrix4x4, start: Some(start), fit };
        Ok((ReproductionDocument { plan, base, segments }, warnings))
    }

    /// The bone of each segment before the operation and after it, of the scans where it has none of its own.
    fn segment_surfaces<'s>(
        &self,
        [before, after]: [&'s TriangleSurface; 2],
    ) -> Result<Vec<[Cow<'s, TriangleSurface>; 2]>, JobError> {
        let own = |mesh: &Option<MeshReference>, scan: &'s TriangleSurface, at: &Pointer| {
            Ok::<_, JobError>(match mesh {
                Some(own) => Cow::Owned(self.surface(&own.mesh, at)?),
                None => Cow::Borrowed(scan),
            })
        };
        let at = Pointer::root().key("spec").key("segments");
        let surfaces = self.input.spec.segments.iter().enumerate().map(|(index, segment)| {
            let at = at.index(index);
            let before = own(&segment.before, before, &at.key("before"))?;
            Ok([before, own(&segment.after, after, &at.key("after"))?])
        });
        surfaces.collect()
    }

    fn surface(&self, id: &str, at: &Pointer) -> Result<TriangleSurface, JobError> {
        let missing = || crate::jobs::fetch::no_surface(&at.key("mesh"));
        surface_of(self.stored.get(id).ok_or_else(missing)?, &at.key("mesh"))
    }

    fn planned_of(&self, segment: &ReproducedSegmentDocument) -> Option<&PlannedSegment> {
        self.planned.iter().find(|planned| planned.name == segment.name.trim())
    }

    fn document(
        &self,
        segment: &ReproducedSegmentDocument,
        found: &Performed,
    ) -> PerformedDocument {
        let (movement, centre) = (&found.movement, &found.centre);
        let name = segment.name.trim().to_owned();
        let plan = self.planned_of(segment);
        PerformedDocument {
            matrix4x4: Matrix4x4(movement.matrix4()),
            rotation_deg: movement.angle().to_degrees(),
            axis: axis(movement).into(),
            centre_mm: (*centre).into(),
            displacement_mm: (movement.apply(centre) - centre).into(),
            standard_error: StandardErrorDocument::from(found.standard_error.as_ref()),
            fit: FitDocument::from(&found.fit),
            from_planned: plan.map(|plan| deviation(found, &plan.movement)),
            name,
        }
    }

    fn failed(&self, error: &AlignmentError) -> JobError {
        match error {
            AlignmentError::Cancelled { .. } => self.clock.stopped(),
            other => JobError::Alignment(other.to_string()),
        }
    }
}

fn start(
    name: StartName,
    landmarks: &BTreeMap<String, BoneLandmarkDocument>,
) -> Result<Start, JobError> {
    let pair = |landmark: &BoneLandmarkDocument| LandmarkPair {
        prediction: landmark.before_mm.into(),
        actual: landmark.after_mm.into(),
    };
    Ok(match name {
        StartName::None => Start::AsItLies,
        StartName::Boxes => Start::Boxes,
        StartName::Inertia => Start::Inertia,
        StartName::Landmarks => {
            Start::Known(by_landmarks(&landmarks.values().map(pair).collect::<Vec<_>>())?)
        }
    })
}

fn name_of(start: Start) -> StartName {
    match start {
        Start::AsItLies => StartName::None,
        Start::Boxes => StartName::Boxes,
        Start::Inertia => StartName::Inertia,
        Start::Known(_) => StartName::Landmarks,
    }
}

/// The axis of the rotation of a movement, right-handed.
fn axis(movement: &RigidTransform) -> Vector {
    let r = &movement.rotation;
    let twice_sine =
        Vector::new(r[(2, 1)] - r[(1, 2)], r[(0, 2)] - r[(2, 0)], r[(1, 0)] - r[(0, 1)]);
    twice_sine.try_normalize(NO_TURN).unwrap_or_else(Vector::zeros)
}

fn deviation(found: &Performed, planned: &RigidMovement) -> DeviationDocument {
    let planned =
        RigidTransform { rotation: *planned.rotation(), translation: planned.translation() };
    let beyond = planned.inverse().then(&found.movement);
    let shift = found.movement.apply(&found.centre) - planned.apply(&found.centre);
    DeviationDocument { rotation_deg: beyond.angle().to_degrees(), displacement_mm: shift.into() }
}

fn plan_segment(segment: &PerformedDocument) -> PlanSegmentDocument {
    PlanSegmentDocument {
        name: segment.name.clone(),
        matrix4x4: Some(segment.matrix4x4),
        ..PlanSegmentDocument::default()
    }
}
