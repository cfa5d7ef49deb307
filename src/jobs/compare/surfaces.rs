//! Comparison of two surfaces.

use std::collections::BTreeMap;

use super::meshes::{ComparedMeshes, surface_of};
use crate::jobs::clock::Observed;
use crate::jobs::failure::JobError;
use crate::jobs::fetch::no_surface;
use crate::jobs::source::StoredMesh;
use crate::schema::code::ErrorCode;
use crate::schema::compare::document::{
    AlignDocument, AlignMethod, CompareToDocument, ComparedRegionDocument, LandmarkDocument,
    NodeWise as NodeWiseName, PlaceDocument, StartName,
};
use crate::schema::compare::result::ComparisonDocument;
use crate::schema::{Matrix4x4, Pointer, Problem};
use mechanics::mesh::{Frame, TriangleSurface, Vector, Warning};
use mechanics::registration::{RigidTransform, SphereOrBox, Start, align_points};
use mechanics::validation::distance::require_possible;
use mechanics::validation::{
    Alignment, BoneSurfaces, Comparison, ComparisonError, ComparisonSettings, LandmarkPair,
    NodeWise, Region, compare,
};

/// Result of a comparison.
pub struct ComparisonFindings {
    pub document: ComparisonDocument,
    /// At each point of the prediction in mm, positive outside the actual surface.
    pub signed_distance: Vec<f64>,
    /// As in [`Comparison`].
    pub node_errors: Option<Vec<f64>>,
    pub landmark_map: Option<Vec<f64>>,
    pub warnings: Vec<Warning>,
}

/// The two surfaces of a comparison and their places in the documents.
pub struct Pair<'a> {
    pub prediction: &'a TriangleSurface,
    pub prediction_frame: Option<Frame>,
    /// The displacement of each point of the prediction, in mm, if known.
    pub displacement: Option<&'a [Vector]>,
    /// Named parts of the prediction as its points.
    pub skin_regions: &'a BTreeMap<String, Vec<u32>>,
    pub meshes: &'a ComparedMeshes,
    pub at: Pointer,
}

impl Pair<'_> {
    pub fn compare(
        &self,
        spec: &CompareToDocument,
        clock: &Observed,
    ) -> Result<ComparisonFindings, JobError> {
        self.meshes.check_frames(self.prediction_frame, &self.at)?;
        let settings = self.settings(spec)?;
        let actual = surface_of(&self.meshes.actual, &self.at.key("actual").key("mesh"))?;
        let comparison = compare(self.prediction, &actual, &settings, clock)
            .map_err(|error| self.judge(error, clock))?;
        let mut document = ComparisonDocument::new(&comparison, spec.samples_per_mm2);
        document.acquisition = spec.acquisition.clone();
        let Comparison { signed_distance, node_errors, landmark_map, warnings, .. } = comparison;
        Ok(ComparisonFindings { document, signed_distance, node_errors, landmark_map, warnings })
    }

    /// The settings of a checked spec.
    fn settings(&self, spec: &CompareToDocument) -> Result<ComparisonSettings, JobError> {
        let mut regions = BTreeMap::new();
        for (name, region) in &spec.regions {
            let at = self.at.key("regions").key(name);
            regions.insert(name.clone(), self.region(region, &at)?);
        }
        let landmarks = spec.landmarks.iter();
        Ok(ComparisonSettings {
            alignment: self.alignment(&spec.align)?,
            report_unaligned: spec.align.report_unaligned,
            regions,
            samples_per_mm2: spec.samples_per_mm2,
            node_wise: match spec.node_wise {
                NodeWiseName::Auto => NodeWise::Auto,
                NodeWiseName::On => NodeWise::On,
                NodeWiseName::Off => NodeWise::Off,
            },
            landmarks: landmarks.map(|(name, pair)| (name.clone(), landmark_pair(pair))).collect(),
            histogram_edges: spec.histogram_edges_mm.clone(),
            displacement: self.displacement.map(<[Vector]>::to_vec),
        })
    }

    fn region(&self, region: &ComparedRegionDocument, at: &Pointer) -> Result<Region, JobError> {
        if let Some(length) = region.moved_by_more_than_mm {
            return Ok(Region::MovedByMoreThan(length));
        }
        if let Some(place) = place_of(&region.place()) {
            return Ok(Region::SphereOrBox(place));
        }
        let name = region.skin_region.as_deref().unwrap_or_default();
        let points = self.skin_regions.get(name).ok_or_else(|| {
            let known: Vec<&str> = self.skin_regions.keys().map(String::as_str).collect();
            let detail = format!(
                "the prediction has no part of the skin {name:?}; it has {}",
                if known.is_empty() { "none".to_owned() } else { known.join(", ") }
            );
            Problem::at(&at.key("skin_region"), ErrorCode::UnknownRegion, detail)
        })?;
        Ok(Region::Points(points.clone()))
    }

    /// The settings of a checked document.
    pub fn alignment(&self, align: &AlignDocument) -> Result<Alignment, JobError> {
        let mask = align.mask.as_ref().and_then(place_of);
        let pairs =
            || -> Vec<LandmarkPair> { align.landmarks.values().map(landmark_pair).collect() };
        Ok(match align.method {
            AlignMethod::None => Alignment::None,
            AlignMethod::Matrix => Alignment::Matrix(transform_of(align)),
            AlignMethod::Icp => Alignment::ClosestPoint { mask },
            AlignMethod::Landmarks => Alignment::Landmarks(pairs()),
            AlignMethod::Surfaces => {
                let start = match align.start.unwrap_or_default() {
                    StartName::None => Start::AsItLies,
                    StartName::Boxes => Start::Boxes,
                    StartName::Inertia => Start::Inertia,
                    StartName::Landmarks => Start::Known(by_landmarks(&pairs())?),
                };
                let at = self.at.key("align");
                let surface = |mesh: &Option<StoredMesh>, name: &str| {
                    let at = at.key(name).key("mesh");
                    mesh.as_ref().map_or_else(|| Err(no_surface(&at)), |m| surface_of(m, &at))
                };
                let fixed = surface(&self.meshes.fixed, "fixed")?;
                let moving = surface(&self.meshes.moving, "moving")?;
                Alignment::Surfaces(Box::new(BoneSurfaces { fixed, moving, mask, start }))
            }
        })
    }

    fn judge(&self, error: ComparisonError, clock: &Observed) -> JobError {
        let at = match &error {
            ComparisonError::Cancelled => return clock.stopped(),
            ComparisonError::Alignment(_) | ComparisonError::LandmarkOutside { .. } => {
                return JobError::Alignment(error.to_string());
            }
            ComparisonError::EmptyRegion { name } => self.at.key("regions").key(name),
            ComparisonError::NoDisplacement { region } => {
                self.at.key("regions").key(region).key("moved_by_more_than_mm")
            }
            ComparisonError::NotCorresponding { .. } => self.at.key("node_wise"),
            ComparisonError::TooManySamples { .. } => self.at.key("samples_per_mm2"),
            ComparisonError::Surface { .. } | ComparisonError::Statistics(_) => self.at.clone(),
        };
        JobError::Refused(Problem::at(&at, (&error).into(), error.to_string()))
    }
}

/// Refuses a surface with more samples than can be measured; `at` is the place of its comparison.
pub fn admit(surface: &StoredMesh, samples_per_mm2: f64, at: &Pointer) -> Result<(), JobError> {
    // What is no surface is refused by the job, with its place.
    let Some(surface) = surface.surface_in_mm() else { return Ok(()) };
    let possible = require_possible(&surface, samples_per_mm2).map_err(ComparisonError::from);
    possible.map_err(|error| {
        let at = at.key("samples_per_mm2");
        JobError::Refused(Problem::at(&at, (&error).into(), error.to_string()))
    })
}

fn landmark_pair(landmark: &LandmarkDocument) -> LandmarkPair {
    LandmarkPair { prediction: landmark.prediction_mm.into(), actual: landmark.actual_mm.into() }
}

/// The movement defined by landmarks of both surfaces.
pub fn by_landmarks(pairs: &[LandmarkPair]) -> Result<RigidTransform, JobError> {
    let (to, from): (Vec<Vector>, Vec<Vector>) =
        pairs.iter().map(|pair| (pair.prediction, pair.actual)).unzip();
    let found = align_points(&from, &to);
    found.map(|found| found.transform).map_err(|error| JobError::Alignment(error.to_string()))
}

/// The matrix of a checked document.
fn transform_of(align: &AlignDocument) -> RigidTransform {
    let Matrix4x4(matrix) = align.matrix4x4.unwrap_or_default();
    RigidTransform::from_matrix4(&matrix)
}

/// The part of space of a checked document.
pub fn place_of(document: &PlaceDocument) -> Option<SphereOrBox> {
    if let Some(sphere) = document.sphere_mm {
        let [x, y, z, radius] = sphere.0;
        return Some(SphereOrBox::Sphere { centre: Vector::new(x, y, z), radius });
    }
    let [x0, y0, z0, x1, y1, z1] = document.box_mm?.0;
    Some(SphereOrBox::Box { lower: Vector::new(x0, y0, z0), upper: Vector::new(x1, y1, z1) })
}
