//! The steps of a conformation: a similarity, an affine map, and lattices from coarse to fine.
//!
//! Source of the order, skin first and bone second: Chabanas, Luboz, Payan, Medical Image Analysis 7 (2003) 131, section
//! 3.5.3, who fit octree splines (Szeliski, Lavallee 1996); here only control points near the tissue exist.

use super::covering::Covering;
use super::deformation::Deformation;
use super::error::ConformationError;
use super::landmark::{self, Landmark};
use super::outlier::{DoubtfulLandmark, doubtful};
use super::schedule::{LATTICES, levels};
use super::start::Start;
use super::surfaces::{Pair, Patient, Surfaces, Template};
use crate::progress::{Phase, Progress};

/// The map from template to patient, and what it leaves.
#[derive(Clone, Debug, PartialEq)]
pub struct Conformation {
    pub deformation: Deformation,
    /// Of every point of the template's skin or bone to that of the patient, in mm.
    pub skin_distances: Vec<f64>,
    pub bone_distances: Vec<f64>,
    /// In the order of the landmarks, in mm.
    pub landmark_distances: Vec<f64>,
    /// Points of the template's skin with a partner, and all of them.
    pub partners: [usize; 2],
    /// What covers the patient's skin, and was left out.
    pub covering: Covering,
    /// Landmarks far from where the others and the surfaces put them.
    pub doubtful: Vec<DoubtfulLandmark>,
}

impl Conformation {
    /// Whether a landmark was found to lie elsewhere, and was not used.
    pub fn leaves_out(&self, landmark: &str) -> bool {
        self.doubtful.iter().any(|own| own.is_left_out && own.name == landmark)
    }
}

/// Brings a template to a patient.
pub fn conform(
    template: &Template,
    patient: &Patient,
    start: Start,
    progress: &dyn Progress,
) -> Result<Conformation, ConformationError> {
    conform_on(LATTICES, template, patient, start, progress)
}

/// The same on so many lattices, [`LATTICES`] or fewer: without the finest ones a template follows a patient less closely, and its cells
/// are distorted less.
pub fn conform_on(
    lattices: i32,
    template: &Template,
    patient: &Patient,
    start: Start,
    progress: &dyn Progress,
) -> Result<Conformation, ConformationError> {
    progress.phase(Phase::Solve);
    let surfaces = Surfaces::new(template, patient)?;
    if surfaces.skin.is_none() && surfaces.bone.is_none() && patient.landmarks.is_empty() {
        return Err(ConformationError::NothingToFit);
    }
    landmark::refuse_distant(patient.landmarks, template.mesh)?;
    let (doubtful, landmarks) = doubtful(&surfaces, patient, start, progress)?;
    let used = Patient { landmarks: &landmarks, ..*patient };
    let levels = levels(surfaces.bone.is_some(), lattices);
    let deformation = surfaces.fitted(&used, start, &levels, progress)?;
    let found = measured(deformation, &surfaces, patient.landmarks);
    Ok(Conformation { doubtful, ..found })
}

fn measured(deformation: Deformation, surfaces: &Surfaces, landmarks: &[Landmark]) -> Conformation {
    let (skin, bone) = (surfaces.skin.as_ref(), surfaces.bone.as_ref());
    let moved = |pair: &Pair| pair.sheet.moved(|x| deformation.apply(x));
    let distances = |pair: Option<&Pair>| {
        pair.map_or(Vec::new(), |pair| pair.target.distances(&moved(pair).points))
    };
    let left = |one: &Landmark| (deformation.apply(&one.template) - one.patient).norm();
    Conformation {
        skin_distances: distances(skin),
        bone_distances: distances(bone),
        landmark_distances: landmarks.iter().map(left).collect(),
        partners: skin.map_or([0, 0], |pair| pair.target.partners(&moved(pair))),
        covering: skin.map(|pair| pair.covering).unwrap_or_default(),
        doubtful: Vec::new(),
        deformation,
    }
}
