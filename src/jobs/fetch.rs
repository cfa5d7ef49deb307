//! Stored meshes that documents name, fetched for a job.

use super::failure::JobError;
use super::source::{MeshSource, SourceError, StoredMesh, StoredShape};
use crate::schema::code::ErrorCode;
use crate::schema::{Pointer, Problem};

/// A mesh of the documents.
pub fn fetch(sources: &dyn MeshSource, id: &str, at: &Pointer) -> Result<StoredMesh, JobError> {
    found(sources.mesh(id), id, at)
}

/// A missing or wrong mesh is a mistake at a place of the documents.
pub fn found(
    result: Result<StoredMesh, SourceError>,
    id: &str,
    at: &Pointer,
) -> Result<StoredMesh, JobError> {
    let found = result.map_err(|error| match error {
        SourceError::Unknown { .. } => {
            Problem::at(at, ErrorCode::UnknownMesh, format!("there is no mesh {id:?}")).into()
        }
        SourceError::Refused { code, detail, .. } => Problem::at(at, code, detail).into(),
        other => JobError::Source(other),
    })?;
    match found.shape {
        StoredShape::Image(_) => Err(no_surface(at)),
        _ => Ok(found),
    }
}

/// An image at a place where a mesh is needed.
pub fn no_surface(at: &Pointer) -> JobError {
    Problem::at(at, ErrorCode::WrongMesh, "this is an image, and a mesh is needed").into()
}
