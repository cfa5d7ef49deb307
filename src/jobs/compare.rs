//! Comparisons: two surfaces of a job of their own, or the predicted skin of a prediction.

use std::collections::BTreeMap;

use super::clock::Observed;
use super::failure::JobError;
use super::source::{MeshSource, SourceError, StoredMesh, StoredShape};
use super::work::{JobOutput, Workplace};
use crate::jobs::predict::check::warning_documents;
use crate::jobs::predict::input::{CompareInput, PredictInput, Prepared};
use crate::jobs::result::folder::ResultFolder;
use crate::jobs::result::provenance::{Origin, encode_result};
use crate::jobs::result::skin::PredictedSkin;
use crate::schema::ErrorCode;
use crate::schema::compare::document::{
    AlignDocument, AlignMethod, CompareToDocument, NodeWise as NodeWiseName, PlaceDocument,
};
use crate::schema::compare::result::ComparisonDocument;
use crate::schema::hashes;
use crate::schema::predict::document::OutputName;
use crate::schema::predict::result::ResultDocument;
use crate::schema::{Faults, Pointer, Problem};
use mechanics::format::vtk::vtp;
use mechanics::format::{ArrayValues, NamedValues, SurfaceOutput};
use mechanics::mesh::{Frame, TriangleSurface, Vector, Warning};
use mechanics::progress::{Phase, Progress};
use mechanics::registration::Place;
use mechanics::validation::{
    Alignment, Comparison, ComparisonError, ComparisonSettings, LandmarkPair, NodeWise, compare,
};

/// Time a comparison may take, in seconds; a prediction that compares has its own budget.
const WALL_S: f64 = 600.0;

/// What a comparison found.
pub struct Compared {
    pub document: ComparisonDocument,
    /// At each point of the prediction in mm, positive outside the actual surface.
    pub signed_distance: Vec<f64>,
    pub warnings: Vec<Warning>,
}

/// The two surfaces of a comparison and where in the documents they stand.
struct Pair<'a> {
    prediction: &'a TriangleSurface,
    prediction_frame: Option<Frame>,
    actual: &'a StoredMesh,
    at: Pointer,
}

/// Compares the predicted skin with what the spec names, if it names something.
pub fn compare_skin(
    input: &PredictInput,
    prepared: &Prepared,
    skin: &PredictedSkin,
    clock: &Observed,
) -> Result<Option<Compared>, JobError> {
    let (Some(spec), Some(actual)) = (&input.spec.compare_to, &prepared.actual) else {
        return Ok(None);
    };
    let at = Pointer::root().key("spec").key("compare_to");
    let frame = prepared.case.frame;
    let stated = (frame != Frame::Unspecified).then_some(frame);
    let pair = Pair { prediction: &skin.surface, prediction_frame: stated, actual, at };
    pair.compare(spec, clock).map(Some)
}

/// A comparison as a job of its own.
pub fn compare_job(
    input: &CompareInput,
    place: &Workplace,
    progress: &dyn Progress,
) -> Result<JobOutput, JobError> {
    let clock = Observed::start(progress, WALL_S);

    // 1. Documents and surfaces.
    let mut faults = Faults::default();
    input.spec.check(place.limits, &mut faults);
    faults.into_result()?;
    let at = Pointer::root().key("spec");
    let prediction = fetch_prediction(input, place.sources, &at.key("prediction"))?;
    let actual_id = &input.spec.actual.mesh;
    let actual = fetch(place.sources, actual_id, &at.key("actual").key("mesh"))?;
    clock.check()?;

    // 2. Distances.
    clock.phase(Phase::Compare);
    let wrong = || no_surface(&at.key("prediction"));
    let surface = prediction.surface_in_mm().ok_or_else(wrong)?;
    let frame = prediction.frame;
    let pair = Pair { prediction: &surface, prediction_frame: frame, actual: &actual, at };
    let compared = pair.compare(&input.spec.to_compare_to(), &clock)?;

    // 3. Files.
    clock.phase(Phase::Write);
    let origin = Origin {
        spec_hash: input.spec_hash(&prediction.sha256, &actual.sha256),
        inputs: vec![prediction.to_input("prediction"), actual.to_input("actual")],
        frame: frame.unwrap_or_default(),
        queue_s: input.queue_s,
    };
    let mut folder = ResultFolder::open(place.out)?;
    folder.add(OutputName::SkinVtp, &encode_distances(&surface, &compared, origin.frame)?)?;
    let warnings = prediction.warnings.iter().chain(&actual.warnings).chain(&compared.warnings);
    let result = ResultDocument {
        job: input.job.clone(),
        files: folder.files.clone(),
        statistics: None,
        comparison: Some(compared.document.clone()),
        optimisation: None,
        study: None,
        numerical_error_mm: None,
        reaction_mn: BTreeMap::new(),
        provenance: origin.provenance(&clock),
        warnings: warning_documents(warnings),
    };
    folder.add(OutputName::ResultJson, &encode_result(&result)?)?;
    Ok(JobOutput { result, files: folder.files })
}

impl CompareInput {
    fn spec_hash(&self, prediction: &str, actual: &str) -> String {
        let actual_id = &self.spec.actual.mesh;
        let content = |id: &str| match id == actual_id {
            true => Some(actual.to_owned()),
            false => Some(prediction.to_owned()),
        };
        hashes::compare_hash(&self.spec, &content)
    }
}

impl Pair<'_> {
    fn compare(&self, spec: &CompareToDocument, clock: &Observed) -> Result<Compared, JobError> {
        self.check_frames()?;
        let settings = settings(spec);
        let wrong = || no_surface(&self.at.key("actual").key("mesh"));
        let actual = self.actual.surface_in_mm().ok_or_else(wrong)?;
        let comparison = compare(self.prediction, &actual, &settings, clock)
            .map_err(|error| self.judge(error, clock))?;
        let Comparison { signed_distance, warnings, .. } = &comparison;
        Ok(Compared {
            document: ComparisonDocument::new(&comparison, spec.samples_per_mm2),
            signed_distance: signed_distance.clone(),
            warnings: warnings.clone(),
        })
    }

    /// Surfaces in different frames cannot be compared.
    fn check_frames(&self) -> Result<(), JobError> {
        match (self.prediction_frame, self.actual.frame) {
            (Some(prediction), Some(actual)) if prediction != actual => {
                let detail =
                    format!("the prediction is in frame {prediction}, the actual in {actual}");
                let at = self.at.key("actual").key("mesh");
                Err(Problem::at(&at, ErrorCode::FrameConflict, detail).into())
            }
            _ => Ok(()),
        }
    }

    fn judge(&self, error: ComparisonError, clock: &Observed) -> JobError {
        let at = match &error {
            ComparisonError::Cancelled => return clock.stopped(),
            ComparisonError::Alignment(_) | ComparisonError::LandmarkOutside { .. } => {
                return JobError::Alignment(error.to_string());
            }
            ComparisonError::EmptyRegion { name } => self.at.key("regions").key(name),
            ComparisonError::NotCorresponding { .. } => self.at.key("node_wise"),
            ComparisonError::TooManySamples { .. } => self.at.key("samples_per_mm2"),
            ComparisonError::Surface { .. } | ComparisonError::Statistics(_) => self.at.clone(),
        };
        JobError::Refused(Problem::at(&at, (&error).into(), error.to_string()))
    }
}

fn fetch_prediction(
    input: &CompareInput,
    sources: &dyn MeshSource,
    at: &Pointer,
) -> Result<StoredMesh, JobError> {
    match &input.spec.prediction.job {
        Some(job) => found(sources.predicted_skin(job), job, &at.key("job")),
        None => {
            let mesh = input.spec.prediction.mesh.clone().unwrap_or_default();
            fetch(sources, &mesh, &at.key("mesh"))
        }
    }
}

/// A mesh of the documents.
pub fn fetch(sources: &dyn MeshSource, id: &str, at: &Pointer) -> Result<StoredMesh, JobError> {
    found(sources.mesh(id), id, at)
}

/// A mesh that is not there or not a mesh is a mistake at a place of the documents.
pub(super) fn found(
    result: Result<StoredMesh, SourceError>,
    id: &str,
    at: &Pointer,
) -> Result<StoredMesh, JobError> {
    let found = result.map_err(|error| match error {
        SourceError::Unknown { .. } => {
            Problem::at(at, ErrorCode::UnknownMesh, format!("there is no mesh {id:?}")).into()
        }
        SourceError::Refused { code, detail, .. } => Problem::at(at, code, detail).into(),
        other => JobError::Source(other),
    })?;
    match found.shape {
        StoredShape::Image(_) => Err(no_surface(at)),
        _ => Ok(found),
    }
}

fn no_surface(at: &Pointer) -> JobError {
    Problem::at(at, ErrorCode::WrongMesh, "this is an image, and a mesh is needed").into()
}

/// `skin.vtp` of a comparison: the prediction with its distance at each point.
fn encode_distances(
    surface: &TriangleSurface,
    compared: &Compared,
    frame: Frame,
) -> Result<Vec<u8>, JobError> {
    let mut output = SurfaceOutput::plain(surface, frame);
    let values = ArrayValues::Reals(&compared.signed_distance);
    output.point_arrays = vec![NamedValues { name: "signed_distance_mm", values }];
    Ok(vtp::write(&output)?)
}

/// The settings of a spec that was checked.
fn settings(spec: &CompareToDocument) -> ComparisonSettings {
    let regions = spec.regions.iter();
    ComparisonSettings {
        alignment: alignment(&spec.align),
        report_unaligned: spec.align.report_unaligned,
        regions: regions
            .filter_map(|(name, region)| Some((name.clone(), place(region)?)))
            .collect(),
        samples_per_mm2: spec.samples_per_mm2,
        node_wise: match spec.node_wise {
            NodeWiseName::Auto => NodeWise::Auto,
            NodeWiseName::On => NodeWise::On,
            NodeWiseName::Off => NodeWise::Off,
        },
    }
}

fn alignment(align: &AlignDocument) -> Alignment {
    match align.method {
        AlignMethod::None => Alignment::None,
        AlignMethod::Icp => Alignment::ClosestPoint { mask: align.mask.as_ref().and_then(place) },
        AlignMethod::Landmarks => {
            let pairs = align.landmarks.values();
            let pair =
                |landmark: &crate::schema::compare::document::LandmarkDocument| LandmarkPair {
                    prediction: landmark.prediction_mm.into(),
                    actual: landmark.actual_mm.into(),
                };
            Alignment::Landmarks(pairs.map(pair).collect())
        }
    }
}

fn place(document: &PlaceDocument) -> Option<Place> {
    if let Some(sphere) = document.sphere_mm {
        let [x, y, z, radius] = sphere.0;
        return Some(Place::Sphere { centre: Vector::new(x, y, z), radius });
    }
    let [x0, y0, z0, x1, y1, z1] = document.box_mm?.0;
    Some(Place::Box { lower: Vector::new(x0, y0, z0), upper: Vector::new(x1, y1, z1) })
}
