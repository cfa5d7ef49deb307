//! RLE: one run-length encoded segment for each byte of a pixel, the most significant first (PS3.5, annex G).

use super::bad;
use super::pixel_layout::PixelLayout;
use crate::format::cursor::Cursor;
use crate::format::error::FormatError;
use crate::format::limits::room_for;

const HEADER_BYTES: usize = 64;

pub(super) fn decode(bytes: &[u8], layout: &PixelLayout) -> Result<Vec<u16>, FormatError> {
    let mut cursor = Cursor::new(super::FORMAT, bytes);
    let mut header = [0_u32; HEADER_BYTES / 4];
    for number in &mut header {
        *number = u32::from_le_bytes(cursor.take_array()?);
    }
    let segments = layout.bytes_of_pixel();
    if header[0] as usize != segments {
        let detail = format!("{} RLE segments where {segments} are expected", header[0]);
        return Err(bad(layout.at, detail));
    }
    let mut pixels = room_for(layout.count())?;
    pixels.resize(layout.count(), 0);
    for segment in 0..segments {
        let from = header[1 + segment] as usize;
        let to = if segment + 1 < segments { header[2 + segment] as usize } else { bytes.len() };
        let within = bytes.get(from..to).filter(|_| from >= HEADER_BYTES);
        let within =
            within.ok_or_else(|| bad(layout.at, "an RLE segment has no place in the frame"))?;
        unpack(within, &mut pixels).ok_or_else(|| {
            let detail = format!("RLE segment {segment} does not fill {} pixels", layout.count());
            bad(layout.at, detail)
        })?;
    }
    Ok(pixels)
}

/// Shifts the bytes of one segment into the pixels; `None` where they end too early.
fn unpack(mut bytes: &[u8], pixels: &mut [u16]) -> Option<()> {
    let mut at = 0;
    while at < pixels.len() {
        let (&control, rest) = bytes.split_first()?;
        bytes = rest;
        let mut push = |byte: u8| {
            if let Some(pixel) = pixels.get_mut(at) {
                *pixel = *pixel << 8 | u16::from(byte);
            }
            at += 1;
        };
        match control {
            0..=127 => {
                let (literal, rest) = bytes.split_at_checked(usize::from(control) + 1)?;
                literal.iter().for_each(|&byte| push(byte));
                bytes = rest;
            }
            128 => {}
            129..=255 => {
                let (&byte, rest) = bytes.split_first()?;
                (0..257 - usize::from(control)).for_each(|_| push(byte));
                bytes = rest;
            }
        }
    }
    Some(())
}
