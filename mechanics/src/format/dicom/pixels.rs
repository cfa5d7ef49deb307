//! Pixels of one slice: from the bytes of the file to the numbers that they stand for.

use super::attributes::StoredPixels;
use super::bad;
use super::pixel_layout::PixelLayout;
use super::transfer_syntax::{PixelCoding, TransferSyntax};
use super::{jpeg_lossless, rle};
use crate::format::error::FormatError;
use crate::format::limits::{MOST_BYTES_OF_ONE, room_for};
use crate::format::scalar::{ByteOrder, Scalar};

/// The stored numbers, row by row.
pub(super) fn decode(
    pixels: &StoredPixels<'_>,
    layout: &PixelLayout,
    syntax: TransferSyntax,
) -> Result<Vec<u16>, FormatError> {
    let TransferSyntax { order, pixels: coding, .. } = syntax;
    match (pixels, coding) {
        (StoredPixels::Native(bytes), PixelCoding::Native) => native(bytes, layout, order),
        (StoredPixels::Pieces(pieces), PixelCoding::Rle) => {
            let bytes = joined(pieces, layout)?;
            rle::decode(&bytes, layout)
        }
        (StoredPixels::Pieces(pieces), PixelCoding::JpegLossless) => {
            let bytes = joined(pieces, layout)?;
            jpeg_lossless::decode(&bytes, layout)
        }
        (StoredPixels::Native(_) | StoredPixels::Pieces(_), _) => {
            Err(bad(layout.at, "the pixels are not encoded as the transfer syntax says"))
        }
    }
}

fn native(bytes: &[u8], layout: &PixelLayout, order: ByteOrder) -> Result<Vec<u16>, FormatError> {
    let wanted = layout.count() * layout.bytes_of_pixel();
    // A byte fills an odd length up.
    if bytes.len() != wanted && bytes.len() != wanted + wanted % 2 {
        let have = bytes.len();
        let detail = format!("{wanted} bytes of pixels declared, {have} are there");
        return Err(bad(layout.at, detail));
    }
    let scalar = if layout.bits_allocated == 8 { Scalar::U8 } else { Scalar::U16 };
    scalar.integers(&bytes[..wanted], order, |number| number as u16)
}

/// The pieces of the one frame as one, behind the table of offsets.
fn joined(pieces: &[&[u8]], layout: &PixelLayout) -> Result<Vec<u8>, FormatError> {
    let frame = pieces.get(1..).unwrap_or_default();
    let bytes: usize = frame.iter().map(|piece| piece.len()).sum();
    if layout.count() as u64 / MOST_BYTES_OF_ONE > bytes as u64 {
        let detail = format!("{} pixels declared in {bytes} compressed bytes", layout.count());
        return Err(bad(layout.at, detail));
    }
    let mut joined = room_for(bytes)?;
    frame.iter().for_each(|piece| joined.extend_from_slice(piece));
    Ok(joined)
}
