//! The meshes of a case, as read from its files.

use std::collections::BTreeMap;
use std::sync::Arc;

use mechanics::image::ImageVolume;
use mechanics::mesh::{Frame, TriangleSurface, VolumeMesh};

/// A mesh as read, and the frame that its file names.
#[derive(Clone, Debug)]
pub struct NamedMesh<T> {
    pub mesh: Arc<T>,
    pub frame: Option<Frame>,
}

/// The meshes of a case, in the units of its document.
#[derive(Clone, Debug)]
pub struct CaseMeshes {
    pub volume: NamedMesh<VolumeMesh>,
    /// By the id that bones and selections refer to.
    pub surfaces: BTreeMap<String, NamedMesh<TriangleSurface>>,
    /// Always in mm, not in the unit of the case.
    pub image: Option<NamedMesh<ImageVolume>>,
}
