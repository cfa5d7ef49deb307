//! A segment of bone moved in its scan before anything is meshed: a jaw that was open in the CT and closed before a camera.
//!
//! Where the segment was is soft tissue; where it goes its values, trilinear, take the place of what is fainter. Soft tissue
//! stays as it was scanned, and ends at the bone where this is now.

use super::closing::Closing;
use super::{AnatomyError, AnatomyRules, PartedBone};
use crate::domain::ImageDomainError;
use crate::image::{ImageVolume, Voxels};
use crate::mesh::{Vector, Warning};
use crate::osteotomy::bone_image::BoneImage;
use crate::osteotomy::labelling::{FoundSegment, Labelled, label_given};
use crate::osteotomy::teeth::{ENAMEL_HU, MUCOSA_MM, Teeth};
use crate::osteotomy::{BoneLabels, Owner};

/// Bone that is pushed into other bone is reported from so much on, in mm³.
const OVERLAP: f64 = 100.0;

/// A scan and its bone with a segment moved.
pub struct Closed {
    pub image: ImageVolume,
    pub bone: PartedBone,
    /// The farthest way of a point of the segment, in mm.
    pub farthest: f64,
    /// Bone that now lies in other bone.
    pub warning: Option<Warning>,
}

/// Moves a segment. `scan` is without loose bone.
pub fn close(
    scan: &ImageVolume,
    bone: PartedBone,
    closing: &Closing,
    rules: &AnatomyRules,
) -> Result<Closed, AnatomyError> {
    let Closing { segment, movement } = *closing;
    let soft = f64::midpoint(rules.image.skin_threshold, rules.image.bone_threshold) as f32;
    let old = &bone.labelled.labels;
    let values = values_of(scan);
    let near = near_segment(old, segment);
    let is_own = |voxel: usize| old.owner(voxel) == Some(Owner::Segment(segment));
    let own: Vec<f32> = values
        .iter()
        .zip(&near)
        .map(|(&value, &near)| if near { value.max(soft) } else { soft })
        .collect();
    let own = beside(scan, own)?;
    let owners = (0..values.len()).map(|voxel| f32::from(u8::from(is_own(voxel)))).collect();
    let owners = beside(scan, owners)?;
    let back = movement.inverse();
    let (mut moved, mut overlap) = (values.clone(), 0);
    let mut is_moved = vec![false; values.len()];
    for voxel in 0..values.len() {
        let place = back.apply(&old.centre_of(voxel));
        let emptied = if near[voxel] { values[voxel].min(soft) } else { values[voxel] };
        let arrived = own.at(&place).unwrap_or(f64::from(soft)) as f32;
        moved[voxel] = if arrived > soft { emptied.max(arrived) } else { emptied };
        let share = owners.at(&place).unwrap_or_default();
        let is_other = old.owner(voxel).is_some() && !is_own(voxel);
        // Its rim, of less than half a voxel, is its own too where no other bone is: it would be bone of nobody, which stays.
        let is_claimed = if is_other { share >= 0.5 } else { share > 0.0 };
        is_moved[voxel] = is_claimed && f64::from(arrived) > rules.image.bone_threshold;
        overlap += usize::from(is_moved[voxel] && is_other);
    }
    let image = beside(scan, moved)?;
    let segment_of = |voxel: usize| match (is_moved[voxel], old.owner(voxel)) {
        (true, _) => Some(segment),
        (false, Some(Owner::Segment(other))) if other != segment => Some(other),
        (false, _) => None,
    };
    let found = BoneImage { image: &image, threshold: rules.image.bone_threshold };
    let labelled = label_given(&found, &rules.osteotomy, segment_of)?;
    let teeth =
        bone.teeth.as_ref().map(|_| Teeth::new(&found, &labelled.labels, ENAMEL_HU, MUCOSA_MM));
    let (given, wall_voxels) = (bone.given, bone.wall_voxels);
    let mut surfaces = bone.surfaces;
    let way = |point: &Vector| (movement.apply(point) - point).norm();
    let farthest = surfaces[segment].points.iter().map(way).fold(0.0, f64::max);
    surfaces[segment].points.iter_mut().for_each(|point| *point = movement.apply(point));
    let overlap = overlap as f64 * scan.voxel_volume();
    let warning = overlapping(&bone.labelled.segments[segment], overlap);
    let labelled = with_scan_report(labelled, bone.labelled);
    let bone = PartedBone { labelled, surfaces, given, teeth, wall_voxels };
    Ok(Closed { image, bone, farthest, warning })
}

/// Keeps the report on the bone of the scan.
fn with_scan_report(moved: Labelled, scanned: Labelled) -> Labelled {
    let segments = moved.segments.into_iter().zip(scanned.segments);
    let segments = segments.map(|(now, was)| FoundSegment { left: was.left, ..now });
    Labelled { labels: moved.labels, segments: segments.collect(), ..scanned }
}

fn overlapping(segment: &FoundSegment, overlap: f64) -> Option<Warning> {
    let ml = overlap / 1000.0;
    let detail = format!(
        "segment `{}` is closed into other bone by {ml:.1} ml, which goes with it: is the movement right?",
        segment.name
    );
    (overlap > OVERLAP).then(|| Warning::new("jaw-overlaps", detail).with("volume_ml", ml))
}

fn values_of(image: &ImageVolume) -> Vec<f32> {
    match image.voxels() {
        Voxels::I16(values) => values.iter().map(|&value| f32::from(value)).collect(),
        Voxels::F32(values) => values.clone(),
    }
}

fn beside(image: &ImageVolume, values: Vec<f32>) -> Result<ImageVolume, ImageDomainError> {
    Ok(ImageVolume::new(image.size(), *image.placement(), Voxels::F32(values))?)
}

/// Voxels of a segment, and those around them that are no other bone: partial volume.
fn near_segment(labels: &BoneLabels, segment: usize) -> Vec<bool> {
    let [nx, ny, nz] = labels.size();
    let own = |voxel: usize| labels.owner(voxel) == Some(Owner::Segment(segment));
    let mut near = vec![false; nx * ny * nz];
    for voxel in (0..near.len()).filter(|&voxel| own(voxel)) {
        let index = [voxel % nx, voxel / nx % ny, voxel / (nx * ny)];
        let span = |axis: usize, size: usize| {
            index[axis].saturating_sub(1)..=(index[axis] + 1).min(size - 1)
        };
        for (z, y) in span(2, nz).flat_map(|z| span(1, ny).map(move |y| (z, y))) {
            for x in span(0, nx) {
                let other = x + nx * (y + ny * z);
                near[other] |= own(other) || labels.owner(other).is_none();
            }
        }
    }
    near
}
