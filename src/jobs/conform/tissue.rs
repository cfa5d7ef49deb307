//! Muscles and fibre directions of a template, mapped to the patient.

use std::sync::Arc;

use super::input::PreparedConformation;
use crate::jobs::output::MadeMesh;
use crate::jobs::source::{StoredMesh, StoredShape};
use crate::schema::case::document::{FrameName, LengthUnit};
use crate::schema::case::fibre::FibreDocument;
use crate::schema::case::muscle::{MuscleDocument, REACH_MM, USUAL_REACH_MM};
use crate::schema::conform::document::{ConformDocument, MuscleMapName};
use crate::schema::conform::result::{MapDifferenceDocument, MappedMuscleDocument};
use crate::schema::predict::keep::MadeName;
use crate::schema::{CaseDocument, Faults, Limits, Pointer, Triple};
use mechanics::conformation::{
    Conformation, Deformation, Warp, cell_axes, fibre_difference, mapped_lines, mapped_surface,
    spline_of,
};
use mechanics::mesh::{Frame, TriangleSurface, Vector, VolumeMesh};
use mechanics::registration::ThinPlateSpline;

/// Positions of lines are rounded to this fraction of a mm.
const PARTS_OF_MM: f64 = 1e6;

/// The muscles of a template on a patient.
#[derive(Default)]
pub(super) struct MappedMuscles {
    pub told: Vec<MappedMuscleDocument>,
    pub surfaces: Vec<MuscleSurface>,
}

/// The surface of a muscle on a patient.
pub(super) struct MuscleSurface {
    pub name: String,
    /// Of the result, and its name in the case until it is stored.
    pub file: String,
    pub surface: Arc<TriangleSurface>,
}

impl MuscleSurface {
    pub fn stored(&self, frame: Frame) -> StoredMesh {
        StoredMesh::made(StoredShape::Surface(self.surface.clone()), frame)
    }

    pub fn made(self, frame: Frame) -> MadeMesh {
        MadeMesh {
            what: MadeName::Muscle,
            name: Some(self.name),
            shape: StoredShape::Surface(self.surface),
            frame,
            told: Vec::new(),
        }
    }
}

/// The maps between a template and a patient.
pub(super) struct TissueMaps<'a> {
    prepared: &'a PreparedConformation,
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
        conformation: &'a Conformation,
        by: MuscleMapName,
        limits: &Limits,
    ) -> Self {
        let landmarks = prepared.landmarks.iter();
        let used = landmarks.filter(|landmark| !conformation.leaves_out(&landmark.name));
        TissueMaps {
            prepared,
            conformation: &conformation.deformation,
            spline: spline_of(&used.cloned().collect::<Vec<_>>()).ok(),
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
    /// its mesh, boxes become surfaces.
    pub fn bring(&self, case: &mut CaseDocument, mesh: &mut VolumeMesh) -> MappedMuscles {
        for (region, material) in case.materials.iter_mut().flatten() {
            if let Some(fibre) = &mut material.fibre {
                let FibreDocument { direction, array, .. } = fibre;
                self.bring_direction(direction, array, region, mesh);
            }
        }
        let mut mapped = MappedMuscles::default();
        for muscle in &mut case.muscles {
            let MuscleDocument { direction, array, name, .. } = muscle;
            self.bring_direction(direction, array, name, mesh);
            let mut told = self.bring_lines(muscle);
            if let Some((surface, [before, after])) =
                self.bring_surface(muscle, mapped.surfaces.len())
            {
                mapped.surfaces.push(surface);
                let own = told.get_or_insert_with(|| MappedMuscleDocument::without_lines(muscle));
                (own.template_volume_ml, own.volume_ml) = (Some(before), Some(after));
            }
            mapped.told.extend(told);
        }
        mapped
    }

    /// The surface or box of a muscle, and the volumes that it encloses before and after, in ml.
    fn bring_surface(
        &self,
        muscle: &mut MuscleDocument,
        number: usize,
    ) -> Option<(MuscleSurface, [f64; 2])> {
        let own = muscle.body_surface(
            &Pointer::root(),
            Some(&self.prepared.muscle_surfaces),
            &mut Faults::default(),
        )?;
        let surface = Arc::new(mapped_surface(self.maps().0, &own));
        let volumes =
            [own.signed_volume(), surface.signed_volume()].map(|volume| volume.abs() / 1e3);
        let file = format!("muscle-{}.vtp", number + 1);
        muscle.box_mm = None;
        muscle.surface = Some(file.clone());
        Some((MuscleSurface { name: muscle.name.clone(), file, surface }, volumes))
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
        let axes = cell_axes(self.maps().0, &self.prepared.template, &Vector::from(uniform));
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
        if muscle.surface.is_none() && muscle.box_mm.is_none() {
            let (least, most) = REACH_MM;
            let within = muscle.within_mm.unwrap_or(USUAL_REACH_MM) * mapped.widening;
            muscle.within_mm = Some(within.clamp(least, most));
        }
        Some(MappedMuscleDocument {
            lines: mapped.lines.len() as u64,
            template_length_mm: mapped.lengths[0],
            length_mm: mapped.lengths[1],
            widening: mapped.widening,
            beside_other_map: difference.map(MapDifferenceDocument::from),
            ..MappedMuscleDocument::without_lines(muscle)
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
