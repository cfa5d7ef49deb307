//! Stored numbers to voxels: piece by piece, rescaled, in 16 bits for as long as they fit.

use std::io::Read;

use super::cursor::Cursor;
use super::error::FormatError;
use super::limits::{DecodeBudget, MOST_BYTES_OF_ONE, ReadLimits, room_for};
use super::scalar::{ByteOrder, Scalar};
use crate::image::Voxels;
use crate::mesh::Warning;

/// Bytes that are taken up at a time, a multiple of the size of every number.
const PIECE: usize = 1 << 16;

/// Scaling of stored numbers: slope times number plus intercept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rescale {
    pub slope: f64,
    pub intercept: f64,
}

impl Rescale {
    pub const NONE: Rescale = Rescale { slope: 1.0, intercept: 0.0 };

    pub fn of(self, number: f64) -> f64 {
        self.slope * number + self.intercept
    }
}

/// How the numbers of an image are stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Storage {
    pub scalar: Scalar,
    pub order: ByteOrder,
    pub rescale: Rescale,
    /// How many there are.
    pub count: u64,
}

impl Storage {
    pub fn bytes(&self) -> u64 {
        self.count.saturating_mul(self.scalar.size())
    }
}

/// Voxels that grow. Integers are kept in 16 bits until one does not fit or is no integer any more; then all are kept
/// in single precision.
pub(super) struct VoxelBuilder {
    kept: Voxels,
    room: usize,
}

impl VoxelBuilder {
    pub fn integers(room: usize) -> Result<VoxelBuilder, FormatError> {
        Ok(VoxelBuilder { kept: Voxels::I16(room_for(room)?), room })
    }

    pub fn reals(room: usize) -> Result<VoxelBuilder, FormatError> {
        Ok(VoxelBuilder { kept: Voxels::F32(room_for(room)?), room })
    }

    pub fn push_integer(&mut self, number: i64, rescale: Rescale) -> Result<(), FormatError> {
        if rescale == Rescale::NONE {
            return match (&mut self.kept, i16::try_from(number)) {
                (Voxels::I16(kept), Ok(number)) => {
                    kept.push(number);
                    Ok(())
                }
                _ => self.push_single(number as f32),
            };
        }
        let value = rescale.of(number as f64);
        match &mut self.kept {
            Voxels::I16(kept) if f64::from(value as i16) == value => {
                kept.push(value as i16);
                Ok(())
            }
            _ => self.push_single(value as f32),
        }
    }

    pub fn push_single(&mut self, value: f32) -> Result<(), FormatError> {
        if let Voxels::I16(narrow) = &self.kept {
            let mut wide = room_for(self.room)?;
            wide.extend(narrow.iter().map(|&value| f32::from(value)));
            self.kept = Voxels::F32(wide);
        }
        if let Voxels::F32(kept) = &mut self.kept {
            kept.push(value);
        }
        Ok(())
    }

    fn push_bytes(&mut self, bytes: &[u8], storage: &Storage) -> Result<(), FormatError> {
        let Storage { scalar, order, rescale, .. } = *storage;
        if scalar == Scalar::U64 {
            for number in scalar.reals(bytes, order)? {
                match number < i64::MAX as f64 {
                    true => self.push_integer(number as i64, rescale)?,
                    false => self.push_single(rescale.of(number) as f32)?,
                }
            }
            return Ok(());
        }
        if scalar.is_integer() {
            let mut pushed = Ok(());
            scalar.each_integer(bytes, order, |number| {
                if pushed.is_ok() {
                    pushed = self.push_integer(number, rescale);
                }
            });
            return pushed;
        }
        for number in scalar.reals(bytes, order)? {
            let value = if rescale == Rescale::NONE { number } else { rescale.of(number) };
            self.push_single(value as f32)?;
        }
        Ok(())
    }

    pub fn finish(self) -> Voxels {
        self.kept
    }
}

/// What a source gave.
pub(super) struct Decoded {
    pub voxels: Voxels,
    /// How many bytes follow the last number.
    pub followed_by: u64,
}

/// Reads as many numbers as the header promises. The end of a compressed source is read as well, because its check sum
/// stands there; what follows the numbers is charged to `budget`, which has paid for the numbers.
pub(super) fn decode(
    mut source: impl Read,
    storage: &Storage,
    place: &Cursor<'_>,
    mut budget: DecodeBudget,
) -> Result<Decoded, FormatError> {
    let room = storage.count as usize;
    let mut builder = match storage.scalar.is_integer() {
        true => VoxelBuilder::integers(room)?,
        false => VoxelBuilder::reals(room)?,
    };
    let wanted = storage.bytes();
    let mut piece = Vec::with_capacity(PIECE);
    let mut have = 0;
    while have < wanted {
        piece.clear();
        let next = (wanted - have).min(PIECE as u64);
        let read = source.by_ref().take(next).read_to_end(&mut piece);
        read.map_err(|error| place.bad_bytes(error.to_string()))?;
        have += piece.len() as u64;
        if (piece.len() as u64) < next {
            let detail = format!("{wanted} bytes declared, {have} are there");
            return Err(place.bad_bytes(detail));
        }
        builder.push_bytes(&piece, storage)?;
    }
    let refused_at = budget.remaining().saturating_add(1);
    let rest = std::io::copy(&mut source.take(refused_at), &mut std::io::sink());
    let followed_by = rest.map_err(|error| place.bad_bytes(error.to_string()))?;
    budget.charge(followed_by)?;
    Ok(Decoded { voxels: builder.finish(), followed_by })
}

/// Refuses compressed bytes that cannot hold what they promise, before memory is taken; else what is left to decode.
pub(super) fn check_promise(
    wanted: u64,
    place: &Cursor<'_>,
    file_bytes: usize,
    limits: &ReadLimits,
) -> Result<DecodeBudget, FormatError> {
    let mut budget = limits.image_budget(file_bytes);
    budget.charge(wanted)?;
    let have = place.remaining();
    if wanted / MOST_BYTES_OF_ONE > have {
        let detail = format!("{wanted} bytes declared in {have} compressed ones");
        return Err(place.bad_bytes(detail));
    }
    Ok(budget)
}

/// The warning about bytes behind the last voxel.
pub(super) fn trailing(bytes: u64) -> Option<Warning> {
    let detail = format!("{bytes} bytes follow the last voxel");
    (bytes > 0).then(|| Warning::new("trailing-bytes", detail).with("bytes", bytes as f64))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::FilePosition;

    #[test]
    fn a_promise_beyond_what_deflate_can_keep_is_refused_before_memory_is_taken() {
        let cursor = Cursor::new("NRRD", b"few bytes");
        let refused = check_promise(16 << 20, &cursor, 100, &ReadLimits::default());
        let error = refused.err().unwrap();
        let place = FilePosition::Offset(0);
        let detail = "16777216 bytes declared in 9 compressed ones".to_owned();
        assert_eq!(error, FormatError::Parse { format: "NRRD", place, detail });
    }

    #[test]
    fn integers_stay_in_16_bits_until_one_does_not_fit() {
        let built = |numbers: &[i64], slope, intercept| {
            let mut builder = VoxelBuilder::integers(numbers.len()).unwrap();
            let rescale = Rescale { slope, intercept };
            numbers.iter().for_each(|&number| builder.push_integer(number, rescale).unwrap());
            builder.finish()
        };
        assert_eq!(built(&[0, 24, 4095], 1.0, -1024.0), Voxels::I16(vec![-1024, -1000, 3071]));
        assert_eq!(built(&[1, 40_000], 1.0, 0.0), Voxels::F32(vec![1.0, 40_000.0]));
        assert_eq!(built(&[2, 3], 0.5, 0.0), Voxels::F32(vec![1.0, 1.5]));
        assert_eq!(built(&[i64::MAX, 0], 1.0, -1.0), Voxels::F32(vec![i64::MAX as f32, -1.0]));
    }
}
