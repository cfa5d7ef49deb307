//! A zip archive as one image: the files of a DICOM series, or a MetaImage header with its voxels.
//!
//! Nothing is unpacked to anywhere. Names of files, which may hold those of patients, are neither kept nor told: files
//! are counted from 1 in the order of the archive.

mod zip;

use rayon::prelude::*;

use super::ReadMesh;
use super::dicom::{self, Part};
use super::error::FormatError;
use super::limits::ReadLimits;
use super::metaimage;
use crate::mesh::Warning;
use zip::{Archive, Entry};

pub(super) use zip::is_zip;

/// Bytes by which a file of the archive is distinguished.
const PREFIX: usize = 256;

/// Kind of a file of the archive, by its content.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Dicom,
    MetaImage,
    Archive,
    Other,
}

pub(super) fn read(bytes: &[u8], limits: &ReadLimits) -> Result<ReadMesh, FormatError> {
    let archive = Archive::open(bytes, limits)?;
    let kinds = archive.entries.iter().map(|entry| kind(&archive, entry));
    let kinds = kinds.collect::<Result<Vec<Kind>, FormatError>>()?;
    if let Some(entry) =
        archive.entries.iter().zip(&kinds).find(|(_, kind)| **kind == Kind::Archive)
    {
        return Err(entry.0.bad("an archive within an archive is not read"));
    }
    let of_kind = |wanted: Kind| -> Vec<&Entry> {
        let those = archive.entries.iter().zip(&kinds).filter(|(_, kind)| **kind == wanted);
        those.map(|(entry, _)| entry).collect()
    };
    let (slices, headers) = (of_kind(Kind::Dicom), of_kind(Kind::MetaImage));
    match (slices.as_slice(), headers.as_slice()) {
        ([], [header]) => read_metaimage(&archive, header, limits),
        ([_, ..], []) => read_series(&archive, &slices, limits),
        ([], []) => {
            let detail = "it is a zip archive without a DICOM file or a MetaImage header in it";
            Err(FormatError::UnsupportedFormat { detail })
        }
        (slices, headers) => {
            let (slices, headers) = (slices.len(), headers.len());
            let detail =
                format!("{slices} DICOM files and {headers} MetaImage headers: which is meant?");
            Err(archive.bad(detail))
        }
    }
}

fn kind(archive: &Archive<'_>, entry: &Entry) -> Result<Kind, FormatError> {
    let start = archive.start(entry, PREFIX)?;
    Ok(if dicom::is_dicom(&start) {
        Kind::Dicom
    } else if is_zip(&start) {
        Kind::Archive
    } else if metaimage::is_metaimage(&start) {
        Kind::MetaImage
    } else {
        Kind::Other
    })
}

fn read_series(
    archive: &Archive<'_>,
    entries: &[&Entry],
    limits: &ReadLimits,
) -> Result<ReadMesh, FormatError> {
    let read = |entry: &&Entry| {
        let bytes = archive.bytes(entry)?;
        dicom::read_part(&bytes, entry.number, limits).map_err(|error| entry.placed(error))
    };
    let parts = entries.par_iter().map(read).collect::<Result<Vec<Part>, FormatError>>()?;
    let mut read = dicom::assemble(parts, limits)?;
    read.warnings.extend(passed_over(archive.entries.len() - entries.len()));
    Ok(read)
}

fn passed_over(files: usize) -> Option<Warning> {
    let detail =
        format!("{files} files of the archive are no part of the image and are passed over");
    (files > 0).then(|| Warning::new("files-passed-over", detail).with("files", files as f64))
}

fn read_metaimage(
    archive: &Archive<'_>,
    header: &Entry,
    limits: &ReadLimits,
) -> Result<ReadMesh, FormatError> {
    let bytes = archive.bytes(header)?;
    let placed = |error| header.placed(error);
    let Some(name) = metaimage::data_file(&bytes, limits).map_err(placed)? else {
        let mut read = metaimage::read(&bytes, limits).map_err(placed)?;
        read.warnings.extend(passed_over(archive.entries.len() - 1));
        return Ok(read);
    };
    let voxels = archive.entries.iter().find(|entry| entry.is_beside(header, &name));
    let missing = || header.bad("the file of its voxels is not beside it in the archive");
    let voxels = archive.bytes(voxels.ok_or_else(missing)?)?;
    let mut read = metaimage::read_pair(&bytes, &voxels, limits).map_err(placed)?;
    read.warnings.extend(passed_over(archive.entries.len() - 2));
    Ok(read)
}
