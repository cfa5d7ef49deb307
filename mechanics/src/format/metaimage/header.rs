//! The header of a MetaImage file: lines of `Key = value`, the last of which is `ElementDataFile`.

use std::collections::BTreeMap;

use crate::format::cursor::Cursor;
use crate::format::error::{FilePosition, FormatError};
use crate::format::limits::ReadLimits;
use crate::format::scalar::{ByteOrder, Scalar};
use crate::format::voxels::{Rescale, Storage};
use crate::image::Placement;
use crate::mesh::{Vector, Warning};

pub(super) const FORMAT: &str = "MetaImage";

/// Keys that decide what is read, each with its other names; all others are passed over, among them comments and names.
const KEYS: [&[&str]; 16] = [
    &["ObjectType"],
    &["NDims"],
    &["DimSize"],
    &["BinaryData"],
    &["BinaryDataByteOrderMSB", "ElementByteOrderMSB"],
    &["CompressedData"],
    &["CompressedDataSize"],
    &["TransformMatrix", "Rotation", "Orientation"],
    &["Offset", "Position", "Origin"],
    &["AnatomicalOrientation"],
    &["ElementSpacing", "ElementSize"],
    &["HeaderSize"],
    &["ElementNumberOfChannels"],
    &["ElementType"],
    &["ElementToIntensityFunctionSlope"],
    &["ElementToIntensityFunctionOffset"],
];
const DATA_FILE: &str = "ElementDataFile";
/// Longest header, in lines.
const MOST_LINES: u64 = 1000;

const TYPES: [(&str, Scalar); 12] = [
    ("MET_CHAR", Scalar::I8),
    ("MET_UCHAR", Scalar::U8),
    ("MET_SHORT", Scalar::I16),
    ("MET_USHORT", Scalar::U16),
    ("MET_INT", Scalar::I32),
    ("MET_UINT", Scalar::U32),
    ("MET_LONG", Scalar::I32),
    ("MET_ULONG", Scalar::U32),
    ("MET_LONG_LONG", Scalar::I64),
    ("MET_ULONG_LONG", Scalar::U64),
    ("MET_FLOAT", Scalar::F32),
    ("MET_DOUBLE", Scalar::F64),
];

/// Where the voxels are.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum DataFile {
    Here,
    Elsewhere { name: String },
}

#[derive(Clone, Debug)]
pub(super) struct Header {
    pub size: [usize; 3],
    pub placement: Placement,
    pub storage: Storage,
    pub is_compressed: bool,
    pub compressed_bytes: Option<u64>,
    pub data_file: DataFile,
    pub warning: Option<Warning>,
}

struct Field {
    value: String,
    line: u64,
}

struct Fields {
    known: BTreeMap<&'static str, Field>,
    data_file: Field,
}

/// Text whose first key is one of those that headers begin with.
pub(in crate::format) fn is_metaimage(bytes: &[u8]) -> bool {
    let first = bytes.split(|&byte| byte == b'\n').next().unwrap_or_default();
    let Some(equals) = first.iter().take(64).position(|&byte| byte == b'=') else { return false };
    let key = first[..equals].trim_ascii();
    [&b"ObjectType"[..], b"NDims", b"Comment"].contains(&key)
}

fn bad_line(line: u64, detail: impl Into<String>) -> FormatError {
    FormatError::Parse { format: FORMAT, place: FilePosition::Line(line), detail: detail.into() }
}

/// The first word: in a damaged file, what follows may be the comment of another line.
fn shortened(text: &str) -> String {
    let word = text.split_ascii_whitespace().next().unwrap_or_default();
    word.chars().take(20).collect()
}

impl Header {
    /// Reads up to the line that says where the voxels are; the cursor then stands behind it.
    pub fn read(cursor: &mut Cursor<'_>, limits: &ReadLimits) -> Result<Header, FormatError> {
        let fields = Fields::read(cursor)?;
        fields.check_kind()?;
        let size = fields.size(limits)?;
        let placement = fields.placement()?;
        let scalar = fields.scalar()?;
        let storage = Storage {
            scalar,
            order: fields.order(scalar)?,
            rescale: fields.rescale()?,
            count: size.iter().map(|&size| size as u64).product(),
        };
        let compressed_bytes = match fields.known.get("CompressedDataSize") {
            Some(field) => Some(field.numbers::<u64, 1>()?[0]),
            None => None,
        };
        Ok(Header {
            size,
            placement,
            storage,
            is_compressed: fields.is_true("CompressedData")?,
            compressed_bytes,
            data_file: fields.place_of_voxels()?,
            warning: fields.orientation_warning(&placement),
        })
    }
}

impl Field {
    fn bad(&self, detail: impl Into<String>) -> FormatError {
        bad_line(self.line, detail)
    }

    /// As many numbers as asked for, and nothing else.
    fn numbers<T: std::str::FromStr + Copy, const N: usize>(&self) -> Result<[T; N], FormatError> {
        let refused =
            || self.bad(format!("expected {N} numbers, found {:?}", shortened(&self.value)));
        let words = self.value.split_ascii_whitespace().take(N + 1);
        let numbers: Option<Vec<T>> = words.map(|word| word.parse().ok()).collect();
        numbers.and_then(|numbers| numbers.try_into().ok()).ok_or_else(refused)
    }

    fn reals<const N: usize>(&self) -> Result<[f64; N], FormatError> {
        let numbers = self.numbers::<f64, N>()?;
        match numbers.iter().all(|number| number.is_finite()) {
            true => Ok(numbers),
            false => Err(self.bad(format!("{:?} is not finite", shortened(&self.value)))),
        }
    }
}

impl Fields {
    fn read(cursor: &mut Cursor<'_>) -> Result<Fields, FormatError> {
        let mut known: BTreeMap<&'static str, Field> = BTreeMap::new();
        for line in 1..=MOST_LINES {
            let Some(bytes) = cursor.line() else {
                return Err(bad_line(line, format!("the file ends without {DATA_FILE}")));
            };
            if bytes.trim_ascii().is_empty() {
                continue;
            }
            let Some(equals) = bytes.iter().position(|&byte| byte == b'=') else {
                return Err(bad_line(line, "expected a key, an equals sign and a value"));
            };
            let key = bytes[..equals].trim_ascii();
            let value = String::from_utf8_lossy(&bytes[equals + 1..]).trim().to_owned();
            let field = Field { value, line };
            if key == DATA_FILE.as_bytes() {
                return Ok(Fields { known, data_file: field });
            }
            let names = KEYS.iter().find(|names| names.iter().any(|name| name.as_bytes() == key));
            let Some(name) = names.map(|names| names[0]) else { continue };
            if known.insert(name, field).is_some() {
                return Err(bad_line(line, format!("`{name}` is given twice")));
            }
        }
        Err(bad_line(MOST_LINES, format!("no {DATA_FILE} in {MOST_LINES} lines")))
    }

    fn get(&self, name: &str) -> Result<&Field, FormatError> {
        let missing = || self.data_file.bad(format!("the header ends without `{name}`"));
        self.known.get(name).ok_or_else(missing)
    }

    fn is_true(&self, name: &str) -> Result<bool, FormatError> {
        let Some(field) = self.known.get(name) else { return Ok(false) };
        match field.value.to_ascii_lowercase().as_str() {
            "true" | "1" => Ok(true),
            "false" | "0" => Ok(false),
            other => Err(field.bad(format!("{name} is True or False, not {:?}", shortened(other)))),
        }
    }

    fn check_kind(&self) -> Result<(), FormatError> {
        if let Some(kind) = self.known.get("ObjectType").filter(|kind| kind.value != "Image") {
            return Err(
                kind.bad(format!("an Image is read here, not {:?}", shortened(&kind.value)))
            );
        }
        if let Some(field) = self.known.get("BinaryData")
            && !self.is_true("BinaryData")?
        {
            return Err(field.bad("voxels as text are not read: write BinaryData = True"));
        }
        if let Some(field) = self.known.get("HeaderSize").filter(|field| field.value != "0") {
            let shown = shortened(&field.value);
            return Err(field.bad(format!("a HeaderSize of 0 is read here, {shown} is asked")));
        }
        match self.known.get("ElementNumberOfChannels").filter(|field| field.value != "1") {
            Some(field) => {
                let shown = shortened(&field.value);
                Err(field.bad(format!(
                    "one channel is read here, not {shown}: colours and vectors are not"
                )))
            }
            None => Ok(()),
        }
    }

    fn size(&self, limits: &ReadLimits) -> Result<[usize; 3], FormatError> {
        let dimensions = self.get("NDims")?;
        if dimensions.value != "3" {
            let shown = shortened(&dimensions.value);
            return Err(dimensions.bad(format!("a scalar image has NDims = 3, this file {shown}")));
        }
        let field = self.get("DimSize")?;
        let size: [u64; 3] = field.numbers()?;
        limits.check_voxels(size.iter().fold(1, |product, &n| product.saturating_mul(n)))?;
        if size.iter().any(|&size| size < 2) {
            return Err(field.bad("two or more voxels along each axis have an inside"));
        }
        Ok(size.map(|size| size as usize))
    }

    fn scalar(&self) -> Result<Scalar, FormatError> {
        let field = self.get("ElementType")?;
        let known = TYPES.iter().find(|(name, _)| *name == field.value).map(|(_, scalar)| *scalar);
        let unknown =
            || field.bad(format!("type {:?} holds no single numbers", shortened(&field.value)));
        known.ok_or_else(unknown)
    }

    fn order(&self, scalar: Scalar) -> Result<ByteOrder, FormatError> {
        if scalar.size() > 1 {
            self.get("BinaryDataByteOrderMSB")?;
        }
        Ok(if self.is_true("BinaryDataByteOrderMSB")? { ByteOrder::Big } else { ByteOrder::Little })
    }

    fn rescale(&self) -> Result<Rescale, FormatError> {
        let number = |name: &str, without: f64| match self.known.get(name) {
            Some(field) => field.reals::<1>().map(|[number]| number),
            None => Ok(without),
        };
        let slope = number("ElementToIntensityFunctionSlope", 1.0)?;
        Ok(Rescale { slope, intercept: number("ElementToIntensityFunctionOffset", 0.0)? })
    }

    /// The rows of the matrix are the directions of the axes, in LPS (ITK, itkMetaImageIO).
    fn placement(&self) -> Result<Placement, FormatError> {
        let (matrix, origin) = (self.get("TransformMatrix")?, self.get("Offset")?);
        let spacing = self.get("ElementSpacing")?;
        let directions: [f64; 9] = matrix.reals()?;
        let lengths: [f64; 3] = spacing.reals()?;
        if let Some(length) = lengths.iter().find(|length| **length <= 0.0) {
            return Err(spacing.bad(format!("voxels cannot be {length} mm apart")));
        }
        let step =
            |axis: usize| Vector::from_column_slice(&directions[3 * axis..][..3]) * lengths[axis];
        let origin_mm = Vector::from(origin.reals::<3>()?);
        let placement = Placement { origin: origin_mm, steps: [step(0), step(1), step(2)] };
        placement.check().map_err(|error| matrix.bad(error.to_string()))?;
        Ok(placement)
    }

    fn place_of_voxels(&self) -> Result<DataFile, FormatError> {
        let name = &self.data_file.value;
        if name.eq_ignore_ascii_case("LOCAL") {
            return Ok(DataFile::Here);
        }
        if name.starts_with("LIST") || name.contains('%') || name.is_empty() {
            return Err(self
                .data_file
                .bad("the voxels are in several files, which is not read here"));
        }
        Ok(DataFile::Elsewhere { name: name.clone() })
    }

    /// The letters say where axes come from. They follow from the matrix, which is what other programs read.
    fn orientation_warning(&self, placement: &Placement) -> Option<Warning> {
        let field = self.known.get("AnatomicalOrientation")?;
        let stated = field.value.to_ascii_uppercase();
        let is_code = stated.len() == 3 && stated.bytes().all(|letter| b"RLAPIS".contains(&letter));
        let found = placement.steps.map(letter).iter().collect::<String>();
        let detail = format!(
            "AnatomicalOrientation says {} and TransformMatrix {found}; the matrix is taken",
            shortened(&stated)
        );
        (is_code && stated != found).then(|| Warning::new("image-place-doubtful", detail))
    }
}

/// Where an axis in LPS comes from, by its largest component.
fn letter(step: Vector) -> char {
    let axis = step.iamax();
    match (axis, step[axis] > 0.0) {
        (0, true) => 'R',
        (0, false) => 'L',
        (1, true) => 'A',
        (1, false) => 'P',
        (_, true) => 'I',
        (_, false) => 'S',
    }
}
