//! NRRD: scalar images with their place in space, raw or compressed with gzip, read and written.
//!
//! Values are kept as i16 where their type or their size allows it, else as f32. A detached header is refused:
//! a reader never opens another file.

mod header;

use std::borrow::Cow;
use std::io::{Read, Write};

use flate2::Compression;
use flate2::read::MultiGzDecoder;
use flate2::write::GzEncoder;

use super::cursor::Cursor;
use super::error::FormatError;
use super::limits::{MOST_BYTES_OF_ONE, ReadLimits, room_for};
use super::scalar::{ByteOrder, Scalar};
use super::{Mesh, MeshFormat, ReadMesh};
use crate::image::{ImageVolume, Voxels};
use crate::mesh::{Frame, IgnoredArrays, Vector, Warning};
use header::{Encoding, FORMAT, Header};

/// gzip level: beyond 4 a CT shrinks by a few per cent and takes twice as long.
const LEVEL: u32 = 4;

pub(super) fn read(bytes: &[u8], limits: &ReadLimits) -> Result<ReadMesh, FormatError> {
    let mut cursor = Cursor::new(FORMAT, bytes);
    let header = Header::read(&mut cursor, limits)?;
    let voxels: u64 = header.size.iter().map(|&size| size as u64).product();
    let wanted = voxels.saturating_mul(header.scalar.size());
    let start = cursor.clone();
    let mut warnings = Vec::new();
    let values = match header.encoding {
        Encoding::Gzip => Cow::Owned(inflate(&cursor, wanted, bytes.len(), limits)?),
        Encoding::Raw => {
            let values = cursor.take(wanted)?;
            warnings.extend(trailing(cursor.remaining()));
            Cow::Borrowed(values)
        }
    };
    let voxels = voxels_of(&values, header.scalar, header.order)?;
    let image = ImageVolume::new(header.size, header.placement, voxels)
        .map_err(|error| start.bad_bytes(error.to_string()))?;
    Ok(ReadMesh {
        format: MeshFormat::Nrrd,
        mesh: Mesh::Image(image),
        frame: header.frame,
        ignored: IgnoredArrays::default(),
        warnings,
    })
}

fn trailing(bytes: u64) -> Option<Warning> {
    let detail = format!("{bytes} bytes follow the last voxel");
    (bytes > 0).then(|| Warning::new("trailing-bytes", detail).with("bytes", bytes as f64))
}

/// As many bytes as the header promises, refused before memory is taken where they cannot be there.
fn inflate(
    cursor: &Cursor<'_>,
    wanted: u64,
    file_bytes: usize,
    limits: &ReadLimits,
) -> Result<Vec<u8>, FormatError> {
    let stored = cursor.rest();
    limits.decode_budget(file_bytes).charge(wanted)?;
    if wanted / MOST_BYTES_OF_ONE > stored.len() as u64 {
        let have = stored.len();
        return Err(cursor.bad_bytes(format!("{wanted} bytes declared in {have} compressed ones")));
    }
    let mut values = room_for(wanted as usize)?;
    // One byte more than promised is enough to see that the promise was wrong.
    let mut inflater = MultiGzDecoder::new(stored).take(wanted + 1);
    inflater.read_to_end(&mut values).map_err(|error| cursor.bad_bytes(error.to_string()))?;
    match values.len() as u64 {
        have if have == wanted => Ok(values),
        have if have > wanted => {
            Err(cursor.bad_bytes(format!("{wanted} bytes declared, more are there")))
        }
        have => Err(cursor.bad_bytes(format!("{wanted} bytes declared, {have} are there"))),
    }
}

fn voxels_of(bytes: &[u8], scalar: Scalar, order: ByteOrder) -> Result<Voxels, FormatError> {
    Ok(match scalar.fits_i16(bytes, order) {
        true => Voxels::I16(scalar.integers(bytes, order, |value| value as i16)?),
        false => Voxels::F32(scalar.singles(bytes, order)?),
    })
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
         space units: \"mm\" \"mm\" \"mm\"\nspace origin: {origin}\n\n",
        steps.join(" ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::Place;

    #[test]
    fn a_promise_beyond_what_deflate_can_keep_is_refused_before_memory_is_taken() {
        let cursor = Cursor::new(FORMAT, b"few bytes");
        let limits = ReadLimits::default();
        let error = inflate(&cursor, 16 << 20, 100, &limits).unwrap_err();
        let place = Place::Offset(0);
        let detail = "16777216 bytes declared in 9 compressed ones".to_owned();
        assert_eq!(error, FormatError::Parse { format: FORMAT, place, detail });
    }
}
