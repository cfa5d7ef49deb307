//! Reasons why an image has no tissue that could be meshed.

use super::left_out::LeftOut;
use super::limit::LimitError;
use crate::image::ImageError;
use crate::mesh::SearchError;

/// Why an image has no tissue that could be meshed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ImageDomainError {
    #[error(
        "the threshold of skin, {skin}, must be less than that of bone, {bone}, and both finite"
    )]
    Thresholds { skin: f64, bone: f64 },
    #[error("{name} is {value} mm; {least} to 100 mm are possible")]
    Length { name: &'static str, value: f64, least: f64 },
    #[error("no voxel lies between {skin} and {bone}: the image has values from {low} to {high}")]
    NoTissue { skin: f64, bone: f64, low: f64, high: f64 },
    #[error("no label is soft tissue connected with the body")]
    NoSoftLabel,
    #[error("the label map has {voxels} voxels, and at most {most} are possible: resample it")]
    TooManyVoxels { voxels: usize, most: usize },
    #[error("all {voxels} voxels of soft tissue are enclosed by bone or air")]
    Enclosed { voxels: usize },
    #[error(
        "the image holds {pieces} pieces of tissue and bone with {all:.1} ml together, and the largest is {kept:.1} ml: this is no scan of one body"
    )]
    Scattered { pieces: usize, all: f64, kept: f64 },
    #[error(transparent)]
    Image(#[from] ImageError),
    #[error(transparent)]
    Limit(#[from] LimitError),
    #[error("the surface scan of the skin cannot be searched: {0}")]
    Skin(#[from] SearchError),
}

impl ImageDomainError {
    /// Refuses a body that is a small part of what the image holds.
    pub(super) fn refuse_scattered(left_out: &LeftOut) -> Result<(), ImageDomainError> {
        let LeftOut { pieces, all, kept, .. } = *left_out;
        match left_out.is_most() {
            true => Err(ImageDomainError::Scattered { pieces: pieces + 1, all: all + kept, kept }),
            false => Ok(()),
        }
    }
}
