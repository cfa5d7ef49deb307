//! Report on the quality of a scan before it is used, for the technician who made it.

mod field_of_view;
mod head;
mod hounsfield;
mod jaws;
mod metal;
mod mouth;
mod objects;

use super::coarsened::coarsened;
use super::thresholds::{Histogram, Thresholds};
use super::volume::ImageVolume;
use crate::mesh::{Frame, Warning};
use head::Head;

/// Voxels farther apart than this, in mm, do not hold lips apart.
const COARSE: f64 = 2.0;
/// Voxels that are looked at: 8 million take about a second.
const MOST_VOXELS: usize = 1 << 23;

/// What was found; nothing where all is well.
#[derive(Clone, Debug, PartialEq)]
pub struct ScanReport {
    /// `None` where the image is no CT of a head.
    pub thresholds: Option<Thresholds>,
    pub findings: Vec<Warning>,
}

/// Checks a CT of a head. Where the frame is not known, LPS is taken. Of a large image, means of blocks are looked at.
pub fn scan_report(image: &ImageVolume, frame: Frame) -> ScanReport {
    let (coarse, range) = (coarse(image), image.range());
    let (image, beyond) = image.turned(frame, Frame::Lps).limited(hounsfield::PLAUSIBLE);
    let image = coarsened(&image, MOST_VOXELS).unwrap_or(image);
    let thresholds = Thresholds::of(&Histogram::of(&image));
    let mut findings = hounsfield::findings(&image, thresholds.as_ref());
    findings.extend(coarse);
    findings.extend(hounsfield::beyond(range, beyond));
    if let Some(thresholds) = thresholds
        && findings.iter().all(|finding| finding.code != hounsfield::CODE)
    {
        let head = Head::new(&image, thresholds);
        findings.extend(field_of_view::finding(&head));
        findings.extend(objects::finding(&head));
        findings.extend(metal::finding(&head));
        findings.extend(mouth::finding(&head));
        findings.extend(jaws::finding(&head));
    }
    ScanReport { thresholds, findings }
}

fn coarse(image: &ImageVolume) -> Option<Warning> {
    let spacing = image.spacing();
    let largest = spacing.into_iter().fold(0.0, f64::max);
    let [x, y, z] = spacing;
    let detail = format!(
        "voxels are {x:.2} x {y:.2} x {z:.2} mm: above {COARSE} mm lips, lids and thin bone run together; ask for a \
         reconstruction of 1 mm"
    );
    (largest > COARSE).then(|| Warning::new("scan-coarse", detail).with("largest_mm", largest))
}
