//! Publication of an attempt: its files and meshes read, and stored under the manifest that names them.

use bytes::Bytes;
use serde_json::{Value, json};

use super::process::protocol::MeshFile;
use super::work::{Failure, Finished, FinishedFile, FinishedMesh};
use crate::jobs::result::provenance::manifest_bytes;
use crate::schema::CaseDocument;
use crate::schema::predict::document::OutputName;
use crate::schema::predict::keep::{KeptMeshDocument, MadeName};
use crate::schema::wire::canonical::{sha256_hex, to_value};
use crate::store::{
    Lease, MadeMesh, MeshedCase, NewMesh, Published, PublishedFile, Store, StoreError,
};

/// The result of an attempt in memory.
pub struct Publication {
    /// The manifest, JSON.
    result: String,
    files: Vec<PublishedFile>,
    meshes: Vec<MeshOutput>,
}

struct MeshOutput {
    what: MadeName,
    name: Option<String>,
    mesh: NewMesh,
}

impl Publication {
    /// Reads the files of an attempt, whose folder may then go.
    pub fn read(finished: Finished) -> Result<Publication, Failure> {
        let files = finished.files.into_iter().map(read_file);
        let meshes = finished.meshes.into_iter().map(read_mesh);
        Ok(Publication {
            result: finished.result,
            files: files.collect::<Result<_, _>>()?,
            meshes: meshes.collect::<Result<_, _>>()?,
        })
    }

    /// How many there are to be stored.
    pub fn bytes(&self) -> u64 {
        let files: usize = self.files.iter().map(|file| file.bytes.len()).sum();
        let meshes: usize = self.meshes.iter().map(|made| made.mesh.bytes.len()).sum();
        (files + meshes) as u64
    }

    /// Publishes all of it, or nothing where the job is not ours any more. A mesh that is stored already keeps its id.
    pub async fn publish(&self, store: &Store, lease: &Lease) -> Result<bool, StoreError> {
        if self.meshes.is_empty() {
            let published =
                Published { result: &self.result, files: &self.files, meshes: &[], case: None };
            return store.publish(lease, published).await;
        }
        let mut meshes = Vec::with_capacity(self.meshes.len());
        let mut kept = Vec::with_capacity(self.meshes.len());
        for MeshOutput { what, name, mesh } in &self.meshes {
            let is_same = |made: &&MadeMesh| {
                made.mesh.sha256 == mesh.sha256 && made.mesh.options == mesh.options
            };
            let id = match meshes.iter().find(is_same) {
                Some(twin) => twin.id().to_owned(),
                None => {
                    let known = store.mesh_by_content(&mesh.sha256, &mesh.options).await?;
                    let made = MadeMesh { mesh: mesh.clone(), known };
                    let id = made.id().to_owned();
                    meshes.push(made);
                    id
                }
            };
            kept.push(KeptMeshDocument::new(*what, name.clone(), &id));
        }
        let manifest = self.manifest(&kept)?;
        let files = self.files_with(&manifest);
        let result = manifest.to_string();
        let case = meshed_case(&manifest)?;
        let published =
            Published { result: &result, files: &files, meshes: &meshes, case: case.as_ref() };
        store.publish(lease, published).await
    }

    fn manifest(&self, kept: &[KeptMeshDocument]) -> Result<Value, StoreError> {
        let mut manifest: Value = serde_json::from_str(&self.result).map_err(unreadable)?;
        manifest["kept"] = to_value(&kept);
        // A case that a meshing or a conformation proposes names its mesh as clients do.
        for place in ["/meshing/case", "/conformation/case"] {
            if let Some(case) = manifest.pointer_mut(place) {
                name_meshes(case, kept);
            }
        }
        Ok(manifest)
    }

    /// The files, that of the manifest with what it has gained.
    fn files_with(&self, manifest: &Value) -> Vec<PublishedFile> {
        let mut files = self.files.clone();
        for file in &mut files {
            if file.name == OutputName::ResultJson.file_name() {
                file.bytes = Bytes::from(manifest_bytes(manifest));
                file.sha256 = sha256_hex(&file.bytes);
            }
        }
        files
    }
}

fn unreadable(error: serde_json::Error) -> StoreError {
    StoreError::Schema(format!("manifest of a job: {error}"))
}

/// The case that a meshing has found, for the one that may wait for it.
fn meshed_case(manifest: &Value) -> Result<Option<MeshedCase>, StoreError> {
    let Some(found) = manifest.get("meshing") else { return Ok(None) };
    let case: CaseDocument = serde_json::from_value(found["case"].clone()).map_err(unreadable)?;
    Ok(Some(MeshedCase {
        document: serde_json::to_string(&case).map_err(unreadable)?,
        report: found["check"].to_string(),
        mesh_ids: case.mesh_ids(),
    }))
}

/// Puts the ids of stored meshes into a case that names them by the files of the result.
fn name_meshes(case: &mut Value, kept: &[KeptMeshDocument]) {
    if let Some(volume) = kept.iter().find(|mesh| mesh.what == MadeName::Volume) {
        case["volume"] = json!(volume.mesh);
    }
    let surfaces = [("bones", "mesh", MadeName::Bone), ("muscles", "surface", MadeName::Muscle)];
    for (list, member, what) in surfaces {
        for named in case.get_mut(list).and_then(Value::as_array_mut).into_iter().flatten() {
            let is_it = |mesh: &&KeptMeshDocument| {
                mesh.what == what && mesh.name.as_deref() == named["name"].as_str()
            };
            if let Some(surface) = kept.iter().find(is_it) {
                named[member] = json!(surface.mesh);
            }
        }
    }
}

fn read_file(file: FinishedFile) -> std::io::Result<PublishedFile> {
    let bytes = Bytes::from(std::fs::read(&file.path)?);
    let sha256 = sha256_hex(&bytes);
    Ok(PublishedFile { name: file.name, media_type: file.media_type, sha256, bytes })
}

fn read_mesh(FinishedMesh { mesh, path }: FinishedMesh) -> std::io::Result<MeshOutput> {
    let bytes = Bytes::from(std::fs::read(path)?);
    let MeshFile { what, name, id, sha256, options, report, .. } = mesh;
    let blob = sha256_hex(&bytes);
    let mesh = NewMesh { id, sha256, options, blob, bytes, standalone: false, report };
    Ok(MeshOutput { what, name, mesh })
}
