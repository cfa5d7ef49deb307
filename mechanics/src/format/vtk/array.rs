//! The values of VTK XML arrays: text, base64 or raw bytes, with or without zlib.
//!
//! A compressed array starts with the header
//! `[blocks][bytes of a block][bytes of the last block, 0 if full][compressed bytes of each block]`,
//! a plain one with `[bytes]`; each number is a UInt32 or a UInt64. In base64 the header may be
//! encoded apart from the data; both ways are read.
//!
//! Source: VTK File Formats, docs.vtk.org, and vtkXMLDataParser.cxx.

use std::borrow::Cow;
use std::io::{ErrorKind, Read};

use flate2::read::ZlibDecoder;
use rayon::prelude::*;

use super::document::{Appended, Content, DataArray, Document};
use super::source::Source;
use crate::format::cursor::find;
use crate::format::error::{FilePosition, FormatError};
use crate::format::limits::{DecodeBudget, MOST_BYTES_OF_ONE, ReadLimits, room_for};
use crate::format::scalar::Scalar;

/// Blocks of an array that are inflated side by side: what they are copied to stays small however many there are.
const BLOCKS_AT_ONCE: usize = 256;

pub(super) struct Decoder<'d, 'a> {
    document: &'d Document<'a>,
    budget: DecodeBudget,
    /// How much of raw appended data was read, from its start to the end of the last of its arrays.
    raw_end: usize,
}

impl<'d, 'a> Decoder<'d, 'a> {
    pub fn document(&self) -> &'d Document<'a> {
        self.document
    }

    pub fn new(document: &'d Document<'a>, file_bytes: usize, limits: &ReadLimits) -> Self {
        Decoder { document, budget: limits.decode_budget(file_bytes), raw_end: 0 }
    }

    /// How many bytes follow the end of the document, without white space around them. To be asked when its arrays are read.
    pub fn trailing_bytes(&self) -> u64 {
        let after = match &self.document.appended {
            // An array that nobody read is no text.
            Some(Appended::Raw(data)) => after_end(&data[self.raw_end..]),
            Some(Appended::Base64(data)) => after_end(data),
            None => self.document.after,
        };
        after.trim_ascii().len() as u64
    }

    fn bad(&self, array: &DataArray<'_>, detail: impl std::fmt::Display) -> FormatError {
        FormatError::Parse {
            format: self.document.format,
            place: FilePosition::Offset(array.offset),
            detail: format!("array {:?} of {:?}: {detail}", array.name, array.section),
        }
    }

    /// The values as real numbers, `count` of them.
    pub fn reals(&mut self, array: &DataArray<'a>, count: u64) -> Result<Vec<f64>, FormatError> {
        let scalar = self.scalar(array)?;
        let values = match array.content {
            Content::Ascii(text) => self.words(array, text, count, |word| word.parse().ok())?,
            _ => {
                let bytes = self.exactly(array, count, scalar)?;
                scalar.reals(&bytes, self.document.order)?
            }
        };
        self.check_count(array, values.len(), count)?;
        Ok(values)
    }

    /// The values as integers, `count` of them.
    pub fn integers<T>(
        &mut self,
        array: &DataArray<'a>,
        count: u64,
        convert: impl Fn(i64) -> T,
    ) -> Result<Vec<T>, FormatError> {
        let values = self.all_integers(array, Some(count), convert)?;
        self.check_count(array, values.len(), count)?;
        Ok(values)
    }

    /// The values as integers, however many there are.
    pub fn all_integers<T>(
        &mut self,
        array: &DataArray<'a>,
        count: Option<u64>,
        convert: impl Fn(i64) -> T,
    ) -> Result<Vec<T>, FormatError> {
        let scalar = self.scalar(array)?;
        if !scalar.is_integer() {
            return Err(self.bad(array, "integers are expected"));
        }
        match (&array.content, count) {
            (Content::Ascii(text), _) => {
                let own = |word: &str| word.parse().ok().filter(|value| scalar.holds(*value));
                let convert = |word: &str| own(word).map(&convert);
                self.words(array, text, count.unwrap_or(u64::MAX), convert)
            }
            (_, Some(count)) => {
                let bytes = self.exactly(array, count, scalar)?;
                scalar.integers(&bytes, self.document.order, convert)
            }
            (_, None) => {
                let bytes = self.bytes(array)?;
                scalar.integers(&bytes, self.document.order, convert)
            }
        }
    }

    /// The first text of a string array.
    pub fn text(&mut self, array: &DataArray<'a>) -> Result<String, FormatError> {
        let bytes = match array.content {
            Content::Ascii(text) => {
                Cow::Owned(self.words(array, text, u64::MAX, |word| word.parse().ok())?)
            }
            _ => self.bytes(array)?,
        };
        let length = bytes.iter().position(|&byte| byte == 0);
        let first = &bytes[..length.unwrap_or(bytes.len())];
        Ok(String::from_utf8_lossy(first).into_owned())
    }

    /// Counts an unused array: the limit is one of the whole file.
    pub fn pass_over(&mut self, array: &DataArray<'a>) -> Result<(), FormatError> {
        if self.document.compressed && !matches!(array.content, Content::Ascii(_)) {
            let mut source = self.source(array)?;
            self.blocks(array, &mut source)?;
        }
        Ok(())
    }

    fn scalar(&self, array: &DataArray<'_>) -> Result<Scalar, FormatError> {
        array.scalar.ok_or_else(|| self.bad(array, "it does not hold numbers"))
    }

    fn check_count(
        &self,
        array: &DataArray<'_>,
        have: usize,
        declared: u64,
    ) -> Result<(), FormatError> {
        if have as u64 == declared {
            return Ok(());
        }
        Err(self.bad(array, format!("{declared} values declared, {have} found")))
    }

    fn words<T>(
        &self,
        array: &DataArray<'_>,
        text: &str,
        at_most: u64,
        parse: impl Fn(&str) -> Option<T>,
    ) -> Result<Vec<T>, FormatError> {
        let possible = (text.len() as u64).div_ceil(2).min(at_most);
        let mut values = room_for(possible as usize)?;
        for word in text.split_ascii_whitespace() {
            if values.len() as u64 == at_most {
                return Err(self.bad(array, format!("more than {at_most} values")));
            }
            let value = parse(word).ok_or_else(|| {
                let shown: String = word.chars().take(40).collect();
                let is_number = word.parse::<f64>().is_ok();
                let what = if is_number { "not a value of its type" } else { "not a number" };
                self.bad(array, format!("{what}: {shown:?}"))
            })?;
            values.push(value);
        }
        Ok(values)
    }

    /// The bytes of `count` values.
    fn exactly(
        &mut self,
        array: &DataArray<'a>,
        count: u64,
        scalar: Scalar,
    ) -> Result<Cow<'a, [u8]>, FormatError> {
        let bytes = self.bytes(array)?;
        let have = bytes.len() as u64;
        if Some(have) != count.checked_mul(scalar.size()) {
            let have = have / scalar.size();
            return Err(self.bad(array, format!("{count} values declared, {have} found")));
        }
        Ok(bytes)
    }

    fn bytes(&mut self, array: &DataArray<'a>) -> Result<Cow<'a, [u8]>, FormatError> {
        let mut source = self.source(array)?;
        if source.is_empty() {
            return Ok(Cow::Borrowed(&[]));
        }
        let bytes = if self.document.compressed {
            self.inflate(array, &mut source).map(Cow::Owned)
        } else {
            let [length] = self.header_numbers(array, &mut source)?;
            self.take(array, &mut source, length)
        };
        if let (Source::Raw(rest), Some(Appended::Raw(data))) = (&source, &self.document.appended) {
            self.raw_end = self.raw_end.max(data.len() - rest.len());
        }
        bytes
    }

    fn source(&self, array: &DataArray<'a>) -> Result<Source<'a>, FormatError> {
        let offset = match array.content {
            Content::Inline(text) => return Ok(Source::base64(text.trim_ascii().as_bytes())),
            Content::Ascii(_) => return Err(self.bad(array, "it holds text")),
            Content::Appended(offset) => offset,
        };
        let after = |data: &'a [u8]| usize::try_from(offset).ok().and_then(|at| data.get(at..));
        let found = match &self.document.appended {
            Some(Appended::Raw(data)) => after(data).map(Source::Raw),
            Some(Appended::Base64(data)) => after(data).map(Source::base64),
            None => None,
        };
        found.ok_or_else(|| self.bad(array, format!("offset {offset} lies beyond the data")))
    }

    fn take(
        &self,
        array: &DataArray<'_>,
        source: &mut Source<'a>,
        length: u64,
    ) -> Result<Cow<'a, [u8]>, FormatError> {
        let have = source.at_most();
        if length > have {
            return Err(self.bad(array, format!("{length} bytes declared, at most {have} left")));
        }
        source
            .take(length as usize)?
            .ok_or_else(|| self.bad(array, "the data ends early or is not base64"))
    }

    fn header_numbers<const N: usize>(
        &self,
        array: &DataArray<'_>,
        source: &mut Source<'a>,
    ) -> Result<[u64; N], FormatError> {
        let Document { header, order, .. } = self.document;
        let bytes = self.take(array, source, header.size() * N as u64)?;
        let mut numbers = [0; N];
        for (number, raw) in numbers.iter_mut().zip(bytes.chunks_exact(header.size() as usize)) {
            *number = header.integer(raw, *order) as u64;
        }
        Ok(numbers)
    }

    /// Reads the header of a compressed array and takes its decoded size from the budget.
    fn blocks(
        &mut self,
        array: &DataArray<'_>,
        source: &mut Source<'a>,
    ) -> Result<Blocks, FormatError> {
        if source.is_empty() {
            return Ok(Blocks::default());
        }
        // A header of no blocks may stop after its first number.
        let count = match self.header_numbers(array, source)? {
            [0] => return Ok(Blocks::default()),
            [count] => count,
        };
        let [full, last] = self.header_numbers(array, source)?;
        if count.saturating_mul(self.document.header.size()) > source.at_most() {
            return Err(self.bad(array, format!("{count} blocks declared in too few bytes")));
        }
        let mut compressed = room_for(count as usize)?;
        for _ in 0..count {
            let [bytes] = self.header_numbers(array, source)?;
            compressed.push(bytes);
        }
        let last = if last == 0 { full } else { last };
        let decoded = full
            .checked_mul(count - 1)
            .and_then(|before| before.checked_add(last))
            .unwrap_or(u64::MAX);
        self.budget.charge(decoded)?;
        let stored = compressed.iter().fold(0_u64, |sum, &bytes| sum.saturating_add(bytes));
        if stored > source.at_most() || decoded / MOST_BYTES_OF_ONE > stored {
            let detail = format!("{decoded} bytes declared in blocks of {stored} bytes");
            return Err(self.bad(array, detail));
        }
        Ok(Blocks { compressed, full, last, decoded })
    }

    fn inflate(
        &mut self,
        array: &DataArray<'_>,
        source: &mut Source<'a>,
    ) -> Result<Vec<u8>, FormatError> {
        let blocks = self.blocks(array, source)?;
        let mut decoded = room_for(blocks.decoded as usize)?;
        decoded.resize(blocks.decoded as usize, 0);
        let mut places = blocks.places(&mut decoded);
        let mut first = 0;
        for batch in blocks.compressed.chunks(BLOCKS_AT_ONCE) {
            let stored: Vec<_> =
                batch.iter().map(|&bytes| self.take(array, source, bytes)).collect();
            let places: Vec<&mut [u8]> = places.by_ref().take(batch.len()).collect();
            let blocks = stored.into_par_iter().zip(places).enumerate();
            let inflated: Vec<Result<(), FormatError>> = blocks
                .map(|(block, (stored, place))| {
                    let wrong = |why| self.bad(array, format!("block {}{why}", first + block));
                    inflate_to(&stored?, place).map_err(wrong)
                })
                .collect();
            // Of several that are wrong the first is reported, whichever was found first.
            inflated.into_iter().collect::<Result<(), _>>()?;
            first += batch.len();
        }
        drop(places);
        Ok(decoded)
    }
}

/// What follows the end tag of a file whose appended data ends within these bytes; nothing where they have no such tag.
fn after_end(mut bytes: &[u8]) -> &[u8] {
    for mark in ["</AppendedData", "</VTKFile", ">"] {
        let Some(at) = find(bytes, mark.as_bytes()) else { return &[] };
        bytes = &bytes[at + mark.len()..];
    }
    bytes
}

/// Inflates a block to the place that it has to fill; what is wrong with it otherwise.
fn inflate_to(stored: &[u8], place: &mut [u8]) -> Result<(), String> {
    let mut inflater = ZlibDecoder::new(stored);
    let mut have = 0;
    // One byte more than promised is enough to see that the promise was wrong.
    let mut beyond = [0];
    loop {
        let free = if have < place.len() { &mut place[have..] } else { &mut beyond[..] };
        match inflater.read(free) {
            Ok(0) if have == place.len() => return Ok(()),
            Ok(read) if read > 0 && have < place.len() => have += read,
            Ok(read) => {
                let have = have + read;
                return Err(format!(" holds {have} bytes instead of {}", place.len()));
            }
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(format!(": {error}")),
        }
    }
}

#[derive(Default)]
struct Blocks {
    compressed: Vec<u64>,
    full: u64,
    last: u64,
    decoded: u64,
}

impl Blocks {
    /// Where each block goes.
    fn places<'b>(&self, decoded: &'b mut [u8]) -> impl Iterator<Item = &'b mut [u8]> + use<'b> {
        let (count, full, last) = (self.compressed.len(), self.full as usize, self.last as usize);
        let mut rest = decoded;
        (1..=count).map(move |block| {
            let size = if block == count { last } else { full };
            let (place, after) = std::mem::take(&mut rest).split_at_mut(size);
            rest = after;
            place
        })
    }
}
