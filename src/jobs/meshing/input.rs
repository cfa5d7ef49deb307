//! Input of a meshing: its document with the scan, checked and converted.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::jobs::failure::JobError;
use crate::jobs::source::{MeshSource, SourceError, StoredMesh, StoredShape};
use crate::schema::case::meshed::MeshedCaseDocument;
use crate::schema::{ErrorCode, Faults, Limits, MeshingDocument, Pointer, Problem, hashes};
use mechanics::anatomy::AnatomyRules;
use mechanics::image::ImageVolume;
use mechanics::mesh::Frame;

/// A meshing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeshingInput {
    /// The id of the job; absent on the command line.
    pub job: Option<String>,
    /// From acceptance to start.
    pub queue_s: Option<f64>,
    pub spec: MeshingDocument,
    /// The stored case that waits for the mesh, if one does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub case: Option<WaitingCase>,
}

/// A stored case that waits for its mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WaitingCase {
    pub id: String,
    pub document: MeshedCaseDocument,
}

/// A meshing whose documents are sound.
pub struct PreparedMeshing {
    pub scan: StoredMesh,
    pub image: Arc<ImageVolume>,
    pub rules: AnatomyRules,
    pub spec_hash: String,
    /// That of the mesh.
    pub frame: Frame,
}

impl MeshingInput {
    /// Fetches the scan and converts the document; pointers start at `/spec`.
    pub fn prepare(
        &self,
        sources: &dyn MeshSource,
        limits: &Limits,
    ) -> Result<PreparedMeshing, JobError> {
        let scan = self.fetch(sources)?;
        let StoredShape::Image(image) = &scan.shape else {
            let detail = "this is a mesh, and the image of a scan is needed";
            return Err(Problem::at(&place(), ErrorCode::WrongMesh, detail).into());
        };
        let (image, frame) = in_lps(image, scan.frame.unwrap_or_default());
        let mut faults = Faults::default();
        let rules = self.spec.to_rules(frame, limits, &mut faults);
        faults.into_result()?;
        let spec_hash = hashes::meshing_hash(&self.spec, &scan.sha256, self.case_id());
        Ok(PreparedMeshing { scan, image, frame, rules, spec_hash })
    }

    fn case_id(&self) -> Option<&str> {
        self.case.as_ref().map(|case| case.id.as_str())
    }

    fn fetch(&self, sources: &dyn MeshSource) -> Result<StoredMesh, JobError> {
        let id = &self.spec.scan;
        sources.mesh(id).map_err(|error| match error {
            SourceError::Unknown { .. } => {
                let detail = format!("there is no image {id:?}");
                Problem::at(&place(), ErrorCode::UnknownMesh, detail).into()
            }
            SourceError::Refused { code, detail, .. } => Problem::at(&place(), code, detail).into(),
            other @ SourceError::Unreadable { .. } => JobError::Source(other),
        })
    }
}

fn place() -> Pointer {
    Pointer::root().key("spec").key("scan")
}

/// The same in LPS where its frame is known: 3D Slicer takes a file of a volume mesh for LPS.
fn in_lps(image: &Arc<ImageVolume>, frame: Frame) -> (Arc<ImageVolume>, Frame) {
    match frame {
        Frame::Ras => (Arc::new(image.turned(Frame::Ras, Frame::Lps)), Frame::Lps),
        Frame::Lps | Frame::Unspecified => (image.clone(), frame),
    }
}
