//! The attributes of a file that are read, and their values as words and numbers.

use std::collections::BTreeMap;

use super::bad;
use super::element::{Coding, Tag, Value};
use super::transfer_syntax::TransferSyntax;
use crate::format::cursor::Cursor;
use crate::format::error::FormatError;
use crate::format::scalar::ByteOrder;

pub(super) const IMAGE_TYPE: Tag = 0x0008_0008;
pub(super) const MODALITY: Tag = 0x0008_0060;
pub(super) const PATIENT_NAME: Tag = 0x0010_0010;
pub(super) const PATIENT: Tag = 0x0010_0020;
pub(super) const STUDY: Tag = 0x0020_000D;
pub(super) const SERIES: Tag = 0x0020_000E;
pub(super) const POSITION: Tag = 0x0020_0032;
pub(super) const ORIENTATION: Tag = 0x0020_0037;
pub(super) const FRAME_OF_REFERENCE: Tag = 0x0020_0052;
pub(super) const SAMPLES: Tag = 0x0028_0002;
pub(super) const PHOTOMETRIC: Tag = 0x0028_0004;
pub(super) const FRAMES: Tag = 0x0028_0008;
pub(super) const ROWS: Tag = 0x0028_0010;
pub(super) const COLUMNS: Tag = 0x0028_0011;
pub(super) const PIXEL_SPACING: Tag = 0x0028_0030;
pub(super) const BITS_ALLOCATED: Tag = 0x0028_0100;
pub(super) const BITS_STORED: Tag = 0x0028_0101;
pub(super) const HIGH_BIT: Tag = 0x0028_0102;
pub(super) const REPRESENTATION: Tag = 0x0028_0103;
pub(super) const PADDING: Tag = 0x0028_0120;
pub(super) const PADDING_LIMIT: Tag = 0x0028_0121;
pub(super) const INTERCEPT: Tag = 0x0028_1052;
pub(super) const SLOPE: Tag = 0x0028_1053;
const PIXELS: Tag = 0x7FE0_0010;

/// Those that are kept, with the words of messages.
const KEPT: [(Tag, &str); 23] = [
    (IMAGE_TYPE, "Image Type"),
    (MODALITY, "Modality"),
    (PATIENT_NAME, "Patient's Name"),
    (PATIENT, "Patient ID"),
    (STUDY, "Study Instance UID"),
    (SERIES, "Series Instance UID"),
    (POSITION, "Image Position (Patient)"),
    (ORIENTATION, "Image Orientation (Patient)"),
    (FRAME_OF_REFERENCE, "Frame of Reference UID"),
    (SAMPLES, "Samples per Pixel"),
    (PHOTOMETRIC, "Photometric Interpretation"),
    (FRAMES, "Number of Frames"),
    (ROWS, "Rows"),
    (COLUMNS, "Columns"),
    (PIXEL_SPACING, "Pixel Spacing"),
    (BITS_ALLOCATED, "Bits Allocated"),
    (BITS_STORED, "Bits Stored"),
    (HIGH_BIT, "High Bit"),
    (REPRESENTATION, "Pixel Representation"),
    (PADDING, "Pixel Padding Value"),
    (PADDING_LIMIT, "Pixel Padding Range Limit"),
    (INTERCEPT, "Rescale Intercept"),
    (SLOPE, "Rescale Slope"),
];

const PREAMBLE: u64 = 132;
const META_GROUP: Tag = 0x0002;
const SYNTAX: Tag = 0x0002_0010;

/// The pixels as they stand in the file.
pub(super) enum StoredPixels<'a> {
    Native(&'a [u8]),
    /// Compressed, in pieces.
    Pieces(Vec<&'a [u8]>),
}

/// What was kept of a file.
pub(super) struct Attributes<'a> {
    pub syntax: TransferSyntax,
    coding: Coding,
    known: BTreeMap<Tag, &'a [u8]>,
    pub pixels: Option<StoredPixels<'a>>,
    /// Where they begin.
    pub pixels_at: u64,
}

pub(super) fn name(tag: Tag) -> &'static str {
    KEPT.iter().find(|(known, _)| *known == tag).map_or("an attribute", |(_, name)| name)
}

fn words(bytes: &[u8]) -> impl Iterator<Item = String> {
    let text = String::from_utf8_lossy(bytes).into_owned();
    let plain = |word: &str| word.trim_matches(|c: char| c == '\0' || c.is_whitespace()).to_owned();
    text.split('\\').map(plain).collect::<Vec<_>>().into_iter()
}

impl<'a> Attributes<'a> {
    pub fn read(bytes: &'a [u8]) -> Result<Attributes<'a>, FormatError> {
        let mut cursor = Cursor::new(super::FORMAT, bytes);
        cursor.take(PREAMBLE)?;
        let syntax = read_syntax(&mut cursor)?;
        let coding = Coding { explicit: syntax.explicit, order: syntax.order };
        let (known, pixels, pixels_at) = (BTreeMap::new(), None, 0);
        let mut attributes = Attributes { syntax, coding, known, pixels, pixels_at };
        while !cursor.is_at_end() && attributes.pixels.is_none() {
            attributes.take(&mut cursor, bytes.len())?;
        }
        Ok(attributes)
    }

    fn take(&mut self, cursor: &mut Cursor<'a>, length: usize) -> Result<(), FormatError> {
        let head = self.coding.head(cursor)?;
        self.pixels_at = length as u64 - cursor.remaining();
        match (head.tag, self.coding.value(head, cursor)?) {
            (PIXELS, Value::Bytes(bytes)) => self.pixels = Some(StoredPixels::Native(bytes)),
            (PIXELS, Value::Open) => {
                self.pixels = Some(StoredPixels::Pieces(self.coding.fragments(cursor)?));
            }
            (_, Value::Open) => self.coding.skip_open(head, cursor)?,
            (tag, Value::Bytes(bytes)) => {
                if KEPT.iter().any(|(known, _)| *known == tag) {
                    self.known.insert(tag, bytes);
                }
            }
        }
        Ok(())
    }

    fn missing(tag: Tag) -> FormatError {
        bad(0, format!("the attribute {} is missing", name(tag)))
    }

    /// The first word of a value; nothing where there is none.
    pub fn word(&self, tag: Tag) -> Option<String> {
        let word = words(self.known.get(&tag)?).next()?;
        (!word.is_empty()).then_some(word)
    }

    pub fn has_word(&self, tag: Tag, wanted: &str) -> bool {
        self.known.get(&tag).is_some_and(|bytes| words(bytes).any(|word| word == wanted))
    }

    /// A number of 16 bits that has to be there.
    pub fn count(&self, tag: Tag) -> Result<u16, FormatError> {
        let bytes = *self.known.get(&tag).ok_or_else(|| Self::missing(tag))?;
        let bytes = bytes.get(..2).and_then(|bytes| bytes.try_into().ok());
        let bytes = bytes.ok_or_else(|| bad(0, format!("{} has not two bytes", name(tag))))?;
        Ok(self.coding.u16(bytes))
    }

    /// The same where there may be none, signed or not, as pixels are.
    pub fn integer(&self, tag: Tag, is_signed: bool) -> Result<Option<i64>, FormatError> {
        if self.known.get(&tag).is_none_or(|bytes| bytes.is_empty()) {
            return Ok(None);
        }
        let bits = self.count(tag)?;
        Ok(Some(if is_signed { i64::from(bits as i16) } else { i64::from(bits) }))
    }

    /// Decimal numbers, as many as asked for, where the attribute is there.
    pub fn reals<const N: usize>(&self, tag: Tag) -> Result<Option<[f64; N]>, FormatError> {
        let Some(bytes) = self.known.get(&tag).filter(|bytes| !bytes.is_empty()) else {
            return Ok(None);
        };
        let numbers = words(bytes).map(|word| word.parse().ok().filter(|x: &f64| x.is_finite()));
        let numbers: Option<Vec<f64>> = numbers.take(N + 1).collect();
        let numbers = numbers.and_then(|numbers| <[f64; N]>::try_from(numbers).ok());
        let refused = || bad(0, format!("{} has not {N} finite numbers", name(tag)));
        numbers.ok_or_else(refused).map(Some)
    }

    pub fn needed<const N: usize>(&self, tag: Tag) -> Result<[f64; N], FormatError> {
        self.reals(tag)?.ok_or_else(|| Self::missing(tag))
    }
}

/// The file meta information, which is explicit and little endian in every file.
fn read_syntax(cursor: &mut Cursor<'_>) -> Result<TransferSyntax, FormatError> {
    let coding = Coding { explicit: true, order: ByteOrder::Little };
    let mut syntax = None;
    loop {
        let mut ahead = cursor.clone();
        let group = ahead.take_array().map(|bytes| Tag::from(coding.u16(bytes)));
        if group != Ok(META_GROUP) {
            break;
        }
        let head = coding.head(cursor)?;
        match coding.value(head, cursor)? {
            Value::Bytes(bytes) if head.tag == SYNTAX => syntax = words(bytes).next(),
            Value::Bytes(_) => {}
            Value::Open => coding.skip_open(head, cursor)?,
        }
    }
    let uid =
        syntax.ok_or_else(|| cursor.bad_bytes("the file does not name its transfer syntax"))?;
    TransferSyntax::of(&uid).map_err(|detail| cursor.bad_bytes(detail))
}
