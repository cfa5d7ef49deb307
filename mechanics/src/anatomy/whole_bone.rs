//! Closing of bone before it is divided into segments: gaps thinner than the voxels resolve are closed, and cavities
//! inside bone become bone.

use super::loose::replaced;
use crate::image::holes::filled;
use crate::image::morphology::closed;
use crate::image::{ImageError, ImageVolume, Mask, Voxels};
use crate::mesh::Warning;

/// What becomes bone is so much denser than its threshold, in Hounsfield units: as thin bone is.
const DENSER: f64 = 200.0;

/// How bone is made whole.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WholeBone {
    /// Gaps that no ball of this radius in mm fits into are closed; none where it is 0.
    pub closing_mm: f64,
    /// Whether hollows that bone encloses are bone.
    pub fill_holes: bool,
}

/// The scan with bone, from the threshold on, made whole, and what became bone; nothing where nothing is asked for.
pub fn close_bone(
    scan: &ImageVolume,
    threshold: f64,
    rules: &WholeBone,
) -> Result<Option<(ImageVolume, Warning)>, ImageError> {
    if *rules == WholeBone::default() {
        return Ok(None);
    }
    let bone = Mask::above(scan, threshold);
    let whole = if rules.closing_mm > 0.0 { closed(&bone, rules.closing_mm) } else { bone.clone() };
    let whole = if rules.fill_holes { filled(&whole) } else { whole };
    let new = whole.without(&bone);
    let places = (0..new.inside.len()).filter(|&voxel| new.inside[voxel]);
    let value = threshold + DENSER;
    let voxels = match scan.voxels() {
        Voxels::I16(values) => Voxels::I16(replaced(values, places, value.round() as i16)),
        Voxels::F32(values) => Voxels::F32(replaced(values, places, value as f32)),
    };
    let volume_ml = new.volume() / 1000.0;
    let detail = format!(
        "{volume_ml:.1} ml that the scan shows below {threshold} HU are bone now, {:.0} ml were: closed by {} mm{}",
        bone.volume() / 1000.0,
        rules.closing_mm,
        if rules.fill_holes { ", and filled" } else { "" }
    );
    let told = Warning::new("bone-made-whole", detail).with("volume_ml", volume_ml);
    Ok(Some((ImageVolume::new(scan.size(), *scan.placement(), voxels)?, told)))
}
