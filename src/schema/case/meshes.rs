//! The meshes of a case, as its files have them.

use std::collections::BTreeMap;
use std::sync::Arc;

use mechanics::image::ImageVolume;
use mechanics::mesh::{Frame, TriangleSurface, VolumeMesh};

/// A mesh as its file has it, and the frame the file names.
#[derive(Clone, Debug)]
pub struct NamedMesh<T> {
    pub mesh: Arc<T>,
    pub frame: Option<Frame>,
}

/// The meshes of a case, in the units of its document.
#[derive(Clone, Debug)]
pub struct CaseMeshes {
    pub volume: NamedMesh<VolumeMesh>,
    /// By the id under which bones and selections ask for them.
    pub surfaces: BTreeMap<String, NamedMesh<TriangleSurface>>,
    /// In mm, whatever the unit of the case.
    pub image: Option<NamedMesh<ImageVolume>>,
}
