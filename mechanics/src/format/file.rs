//! The formats that are read, and what a file becomes.

use super::arrays::SurfaceArrays;
use crate::image::ImageVolume;
use crate::mesh::{Frame, IgnoredArrays, TriangleSurface, VolumeMesh, Warning};

/// A format that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MeshFormat {
    Vtu,
    Vtp,
    VtkLegacy,
    Gmsh,
    Stl,
    Ply,
    Obj,
    Nrrd,
    Nifti,
    MetaImage,
    Dicom,
}

impl MeshFormat {
    /// The name used in documents and errors.
    pub fn name(self) -> &'static str {
        match self {
            MeshFormat::Vtu => "VTU",
            MeshFormat::Vtp => "VTP",
            MeshFormat::VtkLegacy => "VTK legacy",
            MeshFormat::Gmsh => "Gmsh",
            MeshFormat::Stl => "STL",
            MeshFormat::Ply => "PLY",
            MeshFormat::Obj => "OBJ",
            MeshFormat::Nrrd => "NRRD",
            MeshFormat::Nifti => "NIfTI",
            MeshFormat::MetaImage => "MetaImage",
            MeshFormat::Dicom => "DICOM",
        }
    }

    /// The media type of a file of this format.
    pub fn media_type(self) -> &'static str {
        match self {
            MeshFormat::Vtu | MeshFormat::Vtp => "application/vnd.vtk.xml",
            MeshFormat::VtkLegacy => "application/vnd.vtk",
            MeshFormat::Gmsh => "application/x-gmsh",
            MeshFormat::Stl => "model/stl",
            MeshFormat::Ply => "application/vnd.ply",
            MeshFormat::Obj => "model/obj",
            MeshFormat::Nrrd => "application/x-nrrd",
            MeshFormat::Nifti => "application/x-nifti",
            MeshFormat::MetaImage => "application/x-metaimage",
            MeshFormat::Dicom => "application/dicom",
        }
    }
}

/// A mesh of either kind in the unit of its file, or an image in mm.
#[derive(Clone, Debug, PartialEq)]
pub enum Mesh {
    Volume(VolumeMesh),
    Surface(TriangleSurface),
    Image(ImageVolume),
}

/// A mesh or an image, and what its file said beside it.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadMesh {
    pub format: MeshFormat,
    pub mesh: Mesh,
    /// The frame of a `SPACE=` mark, or of the `space` of an image.
    pub frame: Option<Frame>,
    /// Arrays that nothing reads; a volume mesh keeps them as well.
    pub ignored: IgnoredArrays,
    /// Of a surface; nothing of others.
    pub of_points: SurfaceArrays,
    pub warnings: Vec<Warning>,
}
