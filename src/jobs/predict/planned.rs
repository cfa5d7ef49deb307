//! Landmarks of a head under a plan: cephalometric measures and symmetry before, planned and predicted.

use std::collections::BTreeMap;

use crate::jobs::head::{Bone, Head, Skin};
use crate::schema::CaseDocument;
use crate::schema::predict::planned::{MeasureDocument, MovementReportDocument, SymmetryDocument};
use mechanics::cephalometry::Landmarks;
use mechanics::mesh::{Frame, Vector, VolumeMesh, Warning};
use mechanics::prediction::{Case, Scene};

/// The least extent of landmarks of a head: smaller ones are in metres.
const CROWDED_MM: f64 = 1.0;

type NamedPoints = BTreeMap<String, Vector>;

/// The segments that move.
pub fn movements(scene: &Scene, frame: Frame) -> Vec<MovementReportDocument> {
    let segments = scene.segments.iter();
    segments.filter_map(|segment| MovementReportDocument::new(segment, frame)).collect()
}

/// Measures of a head: every measure and every symmetry whose landmarks are all given.
pub struct InNumbers {
    pub measures: Vec<MeasureDocument>,
    pub symmetry: Vec<SymmetryDocument>,
}

/// `displacement` is that of the landmarks of skin, if predicted.
pub fn in_numbers(
    document: &CaseDocument,
    case: &Case,
    scene: &Scene,
    displacement: Option<&NamedPoints>,
) -> InNumbers {
    let landmarks = &document.bone_landmarks;
    let moved = |segment: &str, at: &Vector| {
        let number = scene.segment(segment);
        number.map(|number| scene.segments[number].movement.apply(at))
    };
    let bone = Bone::before(landmarks).planned(landmarks, &moved);
    let predicted = displacement.map(|moved| after(&case.landmarks, moved));
    let skin = Skin { before: case.landmarks.clone(), predicted };
    let head = Head { bone, skin, norms: document.norms.clone() };
    InNumbers { measures: head.measures(), symmetry: head.symmetry() }
}

/// Warnings on landmarks of bone: sides that look swapped, positions and extents that are implausible for this mesh.
pub fn suspect_landmarks(document: &CaseDocument, case: &Case) -> Vec<Warning> {
    let landmarks = Bone::before(&document.bone_landmarks).before;
    let swapped = Landmarks(&landmarks).swapped_sides(case.frame).into_iter();
    let swapped = swapped.map(|swapped| {
        Warning::new("landmarks-swapped", swapped.to_string()).with("by_mm", swapped.by)
    });
    swapped.chain(elsewhere(&landmarks, &case.volume)).chain(crowded(&landmarks)).collect()
}

/// Landmarks farther from the box of the mesh than half its diagonal.
fn elsewhere(landmarks: &NamedPoints, mesh: &VolumeMesh) -> Vec<Warning> {
    let [low, high] = mesh.bounds();
    let away = |at: &Vector| (at - at.sup(&low).inf(&high)).norm();
    let far = landmarks.iter().filter(|(_, at)| away(at) > 0.5 * (high - low).norm());
    far.map(|(name, at)| {
        let detail = format!(
            "landmark {name:?} of bone is {:.0} mm from the box of the mesh: is it in mm, in the frame of the case?",
            away(at)
        );
        Warning::new("landmark-far", detail).with("distance_mm", away(at))
    })
    .collect()
}

/// Several landmarks of bone within a millimetre.
fn crowded(landmarks: &NamedPoints) -> Option<Warning> {
    let first = landmarks.values().next().filter(|_| landmarks.len() > 1)?;
    let extent = landmarks.values().map(|at| (at - first).norm()).fold(0.0, f64::max);
    let detail = format!(
        "all {} landmarks of bone are within {extent:.3} mm: positions have to be in mm",
        landmarks.len()
    );
    (extent < CROWDED_MM)
        .then(|| Warning::new("landmarks-crowded", detail).with("extent_mm", extent))
}

/// Predicted landmarks.
fn after(landmarks: &NamedPoints, displacement: &NamedPoints) -> NamedPoints {
    let moved = |(name, at): (&String, &Vector)| {
        displacement.get(name).map(|displacement| (name.clone(), at + displacement))
    };
    landmarks.iter().filter_map(moved).collect()
}
