//! Values of an image for the skin and for the bone of a body, and the box of its tissue.

use super::compartments::Compartment;
use super::flood::place;
use crate::image::{ImageVolume, Voxels};
use crate::mesh::Vector;

pub(super) fn values(image: &ImageVolume) -> Vec<f32> {
    match image.voxels() {
        Voxels::I16(values) => values.iter().map(|&value| f32::from(value)).collect(),
        Voxels::F32(values) => values.clone(),
    }
}

/// The values for skin and those for bone, of those of an image for each.
pub(super) fn channels(
    [mut for_skin, values]: [Vec<f32>; 2],
    all: &[Compartment],
    thresholds: [f64; 2],
) -> [Vec<f32>; 2] {
    let [skin, bone] = thresholds.map(|threshold| threshold as f32);
    let scale = bone - skin;
    let emptied = |value: f32| (2.0 * skin - value).clamp(skin - scale, skin - 0.3 * scale);
    let filled = |value: f32| (2.0 * bone - value).clamp(bone + 0.3 * scale, bone + scale);
    let each = values.iter().zip(all);
    let for_bone = each.map(|(&value, compartment)| match compartment {
        Compartment::Cavity | Compartment::Lining => value.max(filled(value)),
        _ => value,
    });
    let for_bone = for_bone.collect();
    for (value, compartment) in for_skin.iter_mut().zip(all) {
        if *compartment == Compartment::OuterAir && *value >= skin {
            *value = emptied(*value);
        }
    }
    [for_skin, for_bone]
}

/// The first and the last voxel along each axis that tissue may reach into.
pub(super) fn tissue_box(all: &[Compartment], size: [usize; 3]) -> Option<[[usize; 3]; 2]> {
    let tissue = (0..all.len()).filter(|&voxel| all[voxel] == Compartment::Tissue);
    let places = tissue.map(|voxel| place(voxel, size));
    let boxed = places.map(|place| [place, place]).reduce(|[low, high], [a, b]| {
        let axis = |axis: usize| (low[axis].min(a[axis]), high[axis].max(b[axis]));
        [[axis(0).0, axis(1).0, axis(2).0], [axis(0).1, axis(1).1, axis(2).1]]
    })?;
    let [low, high] = boxed;
    let last = |axis: usize| (high[axis] + 2).min(size[axis] - 1);
    Some([low.map(|index| index.saturating_sub(2)), [last(0), last(1), last(2)]])
}

pub(super) fn world_box(image: &ImageVolume, [first, last]: [[usize; 3]; 2]) -> (Vector, Vector) {
    let corner = |number: usize| {
        let index = std::array::from_fn(|axis| match number >> axis & 1 {
            0 => first[axis],
            _ => last[axis],
        });
        image.centre(index)
    };
    (1..8).map(corner).fold((corner(0), corner(0)), |(low, high), x| (low.inf(&x), high.sup(&x)))
}
