//! Pixel layout of a slice, from its attributes.

use super::bad;
use crate::format::error::FormatError;

/// What the attributes say of a pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct PixelLayout {
    /// Along a row, and along a column.
    pub size: [usize; 2],
    pub bits_allocated: u16,
    pub bits_stored: u16,
    pub high_bit: u16,
    pub is_signed: bool,
    /// Where they begin in the file.
    pub at: u64,
}

impl PixelLayout {
    pub fn check(&self) -> Result<(), FormatError> {
        let PixelLayout { bits_allocated, bits_stored, high_bit, .. } = *self;
        if ![8, 16].contains(&bits_allocated) {
            let detail =
                format!("{bits_allocated} bits are allocated for a pixel; 8 and 16 are read");
            return Err(bad(self.at, detail));
        }
        let fits = (1..=bits_allocated).contains(&bits_stored)
            && (bits_stored - 1..bits_allocated).contains(&high_bit);
        if !fits {
            let detail = format!(
                "{bits_stored} bits stored up to bit {high_bit} do not fit into {bits_allocated} allocated"
            );
            return Err(bad(self.at, detail));
        }
        if self.size.contains(&0) {
            return Err(bad(self.at, format!("{} x {} pixels", self.size[0], self.size[1])));
        }
        Ok(())
    }

    pub fn count(&self) -> usize {
        self.size[0] * self.size[1]
    }

    pub fn bytes_of_pixel(&self) -> usize {
        usize::from(self.bits_allocated / 8)
    }

    /// The number in the bits that count; what lies beside them is something else's.
    pub fn number(&self, stored: u16) -> i64 {
        let low = self.high_bit + 1 - self.bits_stored;
        let bits = i64::from(stored >> low) & ((1 << self.bits_stored) - 1);
        let is_negative = self.is_signed && bits >> (self.bits_stored - 1) == 1;
        if is_negative { bits - (1 << self.bits_stored) } else { bits }
    }
}
