//! Input of a conformation.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::jobs::failure::JobError;
use crate::jobs::fetch::{fetch, no_surface};
use crate::jobs::predict::PredictInput;
use crate::jobs::source::{MeshSource, StoredMesh, StoredShape};
use crate::schema::case::muscle::Surfaces;
use crate::schema::conform::document::{ConformDocument, MuscleMapName};
use crate::schema::{
    ErrorCode, Faults, Limits, PlanDocument, Pointer, PredictDocument, Problem, hashes,
};
use mechanics::conformation::{Landmark, spline_of};
use mechanics::mesh::{Frame, TriangleSurface, VolumeMesh};
use mechanics::progress::StopQuery;

/// A conformation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConformInput {
    /// The id of the job; absent on the command line.
    pub job: Option<String>,
    /// From acceptance to start.
    pub queue_s: Option<f64>,
    pub spec: ConformDocument,
}

/// A conformation with valid documents; lengths in mm.
pub struct PreparedConformation {
    /// Each mesh with its role.
    pub meshes: Vec<(&'static str, StoredMesh)>,
    pub template: VolumeMesh,
    pub skin_nodes: Vec<u32>,
    pub bone_nodes: Vec<u32>,
    pub skin: Option<Arc<TriangleSurface>>,
    pub bone: Option<Arc<TriangleSurface>>,
    pub landmarks: Vec<Landmark>,
    /// Those of muscles, by id, on the template.
    pub muscle_surfaces: Surfaces,
    /// That of the patient.
    pub frame: Frame,
    pub spec_hash: String,
}

impl ConformInput {
    /// Fetches the meshes and converts the document; pointers start at `/spec`.
    pub fn prepare(
        &self,
        sources: &dyn MeshSource,
        limits: &Limits,
        stop: &StopQuery,
    ) -> Result<PreparedConformation, JobError> {
        let mut faults = Faults::default();
        self.spec.check(limits, &mut faults);
        faults.into_result()?;
        let at = Pointer::root().key("spec");
        let mut meshes = vec![(
            "template",
            fetch(sources, &self.spec.template.mesh, &at.key("template").key("mesh"))?,
        )];
        let template = volume_in_mm(&meshes[0].1, &at.key("template").key("mesh"))?;
        let mut surface = |role, id: &Option<String>| {
            let Some(id) = id else { return Ok(None) };
            let at = at.key("patient").key(role);
            let mesh = fetch(sources, id, &at)?;
            let surface = mesh.surface_in_mm().ok_or_else(|| no_surface(&at))?;
            meshes.push((role, mesh));
            Ok::<_, JobError>(Some(surface))
        };
        let skin = surface("skin", &self.spec.patient.skin)?;
        let bone = surface("bone", &self.spec.patient.bone)?;
        let frame = one_frame(&meshes[1..], &at)?;
        let muscle_surfaces = self.muscle_surfaces(sources, &mut meshes)?;
        let (skin_nodes, bone_nodes) = self.nodes(&template)?;
        self.check_template(&meshes[0].1, sources, limits, stop)?;
        let landmarks = self.spec.landmarks.iter().map(|(name, pair)| Landmark {
            name: name.clone(),
            template: pair.template_mm.into(),
            patient: pair.patient_mm.into(),
        });
        let landmarks: Vec<Landmark> = landmarks.collect();
        self.check_map_of_muscles(&landmarks)?;
        let content = |id: &str| {
            let mut spec = self.spec.clone();
            let places = spec.mesh_references_mut();
            let number = places.iter().position(|(_, other)| other.as_str() == id)?;
            Some(meshes[number].1.identity.clone())
        };
        let spec_hash = hashes::conform_hash(&self.spec, &content);
        Ok(PreparedConformation {
            meshes,
            template,
            skin_nodes,
            bone_nodes,
            skin,
            bone,
            landmarks,
            muscle_surfaces,
            frame,
            spec_hash,
        })
    }

    /// The surfaces of the template's muscles, each added to the meshes in the order in which the document names it.
    fn muscle_surfaces(
        &self,
        sources: &dyn MeshSource,
        meshes: &mut Vec<(&'static str, StoredMesh)>,
    ) -> Result<Surfaces, JobError> {
        let mut surfaces = Surfaces::new();
        let at = Pointer::root().key("spec").key("template").key("muscles");
        for (index, muscle) in self.spec.template.muscles.iter().enumerate() {
            let Some(id) = &muscle.surface else { continue };
            let at = at.index(index).key("surface");
            let mesh = fetch(sources, id, &at)?;
            let surface = mesh.surface_in_mm().ok_or_else(|| no_surface(&at))?;
            surfaces.insert(id.clone(), surface);
            meshes.push(("muscle", mesh));
        }
        Ok(surfaces)
    }

    /// The nodes on the skin, and those on bone.
    fn nodes(&self, template: &VolumeMesh) -> Result<(Vec<u32>, Vec<u32>), JobError> {
        let spec = &self.spec.template;
        let mut faults = Faults::default();
        for (at, set) in spec.node_sets() {
            if template.node_set(set).is_none() {
                faults.add(&at, ErrorCode::UnknownSet, template.missing_set(set));
            }
        }
        faults.into_result()?;
        let nodes = |set: &String| template.node_set(set).unwrap_or_default();
        let on_bone = spec.segments.values().chain(&spec.fixed);
        let mut bone: Vec<u32> = on_bone.flat_map(nodes).copied().collect();
        bone.sort_unstable();
        bone.dedup();
        Ok((nodes(&spec.skin).to_vec(), bone))
    }

    /// Refuses regions, materials, muscles and sliding that are invalid in a case of the template's mesh.
    fn check_template(
        &self,
        mesh: &StoredMesh,
        sources: &dyn MeshSource,
        limits: &Limits,
        stop: &StopQuery,
    ) -> Result<(), JobError> {
        let spec = &self.spec.template;
        if !spec.has_tissue() {
            return Ok(());
        }
        let mut case = spec.case(&spec.mesh, mesh.units.unwrap_or_default());
        case.frame = mesh.frame.unwrap_or_default().into();
        let own = PredictInput {
            job: None,
            queue_s: None,
            case,
            plan: PlanDocument::default(),
            spec: PredictDocument::default(),
        };
        let problem = match own.prepare(sources, limits, stop) {
            Ok(_) => return Ok(()),
            Err(JobError::Refused(problem)) => problem,
            Err(error) => return Err(error),
        };
        let mut faults = Faults::default();
        for error in problem.moved("/case", "/spec/template").errors {
            let is_ours = |member: &&str| {
                let rest = error.pointer.strip_prefix(&format!("/spec/template/{member}"));
                rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
            };
            if OF_TISSUE.iter().any(is_ours) {
                faults.add(&Pointer::from_text(&error.pointer), error.code, error.detail);
            }
        }
        Ok(faults.into_result()?)
    }

    /// Refuses muscles to be mapped by landmarks that define no map.
    fn check_map_of_muscles(&self, landmarks: &[Landmark]) -> Result<(), JobError> {
        match (self.spec.muscles_by, spline_of(landmarks)) {
            (MuscleMapName::Landmarks, Err(error)) => {
                let at = Pointer::root().key("spec").key("muscles_by");
                Err(Problem::at(&at, ErrorCode::AlignmentFailed, error.to_string()).into())
            }
            (MuscleMapName::Landmarks, Ok(_)) | (MuscleMapName::Conformation, _) => Ok(()),
        }
    }
}

/// The members that a template and a case have in common.
const OF_TISSUE: [&str; 4] = ["regions", "materials", "muscles", "sliding"];

fn volume_in_mm(stored: &StoredMesh, at: &Pointer) -> Result<VolumeMesh, JobError> {
    let StoredShape::Volume(volume) = &stored.shape else {
        let detail = "this is a surface, and a volume mesh is needed";
        return Err(Problem::at(at, ErrorCode::WrongMesh, detail).into());
    };
    let mut volume = (**volume).clone();
    let scale = stored.units.unwrap_or_default().in_mm();
    volume.nodes.iter_mut().for_each(|x| *x *= scale);
    Ok(volume)
}

fn one_frame(surfaces: &[(&'static str, StoredMesh)], at: &Pointer) -> Result<Frame, JobError> {
    let mut frames = surfaces.iter().filter_map(|(role, mesh)| Some((role, mesh.frame?)));
    let Some((first_role, first)) = frames.next() else { return Ok(Frame::default()) };
    match frames.find(|(_, frame)| *frame != first) {
        None => Ok(first),
        Some((role, frame)) => {
            let detail = format!("the {role} is in frame {frame}, the {first_role} in {first}");
            Err(Problem::at(&at.key("patient").key(role), ErrorCode::FrameConflict, detail).into())
        }
    }
}
