//! The pair of thresholds at which two scans of the same bone have the same volume.
//!
//! Zachow et al. 2006: scans before and after an operation are made comparable by a bone that both show and that nobody
//! moved, such as the hyoid.

use super::mask::Mask;
use super::volume::{ImageVolume, Voxels};

/// Volumes that differ by more than this part are not equal.
const MOST_APART: f64 = 0.05;

/// A threshold and the volume above it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThresholdVolume {
    pub threshold: f64,
    /// In mm³.
    pub volume: f64,
}

/// A bone and what is around it in one scan.
#[derive(Clone, Copy, Debug)]
pub struct BoneRegion<'a> {
    pub image: &'a ImageVolume,
    pub region: &'a Mask,
}

/// The threshold of the second image, within its region, above which there is as much as above the first threshold within
/// the region of the first: to half a voxel but for voxels of one value, which go together. Both with their volumes; `None` where the
/// second region is too small for it, or so many of its voxels have one value that the volumes differ by more than a twentieth.
pub fn equal_volume(
    first: BoneRegion<'_>,
    threshold: f64,
    second: BoneRegion<'_>,
) -> Option<[ThresholdVolume; 2]> {
    let above = values(first).into_iter().filter(|value| *value >= threshold).count();
    let volume = above as f64 * first.image.voxel_volume();
    let mut values = values(second);
    values.sort_by(|a, b| b.total_cmp(a));
    let wanted = (volume / second.image.voxel_volume()).round() as usize;
    // Half-way between the last voxel that is in and the first that is not.
    let last = *values.get(wanted.checked_sub(1)?)?;
    let next = values.get(wanted).copied()?;
    let found = 0.5 * (last + next);
    let count = values.iter().filter(|value| **value >= found).count();
    if count.abs_diff(wanted) as f64 > 1.0 + MOST_APART * wanted as f64 {
        return None;
    }
    let other =
        ThresholdVolume { threshold: found, volume: count as f64 * second.image.voxel_volume() };
    Some([ThresholdVolume { threshold, volume }, other])
}

/// The values of an image within a region.
fn values(bone: BoneRegion<'_>) -> Vec<f64> {
    let inside = bone.region.inside.iter();
    match bone.image.voxels() {
        Voxels::I16(values) => {
            let pairs = values.iter().zip(inside).filter(|(_, inside)| **inside);
            pairs.map(|(&value, _)| f64::from(value)).collect()
        }
        Voxels::F32(values) => {
            let pairs = values.iter().zip(inside).filter(|(_, inside)| **inside);
            pairs.map(|(&value, _)| f64::from(value)).collect()
        }
    }
}
