//! Padding of a slice: pixels around the scanner's circle, which hold a declared number and no measurement. They count as air.

use super::attributes::{self as tag, Attributes};
use crate::format::error::FormatError;

/// Air, in Hounsfield units.
const AIR: f64 = -1000.0;

/// The numbers of padding as they are stored, before slope and intercept (PS3.3, C.7.5.1.1.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Padding {
    lowest: i64,
    highest: i64,
}

impl Padding {
    /// `None` where a file declares none.
    pub fn read(
        attributes: &Attributes<'_>,
        is_signed: bool,
    ) -> Result<Option<Padding>, FormatError> {
        let Some(value) = attributes.integer(tag::PADDING, is_signed)? else { return Ok(None) };
        let limit = attributes.integer(tag::PADDING_LIMIT, is_signed)?.unwrap_or(value);
        Ok(Some(Padding { lowest: value.min(limit), highest: value.max(limit) }))
    }

    fn holds(self, number: i64) -> bool {
        (self.lowest..=self.highest).contains(&number)
    }

    /// Which pixels are padding: those with its numbers that reach the border of the slice through such pixels. A number that
    /// tissue has too is padding there alone.
    pub fn of(self, numbers: &[i64], [columns, rows]: [usize; 2]) -> Vec<bool> {
        let mut padding = vec![false; numbers.len()];
        let border = |pixel: usize| {
            let [column, row] = [pixel % columns, pixel / columns];
            column == 0 || row == 0 || column + 1 == columns || row + 1 == rows
        };
        let mut open: Vec<usize> =
            (0..numbers.len()).filter(|&at| border(at) && self.holds(numbers[at])).collect();
        open.iter().for_each(|&pixel| padding[pixel] = true);
        while let Some(pixel) = open.pop() {
            let column = pixel % columns;
            let beside = [
                (column > 0).then(|| pixel - 1),
                (column + 1 < columns).then(|| pixel + 1),
                pixel.checked_sub(columns),
                Some(pixel + columns).filter(|&below| below < numbers.len()),
            ];
            for next in beside.into_iter().flatten() {
                if !padding[next] && self.holds(numbers[next]) {
                    padding[next] = true;
                    open.push(next);
                }
            }
        }
        padding
    }
}

/// The value of air in a slice with these measured values: of a CT that of air or the smallest, where one lies below; of others the smallest.
pub(super) fn air(measured: impl Iterator<Item = f64>, is_ct: bool) -> f64 {
    let highest = if is_ct { AIR } else { f64::INFINITY };
    let lowest = measured.fold(highest, f64::min);
    if lowest.is_finite() { lowest.floor() } else { 0.0 }
}
