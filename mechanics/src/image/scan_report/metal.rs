//! Metal, and the streaks that it throws over soft tissue.

use super::head::Head;
use crate::image::distance::squared_distance;
use crate::image::mask::Mask;
use crate::image::volume::{ImageVolume, Voxels};
use crate::mesh::Warning;

/// Nothing of the body is denser, in HU; enamel comes near it.
const METAL: f64 = 2500.0;
/// Streaks are looked for so far around metal, in mm: beyond its own blur.
const AROUND: [f64; 2] = [4.0, 25.0];
/// Soft tissue, in HU.
const SOFT: std::ops::RangeInclusive<f64> = -150.0..=200.0;
/// Neighbours of soft tissue that is compared: what is not bone nor air, in HU.
const NEAR_SOFT: std::ops::RangeInclusive<f64> = -450.0..=500.0;
/// Noise near metal is so many times that elsewhere where there are streaks.
const STREAKS: f64 = 1.5;

pub(super) fn finding(head: &Head<'_>) -> Option<Warning> {
    let metal = Mask::above(head.image, METAL).and(&head.skin.head);
    let voxels = metal.count();
    if voxels == 0 {
        return None;
    }
    let distance = squared_distance(&metal);
    let [from, to] = AROUND.map(|mm| (mm * mm) as f32);
    let roughness = Roughness::of(head);
    // Streaks lie in the slices of the metal.
    let has_metal = levels(head, &metal);
    let level = |voxel: usize| head.grid.index(voxel)[head.up.axis];
    let is_near = |voxel| (from..to).contains(&distance[voxel]) && has_metal[level(voxel)];
    let near = roughness.median(is_near)?;
    let far = roughness.median(|voxel| !has_metal[level(voxel)])?;
    let volume = voxels as f64 * head.grid.voxel_volume();
    let share = voxels as f64 / head.skin.head.count() as f64;
    let detail = format!(
        "metal or enamel of {:.2} cm3 above {METAL} HU throws streaks: soft tissue around it is rough by {near:.0} HU, \
         elsewhere by {far:.0} HU",
        volume / 1000.0
    );
    (near > STREAKS * far).then(|| {
        let warning = Warning::new("metal-streaks", detail).with("volume_mm3", volume);
        warning.with("share", share).with("near_hu", near).with("far_hu", far)
    })
}

/// Which slices across the body hold any of a mask.
fn levels(head: &Head<'_>, mask: &Mask) -> Vec<bool> {
    let mut holds = vec![false; head.levels()];
    let inside = mask.inside.iter().enumerate().filter(|(_, inside)| **inside);
    inside.for_each(|(voxel, _)| holds[head.grid.index(voxel)[head.up.axis]] = true);
    holds
}

/// How far each voxel of soft tissue is from the mean of its four neighbours within the slice.
struct Roughness {
    of_voxel: Vec<(usize, f64)>,
}

impl Roughness {
    fn of(head: &Head<'_>) -> Roughness {
        let in_slice = (0..3).filter(|&axis| axis != head.up.axis);
        let strides: Vec<usize> = in_slice.map(|axis| head.grid.stride(axis)).collect();
        let value = values(head.image);
        let mut of_voxel = Vec::new();
        for voxel in 0..head.grid.len() {
            let here = value(voxel);
            if !SOFT.contains(&here) || head.grid.is_border(head.grid.index(voxel)) {
                continue;
            }
            let around = strides.iter().flat_map(|stride| [voxel - stride, voxel + stride]);
            let around: Vec<f64> = around.map(&value).filter(|v| NEAR_SOFT.contains(v)).collect();
            if around.len() == 2 * strides.len() {
                of_voxel.push((voxel, (here - around.iter().sum::<f64>() / 4.0).abs()));
            }
        }
        Roughness { of_voxel }
    }

    fn median(&self, takes: impl Fn(usize) -> bool) -> Option<f64> {
        let taken = self.of_voxel.iter().filter(|(voxel, _)| takes(*voxel));
        let mut taken: Vec<f64> = taken.map(|(_, roughness)| *roughness).collect();
        taken.sort_by(f64::total_cmp);
        taken.get(taken.len() / 2).copied()
    }
}

fn values(image: &ImageVolume) -> impl Fn(usize) -> f64 + '_ {
    move |voxel| match image.voxels() {
        Voxels::I16(values) => f64::from(values[voxel]),
        Voxels::F32(values) => f64::from(values[voxel]),
    }
}
