//! Input of a prediction: its documents with their meshes, checked and converted.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::facing::frame_mismatch;
use super::far_from_origin::far_from_origin;
use super::fitted_model::FittedModel;
use super::refinable::check_refinable;
use super::unknown_names::unknown_names;
use crate::jobs::compare::{ComparedMeshes, admit};
use crate::jobs::failure::JobError;
use crate::jobs::source::{MeshSource, SourceError, StoredMesh, StoredShape};
use crate::schema::ErrorCode;
use crate::schema::case::bone_landmark::check_bone_landmarks;
use crate::schema::case::conversion::{ConvertedCase, centre};
use crate::schema::case::document::{CaseMeshes, NamedMesh};
use crate::schema::case::norm::check_norms;
use crate::schema::compare::document::CompareToDocument;
use crate::schema::hashes;
use crate::schema::learn::mechanics::MechanicsDocument;
use crate::schema::plan::document::PlanContext;
use crate::schema::predict::document::OutputName;
use crate::schema::predict::output::PictureName;
use crate::schema::predict::result::{FileDocument, InputDocument};
use crate::schema::{
    CaseDocument, Faults, Limits, PlanDocument, Pointer, PredictDocument, WarningDocument,
};
use mechanics::mesh::Warning;
use mechanics::mesh::ignored::listed;
use mechanics::mesh::quality::{QualityReport, quality_unless_stopped};
use mechanics::prediction::{Case, Plan, Scene, Settings};
use mechanics::progress::StopQuery;
use mechanics::repair::RepairReport;

/// A prediction: the case and the plan in full beside the spec.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PredictInput {
    /// The id of the job; absent on the command line.
    pub job: Option<String>,
    /// From acceptance to start.
    pub queue_s: Option<f64>,
    pub case: CaseDocument,
    pub plan: PlanDocument,
    pub spec: PredictDocument,
}

/// A prediction with valid documents: the input of the numerics, and its provenance.
pub struct Prepared {
    pub case: Case,
    pub plan: Plan,
    pub scene: Scene,
    pub quality: QualityReport,
    /// Of the volume, if the case requests one.
    pub repair: Option<RepairReport>,
    pub spec_hash: String,
    pub inputs: Vec<InputDocument>,
    /// The SHA-256 of each mesh of the case by its id.
    pub contents: BTreeMap<String, String>,
    /// The surface to compare the skin with.
    pub compared: Option<ComparedMeshes>,
    /// The model that corrects the skin.
    pub model: Option<FittedModel>,
    /// Of the meshes and of the conversion; those of the scene are in the scene.
    pub warnings: Vec<Warning>,
    /// The warnings of the meshing of the volume.
    pub told: Vec<WarningDocument>,
}

/// Documents in the types of the numerics.
struct Converted {
    case: Case,
    plan: Plan,
    settings: Settings,
    warnings: Vec<Warning>,
    repair: Option<RepairReport>,
}

impl PredictInput {
    /// Fetches the meshes, converts the documents and checks them together. All faults are reported;
    /// pointers start at `/case`, `/plan` and `/spec`. After a stop it is cancelled.
    pub fn prepare(
        &self,
        sources: &dyn MeshSource,
        limits: &Limits,
        stop: &StopQuery,
    ) -> Result<Prepared, JobError> {
        let stored = self.fetch(sources)?;
        let compared = self.fetch_compared(sources)?;
        let model = self.fetch_model(sources)?;
        let meshes = self.case_meshes(&stored)?;
        let converted = self.convert(&meshes, limits)?;
        let Converted { case, plan, settings, .. } = &converted;
        let (scene, quality) = rayon::join(
            || Scene::unless_stopped(case, plan, settings, stop),
            || quality_unless_stopped(&case.volume, stop),
        );
        let scene = scene?;
        if stop.is_asked() {
            return Err(JobError::Cancelled);
        }
        if let Some(model) = &model {
            self.check_model(&model.document, case, plan, &scene)?;
        }
        if let Some(refine) = &self.spec.refine {
            check_refinable(refine, &scene)?;
        }
        let meshes_read = stored.values().chain(compared.iter().map(|meshes| &meshes.actual));
        let mut warnings: Vec<Warning> =
            meshes_read.flat_map(|mesh| mesh.warnings.iter().cloned()).collect();
        let told = stored.values().flat_map(|mesh| mesh.told.iter().cloned()).collect();
        let is_meant = |own: &Warning| own.code == "units-suspect" && sources.takes_any_scale();
        warnings.extend(converted.warnings.into_iter().filter(|own| !is_meant(own)));
        warnings.extend(quality.warnings());
        warnings.extend(far_from_origin(&converted.case.volume));
        warnings.extend(frame_mismatch(converted.case.frame, &scene.skin.surface));
        Ok(Prepared {
            case: converted.case,
            plan: converted.plan,
            scene,
            quality,
            repair: converted.repair,
            spec_hash: self.spec_hash(&stored, compared.as_ref()),
            inputs: self.inputs(&stored, compared.as_ref()),
            contents: stored
                .iter()
                .map(|(id, mesh)| (id.clone(), mesh.content_in_case()))
                .collect(),
            compared,
            model,
            warnings,
            told,
        })
    }

    /// Every mesh that it reads.
    pub fn mesh_ids(&self) -> Vec<String> {
        let mut ids = self.case.mesh_ids();
        let is_bone = |id: &str| self.case.bones.iter().any(|bone| bone.name == id);
        let mut plan = self.plan.clone();
        for (_, id) in plan.surface_references_mut() {
            if !is_bone(id) {
                ids.push(id.clone());
            }
        }
        ids.extend(self.spec.compare_to.iter().flat_map(CompareToDocument::mesh_ids));
        ids
    }

    /// What decides the mechanics of it.
    pub fn mechanics(&self, plan: &Plan, scene: &Scene) -> MechanicsDocument {
        MechanicsDocument::new(&self.case, &self.spec, plan, scene)
    }

    /// The files to write except `result.json`: those requested, or skin and moved bones. A case
    /// without bones has no file of them.
    pub fn files(&self) -> Vec<OutputName> {
        let mut files = self.spec.files();
        if self.spec.outputs.is_none() {
            files.push(OutputName::BonesVtp);
        }
        let has_bones = !self.case.bones.is_empty();
        files.retain(|name| match name {
            OutputName::ResultJson => false,
            OutputName::BonesVtp | OutputName::GapsSvg => has_bones,
            _ => true,
        });
        files
    }

    /// The pictures of its job that are no files: the command line cannot draw them later.
    pub fn pictures_beside(&self, files: &[FileDocument]) -> Vec<PictureName> {
        let has = |output: OutputName| files.iter().any(|file| file.name == output.file_name());
        if self.job.is_some() { PictureName::beside(has) } else { Vec::new() }
    }

    fn convert(&self, meshes: &CaseMeshes, limits: &Limits) -> Result<Converted, JobError> {
        let mut faults = Faults::default();
        let spec_materials = self.spec.materials.as_ref();
        let ConvertedCase { case, mut warnings, repair } =
            self.case.to_case(meshes, spec_materials, limits, &mut faults);
        let segments = self.case.segments.iter().map(|segment| segment.name.trim()).collect();
        let at = Pointer::root().key("case");
        let landmarks = at.key("bone_landmarks");
        let named = &self.case.bone_landmarks;
        check_bone_landmarks(named, &segments, &landmarks, limits, &mut faults);
        check_norms(&self.case.norms, &at.key("norms"), limits, &mut faults);
        let centre = Some(centre(&case.volume));
        let context = PlanContext { frame: case.frame, centre, limits };
        let plan = self.plan.to_plan(&Pointer::root().key("plan"), &context, &mut faults);
        warnings.extend(self.plan.doubts());
        let settings = self.spec.to_settings(limits, &mut faults);
        for name in self.spec.accept_regions_mm.keys() {
            if !case.skin_regions.contains_key(name) {
                let at = Pointer::root().key("spec").key("accept_regions_mm").key(name);
                let known = listed(case.skin_regions.keys());
                let detail = format!("the case has no skin region {name:?}; it has: {known}");
                faults.add(&at, ErrorCode::UnknownRegion, detail);
            }
        }
        self.spec.check_element(&mut faults);
        if !faults.is_empty() {
            unknown_names((&self.case, &self.plan), &case, &mut faults);
        }
        faults.into_result()?;
        Ok(Converted { case, plan, settings, warnings, repair })
    }

    /// The meshes of the case and the plan.
    fn fetch(&self, sources: &dyn MeshSource) -> Result<BTreeMap<String, StoredMesh>, JobError> {
        let mut wanted: Vec<(Pointer, String)> = Vec::new();
        let (mut case, mut plan) = (self.case.clone(), self.plan.clone());
        let is_bone = |id: &str| self.case.bones.iter().any(|bone| bone.name == id);
        let under = |root: &str, at: Pointer| Pointer::from_text(&format!("/{root}{at}"));
        for (at, id) in case.mesh_references_mut() {
            wanted.push((under("case", at), id.clone()));
        }
        for (at, id) in plan.surface_references_mut() {
            if !is_bone(id) {
                wanted.push((under("plan", at), id.clone()));
            }
        }
        let mut stored = BTreeMap::new();
        let mut faults = Faults::default();
        for (at, id) in wanted {
            if let Some(mesh) = stored.get(&id) {
                check_kind(&at, mesh, &mut faults);
                continue;
            }
            match sources.mesh(&id) {
                Ok(mesh) => {
                    check_kind(&at, &mesh, &mut faults);
                    self.check_units(&at, &mesh, &mut faults);
                    stored.insert(id, mesh);
                }
                Err(SourceError::Unknown { .. }) => {
                    faults.add(&at, ErrorCode::UnknownMesh, format!("there is no mesh {id:?}"));
                }
                Err(SourceError::Refused { code, detail, .. }) => faults.add(&at, code, detail),
                Err(other) => return Err(JobError::Source(other)),
            }
        }
        faults.into_result()?;
        Ok(stored)
    }

    fn check_units(&self, at: &Pointer, mesh: &StoredMesh, faults: &mut Faults) {
        if let Some(units) = mesh.units.filter(|units| *units != self.case.units) {
            let (own, of_case) = (units.name(), self.case.units.name());
            let detail = format!("the mesh was uploaded in {own}, the case is in {of_case}");
            faults.add(at, ErrorCode::UnitsConflict, detail);
        }
    }

    fn case_meshes(&self, stored: &BTreeMap<String, StoredMesh>) -> Result<CaseMeshes, JobError> {
        let mut surfaces = BTreeMap::new();
        let (mut volume, mut image) = (None, None);
        for (id, mesh) in stored {
            let frame = mesh.frame;
            match &mesh.shape {
                StoredShape::Volume(shared) if *id == self.case.volume => {
                    volume = Some(NamedMesh { mesh: shared.clone(), frame });
                }
                StoredShape::Image(shared) => {
                    image = Some(NamedMesh { mesh: shared.clone(), frame })
                }
                StoredShape::Volume(_) | StoredShape::Surface(_) => {
                    let named = mesh.surface().map(|mesh| NamedMesh { mesh, frame });
                    surfaces.extend(named.map(|named| (id.clone(), named)));
                }
            }
        }
        let missing = || JobError::Source(SourceError::Unknown { id: self.case.volume.clone() });
        Ok(CaseMeshes { volume: volume.ok_or_else(missing)?, surfaces, image })
    }

    fn fetch_compared(&self, sources: &dyn MeshSource) -> Result<Option<ComparedMeshes>, JobError> {
        let Some(compare_to) = &self.spec.compare_to else {
            return Ok(None);
        };
        let at = Pointer::from_text("/spec/compare_to");
        let compared = ComparedMeshes::fetch(compare_to, sources, &at)?;
        admit(&compared.actual, compare_to.samples_per_mm2, &at)?;
        Ok(Some(compared))
    }

    /// The hash of everything that determines the numbers.
    fn spec_hash(
        &self,
        stored: &BTreeMap<String, StoredMesh>,
        compared: Option<&ComparedMeshes>,
    ) -> String {
        let content = |id: &str| {
            let compared = || compared?.content_of(self.spec.compare_to.as_ref()?, id);
            stored.get(id).map(StoredMesh::content_in_case).or_else(compared)
        };
        hashes::predict_hash(&self.case, &self.plan, &self.spec, &content)
    }

    fn inputs(
        &self,
        stored: &BTreeMap<String, StoredMesh>,
        compared: Option<&ComparedMeshes>,
    ) -> Vec<InputDocument> {
        let role = |id: &str| {
            if *id == self.case.volume {
                return "volume".to_owned();
            }
            if self.case.hounsfield.as_ref().is_some_and(|hounsfield| hounsfield.image == id) {
                return "image".to_owned();
            }
            let bone = self.case.bones.iter().find(|bone| bone.mesh == id);
            let mut muscles = self.case.muscles.iter();
            let muscle = muscles.find(|muscle| muscle.surface.as_deref() == Some(id));
            let bone = bone.map(|bone| format!("bone {}", bone.name));
            let muscle = muscle.map(|muscle| format!("muscle {}", muscle.name));
            bone.or(muscle).unwrap_or_else(|| "surface".to_owned())
        };
        let mut inputs: Vec<InputDocument> =
            stored.iter().map(|(id, mesh)| mesh.to_input(&role(id))).collect();
        inputs.sort_by(|a, b| b.role.cmp(&a.role));
        inputs.extend(compared.into_iter().flat_map(ComparedMeshes::to_inputs));
        inputs
    }
}

/// Refuses a surface or an image where a volume is needed, a mesh where an image is, and an image elsewhere.
fn check_kind(at: &Pointer, mesh: &StoredMesh, faults: &mut Faults) {
    let (is, needed) = match (at.as_str(), &mesh.shape) {
        ("/case/volume", StoredShape::Volume(_)) => return,
        ("/case/volume", StoredShape::Surface(_)) => ("this mesh is a surface", "a volume"),
        ("/case/volume", StoredShape::Image(_)) => ("this is an image", "a volume"),
        ("/case/hounsfield/image", StoredShape::Image(_)) => return,
        ("/case/hounsfield/image", _) => ("this is a mesh", "an image"),
        (_, StoredShape::Image(_)) => ("this is an image", "a mesh"),
        _ => return,
    };
    faults.add(at, ErrorCode::WrongMesh, format!("{is}, and {needed} is needed"));
}

impl StoredMesh {
    /// The name of this mesh in provenance.
    pub fn to_input(&self, role: &str) -> InputDocument {
        let count = |count: usize| Some(count as u64);
        let (nodes, cells, triangles, voxels) = match &self.shape {
            StoredShape::Volume(mesh) => (mesh.nodes.len(), count(mesh.cells.len()), None, None),
            StoredShape::Surface(mesh) => {
                (mesh.points.len(), None, count(mesh.triangles.len()), None)
            }
            StoredShape::Image(image) => (0, None, None, count(image.voxels().len())),
        };
        InputDocument {
            role: role.to_owned(),
            sha256: self.sha256.clone(),
            nodes: nodes as u64,
            cells,
            triangles,
            voxels,
        }
    }
}
