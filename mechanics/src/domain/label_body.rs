//! Soft tissue of a label map: what segmentation programs call it, in place of thresholds.
//!
//! Body and bone are what the labels say, blurred by a cubic B-spline, so that their boundaries have no stairs; nothing is
//! closed, and nothing is taken for an airway but air that is.

use super::Limit;
use super::channels::tissue_box;
use super::compartments::{Compartment, Division, known_compartments};
use super::image::{ImageDomain, ImageGrid, surroundings_of};
use super::image_error::ImageDomainError;
use super::left_out::left_out;
use super::region_map::RegionMap;
use crate::image::distance::nearest_marked;
use crate::image::{CubicSpline, ImageVolume, LabelMap};

/// Of what is body, and of what is bone, half.
const HALF: f64 = 0.5;
/// Openings of the skin narrower than this lead into an airway, in mm.
const OPENING: f64 = 10.0;
/// More voxels are refused.
const MOST_VOXELS: usize = 1 << 25;

/// Tissue class of a label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LabelClass {
    Air,
    /// Of a region, from 0.
    Tissue(u8),
    /// Of a segment by its number, or bone that stays.
    Bone {
        segment: Option<usize>,
        is_tooth: bool,
    },
}

/// A label map of which it is known what each label is.
#[derive(Clone, Debug)]
pub struct LabelBody {
    image: ImageVolume,
    map: LabelMap,
    /// By label.
    classes: Vec<LabelClass>,
    regions: usize,
}

impl LabelBody {
    /// `class` is that of a label that has voxels; tissue is in so many regions. `image` is the one that the map is of.
    pub fn new(
        image: ImageVolume,
        map: LabelMap,
        regions: usize,
        class: impl Fn(u16) -> LabelClass,
    ) -> LabelBody {
        let classes = (0..=u16::MAX).map(class).collect();
        LabelBody { image, map, classes, regions }
    }

    fn class(&self, voxel: usize) -> LabelClass {
        self.classes[usize::from(self.map.labels[voxel])]
    }

    fn is_bone(&self, voxel: usize) -> bool {
        matches!(self.class(voxel), LabelClass::Bone { .. })
    }

    fn is_body(&self, voxel: usize) -> bool {
        self.class(voxel) != LabelClass::Air
    }

    pub fn image(&self) -> &ImageVolume {
        &self.image
    }

    /// Whether a voxel is of a tooth.
    pub fn is_tooth(&self, voxel: usize) -> bool {
        matches!(self.class(voxel), LabelClass::Bone { is_tooth: true, .. })
    }

    /// For each voxel the segment of the nearest voxel of bone; none where that stays.
    pub fn segments(&self) -> Vec<Option<usize>> {
        let size = self.image.size();
        let nearest = nearest_marked(size, self.image.spacing(), |voxel| self.is_bone(voxel));
        let segment = |voxel: usize| match self.class(voxel) {
            LabelClass::Bone { segment, .. } => segment,
            LabelClass::Air | LabelClass::Tissue(_) => None,
        };
        let known = |voxel: u32| (voxel != u32::MAX).then_some(voxel as usize);
        nearest.into_iter().map(|nearest| known(nearest.voxel).and_then(segment)).collect()
    }

    /// The body to mesh, inside all of `limits`.
    pub fn domain(&self, limits: &[Limit]) -> Result<ImageDomain, ImageDomainError> {
        let image = &self.image;
        let (size, spacing) = (image.size(), image.spacing());
        let voxels = size.iter().product();
        if voxels > MOST_VOXELS {
            return Err(ImageDomainError::TooManyVoxels { voxels, most: MOST_VOXELS });
        }
        let division = Division {
            size,
            spacing,
            skin: HALF,
            bone: HALF,
            airway_opening: OPENING,
            bone_gap: 0.0,
        };
        let all = known_compartments(&division, |v| self.is_body(v), |v| self.is_bone(v));
        let tissue = tissue_box(&all, size).ok_or(ImageDomainError::NoSoftLabel)?;
        let left_out = left_out(image, &all, |voxel| self.is_body(voxel));
        ImageDomainError::refuse_scattered(&left_out)?;
        let share = |is: &dyn Fn(Compartment) -> bool| -> Vec<f32> {
            all.iter().map(|&compartment| if is(compartment) { 1.0 } else { 0.0 }).collect()
        };
        let is_bone = |compartment| compartment == Compartment::Bone;
        let body = share(&|compartment| compartment == Compartment::Tissue || is_bone(compartment));
        let channels = [body, share(&is_bone)];
        let surroundings = surroundings_of(&all, &division, &channels);
        let spline = CubicSpline::blurred(size, &channels);
        let divided = ImageGrid { division, tissue, left_out, surroundings };
        let domain = ImageDomain::of_spline(image, spline, divided, limits)?;
        let region = |voxel: usize| match self.class(voxel) {
            LabelClass::Tissue(region) => Some(region),
            LabelClass::Air | LabelClass::Bone { .. } => None,
        };
        Ok(domain.with_regions(RegionMap::new(size, self.regions, region)))
    }
}
