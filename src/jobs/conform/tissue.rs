//! Muscle lines and fibre directions of a template, mapped to the patient.

use super::input::PreparedConformation;
use crate::schema::case::document::{FrameName, LengthUnit};
use crate::schema::case::fibre::FibreDocument;
use crate::schema::case::muscle::{MuscleDocument, REACH_MM, USUAL_REACH_MM};
use crate::schema::conform::document::{ConformDocument, MuscleMapName};
use crate::schema::conform::result::{MapDifferenceDocument, MappedMuscleDocument};
use crate::schema::{CaseDocument, Limits, Triple};
use mechanics::conformation::{
    Deformation, Warp, cell_axes, fibre_difference, mapped_lines, spline_of,
};
use mechanics::mesh::{Vector, VolumeMesh};
use mechanics::registration::ThinPlateSpline;

/// Positions of lines are rounded to this fraction of a mm.
const PARTS_OF_MM: f64 = 1e6;

/// The maps between a template and a patient.
pub(super) struct TissueMaps<'a> {
    template: &'a VolumeMesh,
    conformation: &'a Deformation,
    /// Through all landmarks, if they define one.
    spline: Option<ThinPlateSpline>,
    by: MuscleMapName,
    most_points: usize,
}

impl<'a> TissueMaps<'a> {
    /// Whether muscles can be mapped by landmarks, if requested, was checked with the document.
    pub fn new(
        prepared: &'a PreparedConformation,
        conformation: &'a Deformation,
        by: MuscleMapName,
        limits: &Limits,
    ) -> Self {
        TissueMaps {
            template: &prepared.template,
            conformation,
            spline: spline_of(&prepared.landmarks).ok(),
            by,
            most_points: limits.map_entries as usize,
        }
    }

    /// The requested map, and the other one if both exist.
    fn maps(&self) -> (&dyn Warp, Option<&dyn Warp>) {
        let conformation: &dyn Warp = self.conformation;
        match (self.by, &self.spline) {
            (MuscleMapName::Conformation, Some(spline)) => (conformation, Some(spline)),
            (MuscleMapName::Landmarks, Some(spline)) => (spline, Some(conformation)),
            (MuscleMapName::Conformation | MuscleMapName::Landmarks, None) => (conformation, None),
        }
    }

    /// The muscles and materials of the template in a case of the patient; fibres that had one direction become arrays of
    /// its mesh.
    pub fn bring(
        &self,
        case: &mut CaseDocument,
        mesh: &mut VolumeMesh,
    ) -> Vec<MappedMuscleDocument> {
        for (region, material) in case.materials.iter_mut().flatten() {
            if let Some(fibre) = &mut material.fibre {
                let FibreDocument { direction, array, .. } = fibre;
                self.bring_direction(direction, array, region, mesh);
            }
        }
        let mut told = Vec::new();
        for muscle in &mut case.muscles {
            let MuscleDocument { direction, array, name, .. } = muscle;
            self.bring_direction(direction, array, name, mesh);
            told.extend(self.bring_lines(muscle));
        }
        told
    }

    fn bring_direction(
        &self,
        direction: &mut Option<Triple>,
        array: &mut Option<String>,
        of: &str,
        mesh: &mut VolumeMesh,
    ) {
        let Some(uniform) = direction.take() else { return };
        let name = unused(mesh, of);
        let axes = cell_axes(self.maps().0, self.template, &Vector::from(uniform));
        mesh.cell_vectors.insert(name.clone(), axes);
        *array = Some(name);
    }

    fn bring_lines(&self, muscle: &mut MuscleDocument) -> Option<MappedMuscleDocument> {
        let lines = muscle.lines_mm.as_mut()?;
        let points = |line: &Vec<Triple>| line.iter().map(|&point| Vector::from(point)).collect();
        let before: Vec<Vec<Vector>> = lines.iter().map(points).collect();
        let (map, other) = self.maps();
        let mapped = mapped_lines(map, &before, self.most_points);
        let difference = other.and_then(|other| fibre_difference(map, other, &before));
        let rounded = |x: &Vector| Triple::from(x.map(|c| (c * PARTS_OF_MM).round() / PARTS_OF_MM));
        *lines = mapped.lines.iter().map(|line| line.iter().map(rounded).collect()).collect();
        let (least, most) = REACH_MM;
        let within = muscle.within_mm.unwrap_or(USUAL_REACH_MM) * mapped.widening;
        muscle.within_mm = Some(within.clamp(least, most));
        Some(MappedMuscleDocument {
            name: muscle.name.clone(),
            lines: lines.len() as u64,
            template_length_mm: mapped.lengths[0],
            length_mm: mapped.lengths[1],
            widening: mapped.widening,
            beside_other_map: difference.map(MapDifferenceDocument::from),
        })
    }
}

/// A name for an array of fibres that is not in the mesh.
fn unused(mesh: &VolumeMesh, of: &str) -> String {
    let of: String = of.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    let has =
        |name: &String| mesh.cell_vectors.contains_key(name) || mesh.cell_labels.contains_key(name);
    let first = format!("fibres_{of}");
    let mut others = (2_usize..).map(|number| format!("fibres_{of}_{number}"));
    if has(&first) { others.find(|name| !has(name)).unwrap_or(first) } else { first }
}

/// The case of a template's mesh on the patient, its muscles and materials still the template's.
pub(super) fn case_of(spec: &ConformDocument, volume: &str, frame: FrameName) -> CaseDocument {
    let mut case = spec.template.case(volume, LengthUnit::Mm);
    case.frame = frame;
    let landmarks = spec.landmarks.iter();
    case.landmarks = landmarks.map(|(name, pair)| (name.clone(), pair.patient_mm)).collect();
    case
}
