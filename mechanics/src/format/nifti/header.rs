//! The header of a NIfTI file: what the numbers are, and where the voxels stand.

use std::io::Read;

use super::orientation::{Forms, Orientation};
use super::refusal::bad;
use crate::format::error::FormatError;
use crate::format::limits::ReadLimits;
use crate::format::scalar::{ByteOrder, Scalar};
use crate::format::voxels::{Rescale, Storage};
use crate::image::Placement;
use crate::mesh::Warning;

/// Bytes of the longer header.
const LONGEST: usize = 540;
/// Bytes that tell whether a file is NIfTI.
pub(super) const PREFIX: usize = 348;

/// Numbers of types, as the definition has them.
const TYPES: [(i64, Scalar); 10] = [
    (2, Scalar::U8),
    (4, Scalar::I16),
    (8, Scalar::I32),
    (16, Scalar::F32),
    (64, Scalar::F64),
    (256, Scalar::I8),
    (512, Scalar::U16),
    (768, Scalar::U32),
    (1024, Scalar::I64),
    (1280, Scalar::U64),
];

/// Types that are no single numbers of at most 64 bits.
const FOREIGN_TYPES: [(i64, &str); 7] = [
    (1, "single bits"),
    (32, "complex numbers"),
    (128, "colours"),
    (1536, "numbers of 128 bits"),
    (1792, "complex numbers"),
    (2048, "complex numbers"),
    (2304, "colours"),
];

/// Where the fields of a version stand. All of them have the same order.
struct Layout {
    bytes: usize,
    magic: usize,
    dimensions: usize,
    whole: Scalar,
    kind: usize,
    pixdim: usize,
    real: Scalar,
    voxels_at: (usize, Scalar),
    slope: usize,
    units: usize,
    form_codes: (usize, Scalar),
    quaternion: usize,
    rows: usize,
}

const FIRST: Layout = Layout {
    bytes: 348,
    magic: 344,
    dimensions: 40,
    whole: Scalar::I16,
    kind: 70,
    pixdim: 76,
    real: Scalar::F32,
    voxels_at: (108, Scalar::F32),
    slope: 112,
    units: 123,
    form_codes: (252, Scalar::I16),
    quaternion: 256,
    rows: 280,
};

const SECOND: Layout = Layout {
    bytes: 540,
    magic: 4,
    dimensions: 16,
    whole: Scalar::I64,
    kind: 12,
    pixdim: 104,
    real: Scalar::F64,
    voxels_at: (168, Scalar::I64),
    slope: 176,
    units: 500,
    form_codes: (344, Scalar::I32),
    quaternion: 352,
    rows: 400,
};

#[derive(Clone, Debug)]
pub(super) struct Header {
    pub size: [usize; 3],
    pub placement: Placement,
    pub storage: Storage,
    /// How long it is.
    pub bytes: u64,
    pub voxels_at: u64,
    pub warnings: Vec<Warning>,
}

pub(super) fn is_nifti(start: &[u8]) -> bool {
    let Some((layout, _)) = layout_of(start) else { return false };
    let magic = start.get(layout.magic..layout.magic + 4);
    magic.is_some_and(|magic| is_single(magic) || is_pair(magic))
}

fn is_single(magic: &[u8]) -> bool {
    magic == b"n+1\0" || magic == b"n+2\0"
}

fn is_pair(magic: &[u8]) -> bool {
    magic == b"ni1\0" || magic == b"ni2\0"
}

/// The length of the header, which comes first, tells the version and the byte order.
fn layout_of(start: &[u8]) -> Option<(&'static Layout, ByteOrder)> {
    let first = start.get(..4)?;
    [ByteOrder::Little, ByteOrder::Big].into_iter().find_map(|order| {
        match Scalar::I32.integer(first, order) {
            348 => Some((&FIRST, order)),
            540 => Some((&SECOND, order)),
            _ => None,
        }
    })
}

struct Fields {
    bytes: [u8; LONGEST],
    layout: &'static Layout,
    order: ByteOrder,
}

impl Header {
    /// Reads the header and nothing behind it.
    pub fn read(source: &mut impl Read, limits: &ReadLimits) -> Result<Header, FormatError> {
        let fields = Fields::read(source)?;
        fields.check_magic()?;
        let size = fields.size(limits)?;
        let Orientation { placement, warning } = fields.forms(size).place()?;
        let layout = fields.layout;
        let voxels_at = fields.voxels_at()?;
        let storage = Storage {
            scalar: fields.scalar()?,
            order: fields.order,
            rescale: fields.rescale(),
            count: size.iter().map(|&size| size as u64).product(),
        };
        let warnings = warning.into_iter().collect();
        Ok(Header { size, placement, storage, bytes: layout.bytes as u64, voxels_at, warnings })
    }
}

impl Fields {
    fn read(source: &mut impl Read) -> Result<Fields, FormatError> {
        let mut bytes = [0; LONGEST];
        let short = |at: usize| move |error: std::io::Error| bad(at as u64, error.to_string());
        source.read_exact(&mut bytes[..4]).map_err(short(0))?;
        let (layout, order) = layout_of(&bytes)
            .ok_or_else(|| bad(0, "a header has a length of 348 or 540 bytes, this one has not"))?;
        source.read_exact(&mut bytes[4..layout.bytes]).map_err(short(4))?;
        Ok(Fields { bytes, layout, order })
    }

    fn integer(&self, at: usize, scalar: Scalar) -> i64 {
        scalar.integer(&self.bytes[at..at + scalar.size() as usize], self.order)
    }

    /// The real number with this place in a row of them.
    fn real(&self, first: usize, number: usize) -> f64 {
        let scalar = self.layout.real;
        let at = first + number * scalar.size() as usize;
        scalar.real(&self.bytes[at..at + scalar.size() as usize], self.order)
    }

    fn check_magic(&self) -> Result<(), FormatError> {
        let at = self.layout.magic;
        let magic = &self.bytes[at..at + 4];
        if is_pair(magic) {
            let detail = "the voxels are in another file, which is never opened: send one .nii";
            return Err(bad(at as u64, detail));
        }
        if is_single(magic) {
            Ok(())
        } else {
            Err(bad(at as u64, "the mark n+1 or n+2 is missing"))
        }
    }

    fn size(&self, limits: &ReadLimits) -> Result<[usize; 3], FormatError> {
        let Layout { dimensions: at, whole, .. } = *self.layout;
        let dimension = |axis: usize| self.integer(at + axis * whole.size() as usize, whole);
        let count = dimension(0);
        if !(1..=7).contains(&count) {
            return Err(bad(at as u64, format!("{count} dimensions; 3 are read here")));
        }
        let sizes: Vec<i64> = (1..=count as usize).map(dimension).collect();
        if sizes.len() < 3 || sizes[3..].iter().any(|&size| size != 1) {
            let shown: Vec<String> = sizes.iter().map(i64::to_string).collect();
            let detail = format!(
                "a scalar image has 3 dimensions, this file has {count} of sizes {}: times and vectors are \
                 not read",
                shown.join(" x ")
            );
            return Err(bad(at as u64, detail));
        }
        let size = [sizes[0], sizes[1], sizes[2]].map(|size| u64::try_from(size).unwrap_or(0));
        limits.check_voxels(size.iter().fold(1, |product, &n| product.saturating_mul(n)))?;
        if size.iter().any(|&size| size < 2) {
            let detail = format!(
                "{} x {} x {} voxels: two or more along each axis have an inside",
                sizes[0], sizes[1], sizes[2]
            );
            return Err(bad(at as u64, detail));
        }
        Ok(size.map(|size| size as usize))
    }

    fn scalar(&self) -> Result<Scalar, FormatError> {
        let at = self.layout.kind;
        let kind = self.integer(at, Scalar::I16);
        let Some((_, scalar)) = TYPES.iter().find(|(known, _)| *known == kind) else {
            let foreign = FOREIGN_TYPES.iter().find(|(known, _)| *known == kind);
            let what = foreign.map_or("no known type", |(_, what)| what);
            return Err(bad(
                at as u64,
                format!("type {kind} is {what}; single numbers are read here"),
            ));
        };
        let bits = self.integer(at + 2, Scalar::I16);
        if bits != 8 * scalar.size() as i64 {
            let wanted = 8 * scalar.size();
            let detail = format!("type {kind} has {wanted} bits, the header says {bits}");
            return Err(bad(at as u64 + 2, detail));
        }
        Ok(*scalar)
    }

    fn voxels_at(&self) -> Result<u64, FormatError> {
        let (at, scalar) = self.layout.voxels_at;
        let bytes = &self.bytes[at..at + scalar.size() as usize];
        let offset = scalar.real(bytes, self.order);
        let least = (self.layout.bytes + 4) as f64;
        // Zero is what old writers leave for the least.
        match offset {
            0.0 => Ok(least as u64),
            offset if offset >= least && offset < 1e15 && offset.fract() == 0.0 => {
                Ok(offset as u64)
            }
            offset => Err(bad(at as u64, format!("the voxels cannot begin at byte {offset}"))),
        }
    }

    /// A slope of zero, or none that is a number, rescales nothing.
    fn rescale(&self) -> Rescale {
        let [slope, intercept] = [0, 1].map(|number| self.real(self.layout.slope, number));
        if slope == 0.0 || !slope.is_finite() {
            return Rescale::NONE;
        }
        Rescale { slope, intercept: if intercept.is_finite() { intercept } else { 0.0 } }
    }

    fn forms(&self, size: [usize; 3]) -> Forms {
        let layout = self.layout;
        let (codes, scalar) = layout.form_codes;
        let row = |row: usize| [0, 1, 2, 3].map(|n| self.real(layout.rows, 4 * row + n));
        let units = match layout.bytes {
            348 => i64::from(self.bytes[layout.units]),
            _ => self.integer(layout.units, Scalar::I32),
        };
        Forms {
            codes_at: codes as u64,
            by_quaternion: self.integer(codes, scalar) > 0,
            by_rows: self.integer(codes + scalar.size() as usize, scalar) > 0,
            pixdim: [0, 1, 2, 3].map(|number| self.real(layout.pixdim, number)),
            quaternion: [0, 1, 2].map(|number| self.real(layout.quaternion, number)),
            offset: [3, 4, 5].map(|number| self.real(layout.quaternion, number)),
            rows: [row(0), row(1), row(2)],
            // The lowest three bits are the unit of length.
            unit: units & 7,
            size,
        }
    }
}
