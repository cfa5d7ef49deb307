//! Meshes and images held in memory, for jobs without a service.

use std::collections::BTreeMap;

use facies::jobs::{MeshSource, SourceError, StoredMesh, StoredShape};
use facies::schema::case::document::LengthUnit;
use mechanics::mesh::Frame;

pub struct Meshes(pub BTreeMap<String, StoredMesh>);

impl MeshSource for Meshes {
    fn mesh(&self, id: &str) -> Result<StoredMesh, SourceError> {
        self.0.get(id).cloned().ok_or_else(|| SourceError::Unknown { id: id.to_owned() })
    }

    fn predicted_skin(&self, job: &str) -> Result<StoredMesh, SourceError> {
        self.mesh(job)
    }
}

pub fn stored(shape: StoredShape, frame: Option<Frame>) -> StoredMesh {
    let units = (!matches!(shape, StoredShape::Image(_))).then_some(LengthUnit::Mm);
    StoredMesh {
        shape,
        of_points: Default::default(),
        frame,
        units,
        warnings: Vec::new(),
        told: Vec::new(),
        sha256: format!("sha {frame:?}"),
        identity: format!("sha {frame:?}"),
    }
}
