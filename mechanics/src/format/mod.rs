//! Bytes to mesh or image and back.
//!
//! Readers are written for hostile input: every count is compared with the bytes that are left
//! and with [`ReadLimits`] before memory is taken, and [`read`] ends with one check of the whole
//! whatever the format. A reader never opens another file. Numbers are taken as they stand; the
//! caller knows their unit.

mod arrays;
pub mod csv;
mod cursor;
pub mod error;
pub mod glb;
mod gmsh;
pub mod limits;
pub mod nrrd;
mod obj;
pub mod output;
mod parsed;
pub mod ply;
mod scalar;
mod sniff;
pub mod stl;
mod surface_cleaning;
pub mod vtk;

pub use error::{FormatError, Member, Place};
pub use limits::ReadLimits;
pub use output::{ArrayValues, NamedValues, SurfaceOutput, VolumeOutput, WriteError};

use crate::image::ImageVolume;
use crate::mesh::{Frame, TriangleSurface, VolumeMesh, Warning};

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
}

impl MeshFormat {
    /// The format by its content; names and extensions of files are never asked.
    pub fn sniff(bytes: &[u8]) -> Option<MeshFormat> {
        sniff::sniff(without_byte_order_mark(bytes))
    }

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
    pub ignored_arrays: Vec<String>,
    pub warnings: Vec<Warning>,
}

/// Reads a mesh or an image of any known format.
pub fn read(bytes: &[u8], limits: &ReadLimits) -> Result<ReadMesh, FormatError> {
    let bytes = without_byte_order_mark(bytes);
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return Err(FormatError::Empty { detail: "the file holds nothing".into() });
    }
    let format = sniff::sniff(bytes)
        .ok_or_else(|| FormatError::UnsupportedFormat { detail: sniff::foreign_kind(bytes) })?;
    let parsed = match format {
        MeshFormat::Vtu => vtk::vtu::read(bytes, limits),
        MeshFormat::Vtp => vtk::vtp::read(bytes, limits),
        MeshFormat::VtkLegacy => vtk::legacy::read(bytes, limits),
        MeshFormat::Gmsh => gmsh::read(bytes, limits),
        MeshFormat::Stl => stl::read(bytes, limits),
        MeshFormat::Ply => ply::read(bytes, limits),
        MeshFormat::Obj => obj::read(bytes, limits),
        MeshFormat::Nrrd => return nrrd::read(bytes, limits),
    }?;
    parsed.into_mesh(format, limits)
}

fn without_byte_order_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}
