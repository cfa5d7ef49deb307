//! The header of an NRRD file: what the values are, and where the voxels stand.
//!
//! Source: Definition of NRRD File Format, teem.sourceforge.net/nrrd/format.html. Of its fields those are read
//! that decide a scalar image in space; others, and the `key:=value` lines that often name the patient, are
//! passed over. An image is refused that has no `space directions` and `space origin`: nothing tells where it is.

use std::collections::BTreeMap;

use crate::format::cursor::Cursor;
use crate::format::error::{FilePosition, FormatError};
use crate::format::limits::ReadLimits;
use crate::format::scalar::{ByteOrder, Scalar};
use crate::format::voxels::{Rescale, Storage};

use super::segments::Segments;
use crate::image::{ImageError, Placement};
use crate::mesh::{Frame, Vector};

pub(super) const FORMAT: &str = "NRRD";

/// Fields that decide what is read; all others are passed over.
const FIELDS: [&str; 16] = [
    "type",
    "dimension",
    "sizes",
    "encoding",
    "endian",
    "space",
    "space dimension",
    "space directions",
    "space origin",
    "space units",
    "data file",
    "datafile",
    "line skip",
    "lineskip",
    "byte skip",
    "byteskip",
];

/// Names of types, as the definition has them.
const TYPES: [(Scalar, &[&str]); 10] = [
    (Scalar::I8, &["signed char", "int8", "int8_t"]),
    (Scalar::U8, &["uchar", "unsigned char", "uint8", "uint8_t"]),
    (Scalar::I16, &["short", "short int", "signed short", "signed short int", "int16", "int16_t"]),
    (Scalar::U16, &["ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"]),
    (Scalar::I32, &["int", "signed int", "int32", "int32_t"]),
    (Scalar::U32, &["uint", "unsigned int", "uint32", "uint32_t"]),
    (
        Scalar::I64,
        &[
            "longlong",
            "long long",
            "long long int",
            "signed long long",
            "signed long long int",
            "int64",
            "int64_t",
        ],
    ),
    (
        Scalar::U64,
        &["ulonglong", "unsigned long long", "unsigned long long int", "uint64", "uint64_t"],
    ),
    (Scalar::F32, &["float"]),
    (Scalar::F64, &["double"]),
];

/// How the values are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Raw,
    Gzip,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    pub scalar: Scalar,
    pub order: ByteOrder,
    pub encoding: Encoding,
    pub size: [usize; 3],
    pub placement: Placement,
    pub frame: Option<Frame>,
    /// What the segments of a label map are called.
    pub label_names: BTreeMap<u16, String>,
}

/// What a field says, and on which line.
struct Field {
    value: String,
    line: u64,
}

struct Fields {
    known: BTreeMap<&'static str, Field>,
    segments: Segments,
    /// The line that ends the header.
    end: u64,
}

impl Header {
    /// Reads up to the empty line; the cursor then stands at the first byte of the values.
    pub fn read(cursor: &mut Cursor<'_>, limits: &ReadLimits) -> Result<Header, FormatError> {
        let fields = Fields::read(cursor, limits)?;
        for name in ["data file", "datafile"] {
            if let Some(field) = fields.known.get(name) {
                let detail = "the voxels are in another file, which is never opened: \
                     send header and voxels as one .nrrd";
                return Err(field.bad(detail));
            }
        }
        for name in ["line skip", "lineskip", "byte skip", "byteskip"] {
            if let Some(field) = fields.known.get(name).filter(|field| field.value != "0") {
                return Err(
                    field.bad(format!("a {name} of 0 is read here, {:.20} is asked", field.value))
                );
            }
        }
        let scalar = fields.scalar()?;
        let size = fields.size(limits)?;
        let (frame, mirrored) = fields.frame()?;
        Ok(Header {
            scalar,
            order: fields.order(scalar)?,
            encoding: fields.encoding()?,
            size,
            placement: fields.placement(mirrored)?,
            frame,
            label_names: fields.segments.names(),
        })
    }

    /// How its numbers are stored.
    pub fn storage(&self) -> Storage {
        let count = self.size.iter().map(|&size| size as u64).product();
        Storage { scalar: self.scalar, order: self.order, rescale: Rescale::NONE, count }
    }
}

impl Field {
    fn bad(&self, detail: impl Into<String>) -> FormatError {
        bad_line(self.line, detail)
    }
}

fn bad_line(line: u64, detail: impl Into<String>) -> FormatError {
    FormatError::Parse { format: FORMAT, place: FilePosition::Line(line), detail: detail.into() }
}

impl Fields {
    fn read(cursor: &mut Cursor<'_>, limits: &ReadLimits) -> Result<Fields, FormatError> {
        let mut known: BTreeMap<&'static str, Field> = BTreeMap::new();
        let mut segments = Segments::default();
        let mut line = 1;
        cursor.line();
        loop {
            line += 1;
            let Some(bytes) = cursor.line() else {
                return Err(bad_line(line, "the file ends inside the header"));
            };
            if bytes.is_empty() {
                return Ok(Fields { known, segments, end: line });
            }
            if bytes.starts_with(b"#") {
                continue;
            }
            let Some(colon) = bytes.iter().position(|&byte| byte == b':') else {
                return Err(bad_line(line, "neither a field, a key with its value, nor a comment"));
            };
            if bytes[colon + 1..].starts_with(b"=") {
                segments.take(&bytes[..colon], &bytes[colon + 2..], limits);
                continue;
            }
            let name = bytes[..colon].trim_ascii().to_ascii_lowercase();
            let Some(name) = FIELDS.into_iter().find(|known| known.as_bytes() == name) else {
                continue;
            };
            let value = String::from_utf8_lossy(&bytes[colon + 1..]).trim().to_owned();
            if known.insert(name, Field { value, line }).is_some() {
                return Err(bad_line(line, format!("the field `{name}` is given twice")));
            }
        }
    }

    fn get(&self, name: &str) -> Result<&Field, FormatError> {
        let missing = || bad_line(self.end, format!("the header ends without `{name}`"));
        self.known.get(name).ok_or_else(missing)
    }

    fn scalar(&self) -> Result<Scalar, FormatError> {
        let field = self.get("type")?;
        let named = TYPES.iter().find(|(_, names)| names.contains(&field.value.as_str()));
        let unknown =
            || field.bad(format!("type {:?} holds no single numbers", shortened(&field.value)));
        named.map(|(scalar, _)| *scalar).ok_or_else(unknown)
    }

    fn size(&self, limits: &ReadLimits) -> Result<[usize; 3], FormatError> {
        let dimension = self.get("dimension")?;
        if dimension.value != "3" {
            let detail = format!(
                "a scalar image has dimension 3, this file {}: colours, vectors and times are not read",
                shortened(&dimension.value)
            );
            return Err(dimension.bad(detail));
        }
        let field = self.get("sizes")?;
        let words: Vec<&str> = field.value.split_ascii_whitespace().take(4).collect();
        let mut size = [0_u64; 3];
        if words.len() != size.len() {
            return Err(field.bad("three sizes are expected"));
        }
        for (size, word) in size.iter_mut().zip(words) {
            let refused =
                || field.bad(format!("expected a number of voxels, found {:?}", shortened(word)));
            *size = word.parse().map_err(|_| refused())?;
        }
        limits.check_voxels(size.iter().fold(1, |product, &n| product.saturating_mul(n)))?;
        if size.iter().any(|&size| size < 2) {
            return Err(field.bad("two or more voxels along each axis have an inside"));
        }
        Ok(size.map(|size| size as usize))
    }

    fn encoding(&self) -> Result<Encoding, FormatError> {
        let field = self.get("encoding")?;
        match field.value.to_ascii_lowercase().as_str() {
            "raw" => Ok(Encoding::Raw),
            "gzip" | "gz" => Ok(Encoding::Gzip),
            other => {
                let other = shortened(other);
                Err(field.bad(format!("encodings raw and gzip are read here, {other:?} is asked")))
            }
        }
    }

    fn order(&self, scalar: Scalar) -> Result<ByteOrder, FormatError> {
        if scalar.size() == 1 {
            return Ok(ByteOrder::Little);
        }
        let field = self.get("endian")?;
        match field.value.to_ascii_lowercase().as_str() {
            "little" => Ok(ByteOrder::Little),
            "big" => Ok(ByteOrder::Big),
            other => Err(field.bad(format!("endian is little or big, not {:?}", shortened(other)))),
        }
    }

    /// The frame, and whether x has to change its sign to be in it.
    fn frame(&self) -> Result<(Option<Frame>, bool), FormatError> {
        let Some(field) = self.known.get("space") else {
            let field = self.get("space dimension")?;
            return match field.value.as_str() {
                "3" => Ok((None, false)),
                other => {
                    Err(field.bad(format!("space has 3 dimensions, not {:?}", shortened(other))))
                }
            };
        };
        match field.value.to_ascii_lowercase().as_str() {
            "right-anterior-superior" | "ras" => Ok((Some(Frame::Ras), false)),
            "left-posterior-superior" | "lps" => Ok((Some(Frame::Lps), false)),
            "left-anterior-superior" | "las" => Ok((Some(Frame::Ras), true)),
            "scanner-xyz" | "3d-right-handed" => Ok((None, false)),
            other => {
                let detail = format!(
                    "space {:?} is not read; RAS, LPS, LAS, scanner-xyz and 3D-right-handed are",
                    shortened(other)
                );
                Err(field.bad(detail))
            }
        }
    }

    fn placement(&self, mirrored: bool) -> Result<Placement, FormatError> {
        let directions = self.get("space directions")?;
        let origin = self.get("space origin")?;
        let unit = self.unit_in_mm()?;
        let place = |vector: Vector| {
            let x = if mirrored { -vector.x } else { vector.x };
            Vector::new(x, vector.y, vector.z) * unit
        };
        let [first] = vectors(origin)?;
        let steps = vectors(directions)?;
        let placement = Placement { origin: place(first), steps: steps.map(place) };
        placement.check().map_err(|error| match error {
            ImageError::Origin => origin.bad(error.to_string()),
            other => directions.bad(other.to_string()),
        })?;
        Ok(placement)
    }

    /// How many mm one unit of space is; mm where nothing is said.
    fn unit_in_mm(&self) -> Result<f64, FormatError> {
        let Some(field) = self.known.get("space units") else { return Ok(1.0) };
        let mut units = field.value.split('"').skip(1).step_by(2);
        let unit = units.next().unwrap_or_default();
        if units.any(|other| other != unit) {
            return Err(field.bad("one unit for all axes is expected"));
        }
        match unit {
            "mm" | "" => Ok(1.0),
            "cm" => Ok(10.0),
            "m" => Ok(1000.0),
            "um" | "µm" | "micron" | "microns" => Ok(0.001),
            other => {
                let detail =
                    format!("space unit {:?} is not known; mm, cm, m and um are", shortened(other));
                Err(field.bad(detail))
            }
        }
    }
}

/// `(a,b,c)` as often as asked for, and nothing else.
fn vectors<const N: usize>(field: &Field) -> Result<[Vector; N], FormatError> {
    let refused = || {
        let value = shortened(&field.value);
        field.bad(format!("expected {N} times three finite numbers in brackets, found {value:?}"))
    };
    let mut found = [Vector::zeros(); N];
    let mut rest = field.value.trim();
    for vector in &mut found {
        let (inside, after) =
            rest.strip_prefix('(').and_then(|rest| rest.split_once(')')).ok_or_else(refused)?;
        let mut numbers = inside.split(',');
        for axis in 0..3 {
            let number = numbers.next().and_then(|number| number.trim().parse::<f64>().ok());
            vector[axis] = number.filter(|number| number.is_finite()).ok_or_else(refused)?;
        }
        if numbers.next().is_some() {
            return Err(refused());
        }
        rest = after.trim();
    }
    if rest.is_empty() { Ok(found) } else { Err(refused()) }
}

fn shortened(text: &str) -> String {
    text.chars().take(40).collect()
}
