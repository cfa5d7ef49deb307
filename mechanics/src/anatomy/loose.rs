//! Loose bone: pieces too small to hold tissue, such as a hyoid, a tube or a splinter, become tissue before it is meshed. As
//! bone they would be holes that nothing holds, in a lip where a tube leaves the mouth.

use crate::domain::ImageOptions;
use crate::image::{ImageError, ImageVolume, Voxels};
use crate::mesh::Warning;
use crate::osteotomy::Owner;
use crate::osteotomy::labelling::Labelled;

/// The scan with values of soft tissue, half way between the thresholds, where bone is loose.
pub fn without_loose(
    scan: &ImageVolume,
    bone: &Labelled,
    options: &ImageOptions,
) -> Result<ImageVolume, ImageError> {
    let soft = f64::midpoint(options.skin_threshold, options.bone_threshold);
    let is_loose = |voxel: &usize| bone.labels.owner(*voxel) == Some(Owner::Loose);
    let loose = (0..scan.voxels().len()).filter(is_loose);
    let voxels = match scan.voxels() {
        Voxels::I16(values) => Voxels::I16(replaced(values, loose, soft.round() as i16)),
        Voxels::F32(values) => Voxels::F32(replaced(values, loose, soft as f32)),
    };
    ImageVolume::new(scan.size(), *scan.placement(), voxels)
}

pub(super) fn replaced<T: Copy>(
    values: &[T],
    places: impl Iterator<Item = usize>,
    value: T,
) -> Vec<T> {
    let mut values = values.to_vec();
    places.for_each(|place| values[place] = value);
    values
}

/// That no voxel of a scan with these values is bone above its threshold; nothing where one is.
pub fn no_bone(bone: &Labelled, (low, high): (f64, f64), threshold: f64) -> Option<Warning> {
    let detail = format!(
        "no voxel of the scan lies above the threshold of bone, {threshold} HU: its values reach from {low} to {high}. The mesh has no bone, \
         tissue is held where the scan ends at most, and no plan can move anything; state `thresholds_hu.bone`"
    );
    let warning = || Warning::new("no-bone", detail).with("highest", high);
    bone.labels.bone_box().is_none().then(warning)
}

/// How much bone is loose; nothing where none is.
pub fn loose_bone(bone: &Labelled) -> Option<Warning> {
    let loose = &bone.loose;
    let voxel = bone.labels.placement().steps;
    let volume_ml = loose.voxels as f64 * voxel[0].dot(&voxel[1].cross(&voxel[2])).abs() / 1000.0;
    let [x, y, z] = loose.largest_centre.into();
    let detail = format!(
        "{} pieces of bone of no segment with {volume_ml:.1} ml together are too small to hold tissue and are meshed as \
         tissue, the largest around ({x:.0}, {y:.0}, {z:.0}) mm: a hyoid, tubes, splinters",
        loose.pieces
    );
    (loose.pieces > 0).then(|| Warning::new("bone-loose", detail).with("volume_ml", volume_ml))
}
