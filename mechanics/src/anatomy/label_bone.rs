//! Bone of a label map in its segments, with its teeth.

use super::{AnatomyError, AnatomyRules, PartedBone, WALL_VOXELS, parted, surfaces_of};
use crate::domain::{ImageDomain, LabelBody};
use crate::image::{ImageError, ImageVolume, Voxels};
use crate::osteotomy::bone_image::BoneImage;
use crate::osteotomy::labelling::label_given;
use crate::osteotomy::teeth::{MUCOSA_MM, Teeth};

/// Parts the bone of a label map: by the segments that its labels are of, or by the cuts of the rules. `domain` is that of the
/// body.
pub fn part_labels(
    body: &LabelBody,
    domain: &ImageDomain,
    rules: &AnatomyRules,
) -> Result<PartedBone, AnatomyError> {
    let image = beside(body, domain.bone_values())?;
    let bone = BoneImage { image: &image, threshold: 0.0 };
    let osteotomy = &rules.osteotomy;
    let mut parted = match osteotomy.cuts().is_empty() {
        true => {
            let segments = body.segments();
            let labelled = label_given(&bone, osteotomy, |voxel| segments[voxel])?;
            let surfaces = surfaces_of(&bone, osteotomy, &labelled);
            let (given, wall_voxels) = (Vec::new(), WALL_VOXELS);
            PartedBone { labelled, surfaces, given, teeth: None, wall_voxels }
        }
        false => parted(&bone, osteotomy)?,
    };
    let is_tooth = |voxel| f32::from(u8::from(body.is_tooth(voxel)));
    let teeth: Vec<f32> = (0..image.voxels().len()).map(is_tooth).collect();
    if rules.teeth_slide && teeth.contains(&1.0) {
        let teeth = beside(body, teeth)?;
        let teeth = BoneImage { image: &teeth, threshold: 0.0 };
        parted.teeth = Some(Teeth::new(&teeth, &parted.labelled.labels, 0.0, MUCOSA_MM));
    }
    Ok(parted)
}

/// Values on the grid of a label map.
fn beside(body: &LabelBody, values: Vec<f32>) -> Result<ImageVolume, AnatomyError> {
    let image = body.image();
    let made: Result<ImageVolume, ImageError> =
        ImageVolume::new(image.size(), *image.placement(), Voxels::F32(values));
    Ok(made.map_err(crate::domain::ImageDomainError::from)?)
}
