//! Volume meshes as other programs take them: in LPS.
//!
//! 3D Slicer reads the frame of a VTK file from a string array `SPACE` of its field data (vtkMRMLModelStorageNode) and
//! takes a file without one for LPS. meshio refuses VTU files with string arrays, so that a VTU file is written in LPS
//! instead: every program then reads it rightly.

use std::borrow::Cow;

use crate::mesh::{Frame, Vector, VolumeMesh};

/// A mesh in LPS where its frame is RAS; any other mesh as it is.
pub struct VolumeInLps<'a> {
    pub mesh: Cow<'a, VolumeMesh>,
    /// The present frame of the mesh.
    pub frame: Frame,
    is_turned: bool,
}

impl<'a> VolumeInLps<'a> {
    /// Its nodes and its vector arrays are turned.
    pub fn new(mesh: &'a VolumeMesh, frame: Frame) -> Self {
        if frame != Frame::Ras {
            return VolumeInLps { mesh: Cow::Borrowed(mesh), frame, is_turned: false };
        }
        let mut turned = mesh.clone();
        let arrays = turned.node_vectors.values_mut().chain(turned.cell_vectors.values_mut());
        for vector in arrays.chain([&mut turned.nodes]).flatten() {
            *vector = half_turn(vector);
        }
        VolumeInLps { mesh: Cow::Owned(turned), frame: Frame::Lps, is_turned: true }
    }

    /// The components of a symmetric tensor, xx, yy, zz, xy, yz, xz, likewise.
    pub fn turned_tensor(&self, [xx, yy, zz, xy, yz, xz]: [f64; 6]) -> [f64; 6] {
        match self.is_turned {
            true => [xx, yy, zz, xy, 0.0 - yz, 0.0 - xz],
            false => [xx, yy, zz, xy, yz, xz],
        }
    }

    /// A vector of the first frame in the one that the mesh is in now.
    pub fn turned(&self, vector: &Vector) -> Vector {
        if self.is_turned { half_turn(vector) } else { *vector }
    }
}

/// Right is minus left, anterior minus posterior. Taken from zero, so that there is no -0.
fn half_turn(vector: &Vector) -> Vector {
    Vector::new(0.0 - vector.x, 0.0 - vector.y, vector.z)
}
