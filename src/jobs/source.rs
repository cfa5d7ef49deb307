//! Source of the meshes of a job: content-addressed in the service, files on the command line.

use std::path::PathBuf;
use std::sync::Arc;

use crate::schema::ErrorCode;
use crate::schema::WarningDocument;
use crate::schema::case::document::LengthUnit;
use crate::schema::mesh::content_in_case;
use mechanics::format::{Mesh, ReadMesh, SurfaceArrays};
use mechanics::image::ImageVolume;
use mechanics::mesh::{Frame, TriangleSurface, VolumeMesh, Warning};

/// Meshes by the ids that documents use.
pub trait MeshSource {
    fn mesh(&self, id: &str) -> Result<StoredMesh, SourceError>;

    /// The predicted skin of an earlier job, in mm.
    fn predicted_skin(&self, job: &str) -> Result<StoredMesh, SourceError>;

    /// The bytes of the learned model of an earlier job; a source without jobs has none.
    fn model(&self, job: &str) -> Result<Vec<u8>, SourceError> {
        Err(SourceError::Unknown { id: job.to_owned() })
    }

    /// Whether who sends a mesh says that it may have any size: none is told to be unusual.
    fn takes_any_scale(&self) -> bool {
        false
    }

    /// The files that were read, which no result may take the place of; a store has none.
    fn files(&self) -> Vec<PathBuf> {
        Vec::new()
    }

    /// The documents that are written beside the result after it: earlier ones go with the earlier result. A store has none.
    fn beside_result(&self) -> Vec<String> {
        Vec::new()
    }
}

/// A parsed mesh and the hash of its bytes.
#[derive(Clone, Debug)]
pub struct StoredMesh {
    pub shape: StoredShape,
    /// Of a surface that was just read; not of a stored mesh.
    pub of_points: Arc<SurfaceArrays>,
    /// The frame mark in the file.
    pub frame: Option<Frame>,
    /// The unit stated at upload, which must be that of a case that uses it.
    pub units: Option<LengthUnit>,
    /// The warnings of the reader.
    pub warnings: Vec<Warning>,
    /// The warnings of the meshing that made it.
    pub told: Vec<WarningDocument>,
    /// SHA-256 in hexadecimal.
    pub sha256: String,
    /// What it is to a job: that, with what its upload stated of frame and unit.
    pub identity: String,
}

/// A mesh of either kind or an image, shared by the jobs that use it.
#[derive(Clone, Debug)]
pub enum StoredShape {
    Volume(Arc<VolumeMesh>),
    Surface(Arc<TriangleSurface>),
    /// In mm.
    Image(Arc<ImageVolume>),
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SourceError {
    #[error("there is no mesh or result {id:?}")]
    Unknown { id: String },
    #[error("mesh {id:?} is refused: {detail}")]
    Refused { id: String, code: ErrorCode, detail: String },
    #[error("the mesh or result {id:?} could not be read: {detail}")]
    Unreadable {
        id: String,
        /// Why, without names of systems.
        detail: String,
        /// Whether it is only temporarily unreachable, so that the same may succeed later.
        may_pass: bool,
    },
}

impl StoredMesh {
    /// A mesh that was just read from bytes with this hash. An image has no stated unit: it is in mm.
    pub fn new(read: ReadMesh, units: Option<LengthUnit>, sha256: String) -> Self {
        let shape = match read.mesh {
            Mesh::Volume(volume) => StoredShape::Volume(Arc::new(volume)),
            Mesh::Surface(surface) => StoredShape::Surface(Arc::new(surface)),
            Mesh::Image(image) => StoredShape::Image(Arc::new(image)),
        };
        let units = units.filter(|_| !matches!(shape, StoredShape::Image(_)));
        let (frame, warnings) = (read.frame, read.warnings);
        let of_points = Arc::new(read.of_points);
        let (identity, told) = (sha256.clone(), Vec::new());
        StoredMesh { shape, of_points, frame, units, warnings, told, sha256, identity }
    }

    /// What it is to a case.
    pub fn content_in_case(&self) -> String {
        let is_image = matches!(self.shape, StoredShape::Image(_));
        content_in_case(is_image, &self.sha256, &self.identity)
    }

    /// The surface, or the boundary of the volume; an image has none.
    pub fn surface(&self) -> Option<Arc<TriangleSurface>> {
        match &self.shape {
            StoredShape::Surface(surface) => Some(surface.clone()),
            StoredShape::Volume(volume) => {
                Some(Arc::new(volume.surface_of(&volume.boundary_faces())))
            }
            StoredShape::Image(_) => None,
        }
    }

    /// The same surface in mm; without a stated unit it is in mm already.
    pub fn surface_in_mm(&self) -> Option<Arc<TriangleSurface>> {
        let surface = self.surface()?;
        let units = self.units.unwrap_or_default();
        if units == LengthUnit::Mm {
            return Some(surface);
        }
        let mut scaled = (*surface).clone();
        for point in &mut scaled.points {
            *point *= units.in_mm();
        }
        Some(Arc::new(scaled))
    }
}
