//! Comparison of two surfaces.

use crate::jobs::clock::Observed;
use crate::jobs::failure::JobError;
use crate::jobs::fetch::no_surface;
use crate::jobs::source::StoredMesh;
use crate::schema::code::ErrorCode;
use crate::schema::compare::document::{
    AlignDocument, AlignMethod, CompareToDocument, NodeWise as NodeWiseName, PlaceDocument,
};
use crate::schema::compare::result::ComparisonDocument;
use crate::schema::{Pointer, Problem};
use mechanics::mesh::{Frame, TriangleSurface, Vector, Warning};
use mechanics::registration::Place;
use mechanics::validation::distance::require_possible;
use mechanics::validation::{
    Alignment, Comparison, ComparisonError, ComparisonSettings, LandmarkPair, NodeWise, compare,
};

/// What a comparison found.
pub struct Compared {
    pub document: ComparisonDocument,
    /// At each point of the prediction in mm, positive outside the actual surface.
    pub signed_distance: Vec<f64>,
    pub warnings: Vec<Warning>,
}

/// The two surfaces of a comparison and where in the documents they stand.
pub struct Pair<'a> {
    pub prediction: &'a TriangleSurface,
    pub prediction_frame: Option<Frame>,
    pub actual: &'a StoredMesh,
    pub at: Pointer,
}

impl Pair<'_> {
    pub fn compare(
        &self,
        spec: &CompareToDocument,
        clock: &Observed,
    ) -> Result<Compared, JobError> {
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

/// Refuses a surface of which more samples are wanted than can be measured; `at` is where its comparison stands.
pub fn admit(surface: &StoredMesh, samples_per_mm2: f64, at: &Pointer) -> Result<(), JobError> {
    // What is no surface is refused by the job, with its place.
    let Some(surface) = surface.surface_in_mm() else { return Ok(()) };
    let possible = require_possible(&surface, samples_per_mm2).map_err(ComparisonError::from);
    possible.map_err(|error| {
        let at = at.key("samples_per_mm2");
        JobError::Refused(Problem::at(&at, (&error).into(), error.to_string()))
    })
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
