//! File formats of meshes and images: readers and writers.
//!
//! Readers are written for hostile input: every count is compared with the bytes that are left
//! and with [`ReadLimits`] before memory is taken, and [`read`] ends with one check of the whole
//! whatever the format. A reader never opens another file. Numbers are taken as they stand; the
//! caller knows their unit.

mod archive;
mod arrays;
pub mod csv;
mod cursor;
mod dicom;
pub mod error;
mod file;
pub mod glb;
mod gmsh;
mod gzip;
mod ignored_field;
pub mod limits;
mod lps;
mod metaimage;
mod nifti;
pub mod nrrd;
mod obj;
pub mod output;
mod parsed;
pub mod ply;
mod scalar;
mod sniff;
pub mod stl;
mod surface_cleaning;
mod voxels;
pub mod vtk;
pub use arrays::{DISPLACEMENT, SurfaceArrays};
pub use error::{FilePosition, FormatError, Member};
pub use file::{Mesh, MeshFormat, ReadMesh};
pub use limits::ReadLimits;
pub use lps::VolumeInLps;
pub use output::{ArrayValues, ColourScale, NamedValues, SurfaceOutput, VolumeOutput, WriteError};

/// Reads a mesh or an image of any known format.
pub fn read(bytes: &[u8], limits: &ReadLimits) -> Result<ReadMesh, FormatError> {
    let bytes = sniff::without_byte_order_mark(bytes);
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
        MeshFormat::Nifti => return nifti::read(bytes, limits),
        MeshFormat::MetaImage => return metaimage::read(bytes, limits),
        MeshFormat::Dicom if archive::is_zip(bytes) => return archive::read(bytes, limits),
        MeshFormat::Dicom => return dicom::read(bytes, limits),
    }?;
    parsed.into_mesh(format, limits)
}
