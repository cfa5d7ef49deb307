//! NRRD: scalar images with their place in space, raw or compressed with gzip, read and written.
//!
//! Values are kept as i16 where their type or their size allows it, else as f32. A detached header is refused:
//! a reader never opens another file.

mod header;
mod segments;

use std::io::Write;

use flate2::Compression;
use flate2::write::GzEncoder;

use super::arrays::SurfaceArrays;
use super::cursor::Cursor;
use super::error::FormatError;
use super::gzip::GzipReader;
use super::limits::{DecodeBudget, ReadLimits};
use super::voxels::{Storage, check_promise, decode, trailing};
use super::{Mesh, MeshFormat, ReadMesh};
use crate::image::{ImageVolume, Voxels};
use crate::mesh::{Frame, IgnoredArrays, Vector};
use header::{Encoding, FORMAT, Header};

/// gzip level: beyond 4 a CT shrinks by a few per cent and takes twice as long.
const LEVEL: u32 = 4;

pub(super) fn read(bytes: &[u8], limits: &ReadLimits) -> Result<ReadMesh, FormatError> {
    let mut cursor = Cursor::new(FORMAT, bytes);
    let header = Header::read(&mut cursor, limits)?;
    let storage = header.storage();
    let start = cursor.clone();
    let mut warnings = Vec::new();
    let voxels = match header.encoding {
        Encoding::Gzip => inflate(&cursor, &storage, bytes.len(), limits)?,
        Encoding::Raw => {
            let values = cursor.take(storage.bytes())?;
            warnings.extend(trailing(cursor.remaining()));
            decode(values, &storage, &start, DecodeBudget::of_stored())?.voxels
        }
    };
    let image = ImageVolume::new(header.size, header.placement, voxels)
        .map_err(|error| start.bad_bytes(error.to_string()))?;
    Ok(ReadMesh {
        format: MeshFormat::Nrrd,
        mesh: Mesh::Image(image.with_label_names(header.label_names)),
        frame: header.frame,
        ignored: IgnoredArrays::default(),
        of_points: SurfaceArrays::default(),
        warnings,
    })
}

/// As many numbers as the header promises, refused before memory is taken where they cannot be there.
fn inflate(
    place: &Cursor<'_>,
    storage: &Storage,
    file_bytes: usize,
    limits: &ReadLimits,
) -> Result<Voxels, FormatError> {
    let budget = check_promise(storage.bytes(), place, file_bytes, limits)?;
    let decoded = decode(GzipReader::new(place.rest()), storage, place, budget)?;
    if decoded.followed_by > 0 {
        let wanted = storage.bytes();
        return Err(place.bad_bytes(format!("{wanted} bytes declared, more are there")));
    }
    Ok(decoded.voxels)
}

/// One file with the voxels compressed, the frame as `space`, and no other word about where they came from.
pub fn write(image: &ImageVolume, frame: Frame) -> Vec<u8> {
    let (kind, mut values) = match image.voxels() {
        Voxels::I16(values) => ("short", Values::I16(values.chunks(PIECE))),
        Voxels::F32(values) => ("float", Values::F32(values.chunks(PIECE))),
    };
    let bytes = header(image, frame, kind).into_bytes();
    let mut encoder = GzEncoder::new(bytes, Compression::new(LEVEL));
    while let Some(piece) = values.next_bytes() {
        encoder.write_all(&piece).expect("writing to memory does not fail");
    }
    encoder.finish().expect("writing to memory does not fail")
}

/// Voxels that are turned into bytes at a time.
const PIECE: usize = 1 << 16;

enum Values<'a> {
    I16(std::slice::Chunks<'a, i16>),
    F32(std::slice::Chunks<'a, f32>),
}

impl Values<'_> {
    fn next_bytes(&mut self) -> Option<Vec<u8>> {
        match self {
            Values::I16(pieces) => {
                pieces.next().map(|piece| piece.iter().flat_map(|v| v.to_le_bytes()).collect())
            }
            Values::F32(pieces) => {
                pieces.next().map(|piece| piece.iter().flat_map(|v| v.to_le_bytes()).collect())
            }
        }
    }
}

fn header(image: &ImageVolume, frame: Frame, kind: &str) -> String {
    let space = match frame {
        Frame::Lps => "left-posterior-superior",
        Frame::Ras => "right-anterior-superior",
        Frame::Unspecified => "3D-right-handed",
    };
    let vector = |v: &Vector| format!("({},{},{})", v.x, v.y, v.z);
    let [i, j, k] = image.size();
    let steps = image.placement().steps.each_ref().map(vector);
    let origin = vector(&image.placement().origin);
    format!(
        "NRRD0004\ntype: {kind}\ndimension: 3\nspace: {space}\nsizes: {i} {j} {k}\n\
         space directions: {}\nkinds: domain domain domain\nendian: little\nencoding: gzip\n\
         space units: \"mm\" \"mm\" \"mm\"\nspace origin: {origin}\n{}\n",
        steps.join(" "),
        segments::lines(image.label_names())
    )
}
