//! Input of a reproduction.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::jobs::failure::JobError;
use crate::jobs::fetch::fetch;
use crate::jobs::source::{MeshSource, StoredMesh};
use crate::schema::reproduce::document::ReproduceDocument;
use crate::schema::{ErrorCode, Pointer, Problem, hashes};
use mechanics::mesh::Frame;

/// The reproduction of an operation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReproduceInput {
    /// The id of the job; absent on the command line.
    pub job: Option<String>,
    /// From acceptance to start.
    pub queue_s: Option<f64>,
    pub spec: ReproduceDocument,
}

impl ReproduceInput {
    /// The meshes by the ids of the spec. Those before the operation are in one frame, and so are those after it.
    pub fn fetch(
        &self,
        sources: &dyn MeshSource,
    ) -> Result<BTreeMap<String, StoredMesh>, JobError> {
        let mut stored: BTreeMap<String, StoredMesh> = BTreeMap::new();
        let mut frames: BTreeMap<bool, Frame> = BTreeMap::new();
        for (at, id) in self.spec.clone().mesh_references_mut() {
            let at = Pointer::from_text(&format!("/spec{at}"));
            let mesh = match stored.get(id.as_str()) {
                Some(mesh) => mesh.clone(),
                None => fetch(sources, id, &at)?,
            };
            if let Some(own) = mesh.frame {
                let is_before = at.as_str().ends_with("/before/mesh");
                let first = *frames.entry(is_before).or_insert(own);
                if own != first {
                    let detail =
                        format!("this bone is in frame {own}, another of its scan in {first}");
                    return Err(Problem::at(&at, ErrorCode::FrameConflict, detail).into());
                }
            }
            stored.insert(id.clone(), mesh);
        }
        Ok(stored)
    }

    /// The hash of everything that determines the numbers.
    pub fn spec_hash(&self, stored: &BTreeMap<String, StoredMesh>) -> String {
        let content = |id: &str| stored.get(id).map(|mesh| mesh.identity.clone());
        hashes::reproduce_hash(&self.spec, &content)
    }
}
