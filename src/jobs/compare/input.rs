//! Input of a comparison of two surfaces.

use serde::{Deserialize, Serialize};

use super::meshes::ComparedMeshes;
use super::surfaces::admit;
use crate::jobs::failure::JobError;
use crate::jobs::fetch::{fetch, found};
use crate::jobs::source::{MeshSource, StoredMesh};
use crate::schema::hashes;
use crate::schema::{CompareDocument, Pointer};

/// A comparison of two surfaces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CompareInput {
    /// The id of the job; absent on the command line.
    pub job: Option<String>,
    /// From acceptance to start.
    pub queue_s: Option<f64>,
    pub spec: CompareDocument,
}

impl CompareInput {
    /// The hash of everything that determines the numbers, from the hashes of all surfaces.
    pub fn spec_hash(&self, prediction: &str, meshes: &ComparedMeshes) -> String {
        let spec = self.spec.to_compare_to();
        let content =
            |id: &str| meshes.content_of(&spec, id).or_else(|| Some(prediction.to_owned()));
        hashes::compare_hash(&self.spec, &content)
    }

    /// Refuses a comparison with too many samples, whose number follows from the surfaces.
    pub fn admit(&self, sources: &dyn MeshSource) -> Result<(), JobError> {
        let at = Pointer::root().key("spec");
        let prediction = self.fetch_prediction(sources, &at.key("prediction"))?;
        let actual = &self.spec.actual.mesh;
        let actual = fetch(sources, actual, &at.key("actual").key("mesh"))?;
        let density = self.spec.samples_per_mm2;
        admit(&prediction, density, &at).and_then(|()| admit(&actual, density, &at))
    }

    /// The surface that is measured: a mesh, or the skin that a job predicted.
    pub fn fetch_prediction(
        &self,
        sources: &dyn MeshSource,
        at: &Pointer,
    ) -> Result<StoredMesh, JobError> {
        match &self.spec.prediction.job {
            Some(job) => found(sources.predicted_skin(job), job, &at.key("job")),
            None => {
                let mesh = self.spec.prediction.mesh.clone().unwrap_or_default();
                fetch(sources, &mesh, &at.key("mesh"))
            }
        }
    }
}
