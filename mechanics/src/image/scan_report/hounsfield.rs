//! Check that the values of a scan are Hounsfield units.

use crate::image::thresholds::{LOWEST, Thresholds};
use crate::image::volume::ImageVolume;
use crate::mesh::Warning;

pub(super) const CODE: &str = "no-hounsfield";

/// What scanners write before slope and intercept are applied.
const STORED: f64 = 4095.0;
/// Where the mode of air of a calibrated scanner lies.
const AIR: std::ops::RangeInclusive<f64> = -1050.0..=-900.0;

pub(super) fn findings(image: &ImageVolume, thresholds: Option<&Thresholds>) -> Vec<Warning> {
    let (low, high) = image.range();
    let says =
        |detail: String| vec![Warning::new(CODE, detail).with("lowest", low).with("highest", high)];
    match thresholds {
        _ if low >= 0.0 && high <= STORED => says(format!(
            "values reach from {low} to {high}: the intercept of the scanner, mostly -1024, was not applied"
        )),
        None => says(format!(
            "values from {low} to {high} show no air at -1000 or no soft tissue at 40: this is no CT in Hounsfield units"
        )),
        Some(thresholds) if !AIR.contains(&thresholds.air_mode) => says(format!(
            "air lies at {} HU instead of -1000: the scanner is not calibrated or slope and intercept are wrong",
            thresholds.air_mode
        )),
        Some(_) => Vec::new(),
    }
}

/// Values that a scanner may write, in HU: padding around the field of view lies below, broken voxels above.
pub(super) const PLAUSIBLE: [f64; 2] = [LOWEST - 25.0, 32_767.0];

/// Values that no scanner writes for a body: how many voxels lie below and above what is plausible, of an image with this range.
pub(super) fn beyond((low, high): (f64, f64), [below, above]: [usize; 2]) -> Option<Warning> {
    let [least, most] = PLAUSIBLE;
    let mut words = Vec::new();
    if below > 0 {
        words.push(format!(
            "{below} voxels lie below {least} HU, down to {low:e}: padding, taken as air"
        ));
    }
    if above > 0 {
        words.push(format!(
            "{above} voxels lie above {most} HU, up to {high:e}, and are taken as dense"
        ));
    }
    let warning = Warning::new("values-implausible", words.join("; "));
    let warning = warning.with("below", below as f64).with("above", above as f64);
    (below + above > 0).then(|| warning.with("lowest", low).with("highest", high))
}
