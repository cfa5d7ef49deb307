//! What a plan means for the landmarks of a head: cephalometric measures and symmetry before, planned and predicted.

use std::collections::BTreeMap;

use crate::jobs::head::{Bone, Head, Skin};
use crate::schema::CaseDocument;
use crate::schema::predict::planned::{MeasureDocument, MovementReportDocument, SymmetryDocument};
use mechanics::cephalometry::Landmarks;
use mechanics::mesh::{Frame, Vector, Warning};
use mechanics::prediction::{Case, Scene};

type Places = BTreeMap<String, Vector>;

/// The segments that move.
pub fn movements(scene: &Scene, frame: Frame) -> Vec<MovementReportDocument> {
    let segments = scene.segments.iter();
    segments.filter_map(|segment| MovementReportDocument::new(segment, frame)).collect()
}

/// A head in numbers: every measure and every symmetry whose landmarks are there.
pub struct InNumbers {
    pub measures: Vec<MeasureDocument>,
    pub symmetry: Vec<SymmetryDocument>,
}

/// `displacement` is that of the landmarks of skin, where it is predicted.
pub fn in_numbers(
    document: &CaseDocument,
    case: &Case,
    scene: &Scene,
    displacement: Option<&Places>,
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

/// A warning for each pair of landmarks of bone whose sides look swapped.
pub fn swapped_sides(document: &CaseDocument, frame: Frame) -> Vec<Warning> {
    let landmarks = Bone::before(&document.bone_landmarks).before;
    let swapped = Landmarks(&landmarks).swapped_sides(frame).into_iter();
    swapped
        .map(|swapped| {
            Warning::new("landmarks-swapped", swapped.to_string()).with("by_mm", swapped.by)
        })
        .collect()
}

/// Landmarks where they are predicted.
fn after(landmarks: &Places, displacement: &Places) -> Places {
    let moved = |(name, at): (&String, &Vector)| {
        displacement.get(name).map(|displacement| (name.clone(), at + displacement))
    };
    landmarks.iter().filter_map(moved).collect()
}
