//! MetaImage: scalar images with their place in LPS, header and voxels in one file, raw or compressed with zlib.
//!
//! Source: the MetaIO documentation of ITK. A header whose voxels are in another file is read only together with it.

mod header;

use flate2::read::ZlibDecoder;

use super::arrays::SurfaceArrays;
use super::cursor::Cursor;
use super::error::FormatError;
use super::limits::{DecodeBudget, ReadLimits};
use super::voxels::{Decoded, check_promise, decode, trailing};
use super::{Mesh, MeshFormat, ReadMesh};
use crate::image::ImageVolume;
use crate::mesh::{Frame, IgnoredArrays};
pub(super) use header::is_metaimage;
use header::{DataFile, FORMAT, Header};

pub(super) fn read(bytes: &[u8], limits: &ReadLimits) -> Result<ReadMesh, FormatError> {
    let mut cursor = Cursor::new(FORMAT, bytes);
    let header = Header::read(&mut cursor, limits)?;
    match &header.data_file {
        DataFile::Here => read_voxels(header, &cursor, limits),
        DataFile::Elsewhere { .. } => {
            let detail = "the voxels are in another file, which is never opened: send one .mha, or .mhd and \
                 its file in one zip archive";
            Err(cursor.bad_line(detail))
        }
    }
}

/// The name of the file that has the voxels of a header, where they are not behind it.
pub(super) fn data_file(bytes: &[u8], limits: &ReadLimits) -> Result<Option<String>, FormatError> {
    Ok(match Header::read(&mut Cursor::new(FORMAT, bytes), limits)?.data_file {
        DataFile::Here => None,
        DataFile::Elsewhere { name } => Some(name),
    })
}

/// A header with its voxels beside it.
pub(super) fn read_pair(
    header: &[u8],
    voxels: &[u8],
    limits: &ReadLimits,
) -> Result<ReadMesh, FormatError> {
    let header = Header::read(&mut Cursor::new(FORMAT, header), limits)?;
    read_voxels(header, &Cursor::new(FORMAT, voxels), limits)
}

fn read_voxels(
    header: Header,
    place: &Cursor<'_>,
    limits: &ReadLimits,
) -> Result<ReadMesh, FormatError> {
    let Decoded { voxels, followed_by } = decoded(&header, place, limits)?;
    let image = ImageVolume::new(header.size, header.placement, voxels)
        .map_err(|error| place.bad_bytes(error.to_string()))?;
    Ok(ReadMesh {
        format: MeshFormat::MetaImage,
        mesh: Mesh::Image(image),
        frame: Some(Frame::Lps),
        ignored: IgnoredArrays::default(),
        of_points: SurfaceArrays::default(),
        warnings: header.warning.into_iter().chain(trailing(followed_by)).collect(),
    })
}

fn decoded(
    header: &Header,
    place: &Cursor<'_>,
    limits: &ReadLimits,
) -> Result<Decoded, FormatError> {
    let storage = &header.storage;
    if header.is_compressed {
        let stored = match header.compressed_bytes {
            Some(bytes) => place.clone().take(bytes)?,
            None => place.rest(),
        };
        let budget = check_promise(storage.bytes(), place, stored.len(), limits)?;
        return decode(ZlibDecoder::new(stored), storage, place, budget);
    }
    // The length of the whole is known: what is there is checked before memory is taken.
    place.clone().take(storage.bytes())?;
    decode(place.rest(), storage, place, DecodeBudget::of_stored())
}
