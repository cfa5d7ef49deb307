//! JPEG Lossless: pixels predicted from their neighbours, and the differences as Huffman codes (process 14).
//!
//! Source: ITU-T T.81, annex H; all seven predictors are read, of which DICOM prefers the first.

use super::bad;
use super::jpeg_huffman::{Bits, HuffmanTable};
use super::pixel_layout::PixelLayout;
use crate::format::cursor::Cursor;
use crate::format::error::FormatError;
use crate::format::limits::room_for;

const START: [u8; 2] = [0xFF, 0xD8];

/// What the segments before the scan say.
#[derive(Default)]
struct Frame {
    tables: [Option<HuffmanTable>; 4],
    precision: Option<u32>,
    /// Pixels between restart markers; none without.
    interval: usize,
}

/// How the scan is to be read.
struct Scan<'a> {
    table: &'a HuffmanTable,
    predictor: u8,
    point_transform: u32,
    precision: u32,
    interval: usize,
    columns: usize,
}

pub(super) fn decode(bytes: &[u8], layout: &PixelLayout) -> Result<Vec<u16>, FormatError> {
    let mut cursor = Cursor::new(super::FORMAT, bytes);
    let refuse = |detail: String| bad(layout.at, format!("JPEG Lossless: {detail}"));
    if cursor.take_array()? != START {
        return Err(refuse("the frame does not start as JPEG".into()));
    }
    let mut frame = Frame::default();
    loop {
        let [mark, mut code] = cursor.take_array()?;
        if mark != 0xFF {
            return Err(refuse("a marker is expected".into()));
        }
        // Any number of 0xFF may fill up before a marker.
        while code == 0xFF {
            [code] = cursor.take_array()?;
        }
        let length = u64::from(u16::from_be_bytes(cursor.take_array()?));
        let segment = cursor.take(length.saturating_sub(2))?;
        match code {
            0xC3 => frame.precision = Some(precision(segment, layout).map_err(refuse)?),
            0xC4 => {
                frame.define_tables(segment).ok_or_else(|| refuse("a table is no code".into()))?
            }
            0xDD => frame.interval = interval(segment, layout).map_err(refuse)?,
            0xDA => {
                let scan = frame.scan(segment, layout).map_err(refuse)?;
                return scan.read(cursor.rest(), layout);
            }
            0xC0..=0xCF if code != 0xC8 && code != 0xCC => {
                return Err(refuse(format!("process {:#04x} is another than lossless", code)));
            }
            0xE0..=0xEF | 0xFE => {}
            other => return Err(refuse(format!("marker {other:#04x} is not expected"))),
        }
    }
}

/// The bits of a pixel; the size has to be that of the slice.
fn precision(segment: &[u8], layout: &PixelLayout) -> Result<u32, String> {
    let &[bits, h1, h0, w1, w0, components, _, sampling, _] = segment else {
        return Err("the frame header has not one component".into());
    };
    let size = [u16::from_be_bytes([w1, w0]), u16::from_be_bytes([h1, h0])].map(usize::from);
    if size != layout.size {
        let [columns, rows] = layout.size;
        return Err(format!(
            "{} x {} pixels where the slice has {columns} x {rows}",
            size[0], size[1]
        ));
    }
    if components != 1 || sampling != 0x11 {
        return Err(format!("{components} components"));
    }
    match u32::from(bits) {
        bits @ 2..=16 if bits <= u32::from(layout.bits_allocated) => Ok(bits),
        bits => Err(format!("{bits} bits a pixel")),
    }
}

fn interval(segment: &[u8], layout: &PixelLayout) -> Result<usize, String> {
    let &[high, low] = segment else { return Err("the restart interval has not two bytes".into()) };
    let interval = usize::from(u16::from_be_bytes([high, low]));
    match interval % layout.size[0] {
        0 => Ok(interval),
        _ => Err(format!("a restart interval of {interval} pixels is not one of whole rows")),
    }
}

impl Frame {
    fn define_tables(&mut self, mut segment: &[u8]) -> Option<()> {
        while !segment.is_empty() {
            let (head, rest) = segment.split_at_checked(17)?;
            let counts: [u8; 16] = head[1..].try_into().ok()?;
            let total = counts.iter().map(|&count| usize::from(count)).sum();
            let (values, rest) = rest.split_at_checked(total)?;
            *self.tables.get_mut(usize::from(head[0]))? = Some(HuffmanTable::new(&counts, values)?);
            segment = rest;
        }
        Some(())
    }

    fn scan(&self, segment: &[u8], layout: &PixelLayout) -> Result<Scan<'_>, String> {
        let &[1, _, tables, predictor, _, point_transform] = segment else {
            return Err("the scan has not one component".into());
        };
        let precision = self.precision.ok_or("the scan comes before its frame")?;
        let table = self.tables.get(usize::from(tables >> 4)).and_then(Option::as_ref);
        let table = table.ok_or("the table of the scan is not defined")?;
        let point_transform = u32::from(point_transform & 15);
        if !(1..=7).contains(&predictor) || point_transform >= precision {
            return Err(format!("predictor {predictor} with point transform {point_transform}"));
        }
        let (interval, columns) = (self.interval, layout.size[0]);
        Ok(Scan { table, predictor, point_transform, precision, interval, columns })
    }
}

impl Scan<'_> {
    fn read(&self, bytes: &[u8], layout: &PixelLayout) -> Result<Vec<u16>, FormatError> {
        let mut pixels: Vec<u16> = room_for(layout.count())?;
        let mut bits = Bits::new(bytes);
        // The first row of the image, and of each restart, is predicted along itself.
        let mut first = 0;
        while pixels.len() < layout.count() {
            let at = pixels.len();
            if self.interval > 0 && at > 0 && at.is_multiple_of(self.interval) {
                let number = (at / self.interval - 1) as u8;
                if !bits.restart(number) {
                    return Err(self.bad(at, layout, "a restart marker is missing"));
                }
                first = at;
            }
            let difference = self.difference(&mut bits);
            let difference =
                difference.ok_or_else(|| self.bad(at, layout, "no code word fits the bits"))?;
            pixels.push(self.predicted(&pixels, first).wrapping_add(difference));
            if bits.is_overdrawn() {
                return Err(self.bad(at, layout, "the bits end"));
            }
        }
        pixels.iter_mut().for_each(|pixel| *pixel <<= self.point_transform);
        Ok(pixels)
    }

    fn bad(&self, at: usize, layout: &PixelLayout, detail: &str) -> FormatError {
        bad(layout.at, format!("JPEG Lossless: {detail} at pixel {at} of {}", layout.count()))
    }

    /// T.81, H.1.2.2: the number of bits as a code word, then the bits; modulo 2^16.
    fn difference(&self, bits: &mut Bits<'_>) -> Option<u16> {
        let size = u32::from(bits.decode(self.table)?);
        match size {
            0 => Some(0),
            1..=15 => {
                let number = bits.take(size) as i32;
                let is_negative = number >> (size - 1) == 0;
                Some(if is_negative { number - (1 << size) + 1 } else { number } as u16)
            }
            16 => Some(1 << 15),
            _ => None,
        }
    }

    fn predicted(&self, pixels: &[u16], first: usize) -> u16 {
        let at = pixels.len();
        if at == first {
            return 1 << (self.precision - self.point_transform - 1);
        }
        if at - first < self.columns {
            return pixels[at - 1];
        }
        let above = pixels[at - self.columns];
        if at.is_multiple_of(self.columns) {
            return above;
        }
        let [a, b, c] = [pixels[at - 1], above, pixels[at - self.columns - 1]].map(i32::from);
        let predicted = match self.predictor {
            1 => a,
            2 => b,
            3 => c,
            4 => a + b - c,
            5 => a + ((b - c) >> 1),
            6 => b + ((a - c) >> 1),
            _ => (a + b) >> 1,
        };
        predicted as u16
    }
}
