//! NIfTI-1 and NIfTI-2: scalar images with their place in RAS, in one file, as it is or compressed with gzip.
//!
//! Source: nifti1.h and nifti2.h of the NIfTI Data Format Working Group. The descriptions, which may name the patient,
//! are passed over. A pair of header and voxels in two files is refused: a reader never opens another file.

mod header;
mod label_table;
mod orientation;
mod refusal;

use std::io::Read;

use super::arrays::SurfaceArrays;
use super::cursor::Cursor;
use super::error::FormatError;
use super::gzip::{self, GzipReader};
use super::limits::{DecodeBudget, ReadLimits};
use super::voxels::{check_promise, decode, trailing};
use super::{Mesh, MeshFormat, ReadMesh};
use crate::image::ImageVolume;
use crate::mesh::{Frame, IgnoredArrays};
use header::{Header, PREFIX};
use refusal::{FORMAT, bad};

/// Bytes between the header and the voxels: extensions.
const MOST_EXTENSION_BYTES: u64 = 16 << 20;

/// Whether this is NIfTI, compressed or not.
pub(super) fn is_nifti(bytes: &[u8]) -> bool {
    if !bytes.starts_with(gzip::MAGIC) {
        return header::is_nifti(bytes);
    }
    let mut start = Vec::new();
    let read = GzipReader::new(bytes).take(PREFIX as u64).read_to_end(&mut start);
    read.is_ok() && header::is_nifti(&start)
}

pub(super) fn read(bytes: &[u8], limits: &ReadLimits) -> Result<ReadMesh, FormatError> {
    let place = Cursor::new(FORMAT, bytes);
    if bytes.starts_with(gzip::MAGIC) {
        let check = |header: &Header| {
            let wanted = header.storage.bytes().saturating_add(header.voxels_at);
            check_promise(wanted, &place, bytes.len(), limits)
        };
        return read_stream(GzipReader::new(bytes), &place, limits, check);
    }
    let check = |header: &Header| {
        let wanted = header.storage.bytes().saturating_add(header.voxels_at);
        place.clone().take(wanted).map(|_| DecodeBudget::of_stored())
    };
    read_stream(bytes, &place, limits, check)
}

fn read_stream(
    mut source: impl Read,
    place: &Cursor<'_>,
    limits: &ReadLimits,
    check: impl Fn(&Header) -> Result<DecodeBudget, FormatError>,
) -> Result<ReadMesh, FormatError> {
    let header = Header::read(&mut source, limits)?;
    let budget = check(&header)?;
    let between = header.voxels_at - header.bytes;
    if between > MOST_EXTENSION_BYTES {
        let detail = format!("{between} bytes stand before the voxels, at most 16 MiB are read");
        return Err(bad(header.bytes, detail));
    }
    let mut extensions = Vec::new();
    let read = source.by_ref().take(between).read_to_end(&mut extensions);
    read.map_err(|error| place.bad_bytes(error.to_string()))?;
    let names = label_table::names(&extensions, limits);
    let decoded = decode(source, &header.storage, place, budget)?;
    let image = ImageVolume::new(header.size, header.placement, decoded.voxels)
        .map_err(|error| bad(header.voxels_at, error.to_string()))?;
    Ok(ReadMesh {
        format: MeshFormat::Nifti,
        mesh: Mesh::Image(image.with_label_names(names)),
        frame: Some(Frame::Ras),
        ignored: IgnoredArrays::default(),
        of_points: SurfaceArrays::default(),
        warnings: header.warnings.into_iter().chain(trailing(decoded.followed_by)).collect(),
    })
}
