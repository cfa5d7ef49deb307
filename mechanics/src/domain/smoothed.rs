//! An image smoothed and divided into compartments.

use super::channels::values;
use super::compartments::{Compartment, Division, compartments};
use super::image_error::ImageDomainError;
use super::image_options::ImageOptions;
use crate::image::ImageVolume;
use crate::image::reduction::reduced;
use crate::image::smoothing::gaussian;

/// More voxels are taken together: a head is 16 million of 1 mm³, and a boundary lies within a fraction of a voxel.
const MOST_VOXELS: usize = 1 << 24;

/// Values farther below the threshold of skin, and above that of bone, than so many times what lies between the two are limited:
/// padding around the field of view and broken voxels would reach far into tissue by smoothing and by the ringing of splines. In
/// Hounsfield units with the usual thresholds that is below -1125 and above 5750.
const BELOW: f64 = 1.5;
const ABOVE: f64 = 10.0;

/// An image smoothed, and what each of its voxels belongs to.
pub(super) struct Smoothed {
    pub image: ImageVolume,
    pub values: Vec<f32>,
    pub division: Division,
    pub all: Vec<Compartment>,
}

pub(super) fn divided(
    image: &ImageVolume,
    options: &ImageOptions,
) -> Result<Smoothed, ImageDomainError> {
    check(options)?;
    let (skin, bone) = (options.skin_threshold, options.bone_threshold);
    let range = [skin - BELOW * (bone - skin), bone + ABOVE * (bone - skin)];
    let (image, _) = image.limited(range);
    let image = reduced(&image, MOST_VOXELS)?;
    let (size, spacing) = (image.size(), image.spacing());
    let mut values = values(&image);
    gaussian(&mut values, size, spacing.map(|spacing| options.smoothing / spacing));
    let division = Division {
        size,
        spacing,
        skin,
        bone,
        airway_opening: options.airway_opening,
        bone_gap: options.bone_gap,
    };
    let all = compartments(&values, &division);
    Ok(Smoothed { image, values, division, all })
}

fn check(options: &ImageOptions) -> Result<(), ImageDomainError> {
    let (skin, bone) = (options.skin_threshold, options.bone_threshold);
    if !(skin.is_finite() && bone.is_finite() && skin < bone) {
        return Err(ImageDomainError::Thresholds { skin, bone });
    }
    for (name, value) in [
        ("smoothing", options.smoothing),
        ("airway_opening", options.airway_opening),
        ("bone_gap", options.bone_gap),
    ] {
        if !(0.0..=100.0).contains(&value) {
            return Err(ImageDomainError::Length { name, value, least: 0.0 });
        }
    }
    Ok(())
}

/// Why no voxel is tissue.
pub(super) fn nothing(
    image: &ImageVolume,
    values: &[f32],
    options: &ImageOptions,
) -> ImageDomainError {
    let (skin, bone) = (options.skin_threshold, options.bone_threshold);
    let between = |value: &&f32| (skin..bone).contains(&f64::from(**value));
    match values.iter().filter(between).count() {
        0 => {
            let (low, high) = image.range();
            ImageDomainError::NoTissue { skin, bone, low, high }
        }
        voxels => ImageDomainError::Enclosed { voxels },
    }
}
