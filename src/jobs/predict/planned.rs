//! What a plan means for the landmarks of a head: cephalometric measures before, planned and predicted.

use std::collections::BTreeMap;

use crate::schema::CaseDocument;
use crate::schema::predict::planned::{MeasureDocument, MovementReportDocument};
use mechanics::cephalometry::{Landmarks, MEASURES, Tissue};
use mechanics::mesh::{Frame, Vector, Warning};
use mechanics::plan::RigidMovement;
use mechanics::prediction::{Case, Scene};

type Places = BTreeMap<String, Vector>;

/// The segments that move.
pub fn movements(scene: &Scene, frame: Frame) -> Vec<MovementReportDocument> {
    let segments = scene.segments.iter();
    segments.filter_map(|segment| MovementReportDocument::new(segment, frame)).collect()
}

/// Every measure whose landmarks are there; `displacement` is that of the landmarks of skin, where it is predicted.
pub fn measures(
    document: &CaseDocument,
    case: &Case,
    scene: &Scene,
    displacement: Option<&Places>,
) -> Vec<MeasureDocument> {
    let (bone, planned) = (bone_landmarks(document), planned_landmarks(document, scene));
    let skin = &case.landmarks;
    let predicted = displacement.map(|moved| after(skin, moved));
    let mut found = Vec::new();
    for measure in &MEASURES {
        let (before, after) = match measure.tissue {
            Tissue::Bone => (&bone, Some(&planned)),
            Tissue::Skin => (skin, predicted.as_ref()),
        };
        let after = after.and_then(|landmarks| measure.of(&Landmarks(landmarks)));
        let before = measure.of(&Landmarks(before));
        found.extend(before.map(|before| MeasureDocument::new(measure, before, after)));
    }
    found
}

/// A warning for each pair of landmarks of bone whose sides look swapped.
pub fn swapped_sides(document: &CaseDocument, frame: Frame) -> Vec<Warning> {
    let landmarks = bone_landmarks(document);
    let swapped = Landmarks(&landmarks).swapped_sides(frame).into_iter();
    swapped
        .map(|swapped| {
            Warning::new("landmarks-swapped", swapped.to_string()).with("by_mm", swapped.by)
        })
        .collect()
}

fn bone_landmarks(document: &CaseDocument) -> Places {
    let landmarks = document.bone_landmarks.iter();
    landmarks.map(|(name, own)| (name.clone(), Vector::from(own.position_mm))).collect()
}

fn planned_landmarks(document: &CaseDocument, scene: &Scene) -> Places {
    let movement = |name: &str| {
        let segment = scene.segment(name).map(|number| &scene.segments[number]);
        segment.map_or_else(RigidMovement::default, |segment| segment.movement)
    };
    let landmarks = document.bone_landmarks.iter();
    landmarks
        .map(|(name, own)| {
            let movement = own.segment.as_deref().map(|segment| movement(segment.trim()));
            let at = Vector::from(own.position_mm);
            (name.clone(), movement.map_or(at, |movement| movement.apply(&at)))
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
