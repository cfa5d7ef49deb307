//! Contact of the jaws: whether the lower jaw hangs together with the skull above the threshold of bone.

use super::head::Head;
use crate::image::mask::Mask;
use crate::image::pieces::{Connection, Pieces};
use crate::image::volume::Voxels;
use crate::mesh::Warning;

/// The chin lies so far below the tip of the nose, and the bone of the skull so far above, in mm.
const CHIN: [f64; 2] = [45.0, 100.0];
const SKULL: [f64; 2] = [15.0, 60.0];
/// Bone is looked for so far behind the skin, in mm.
const BEHIND_SKIN: f64 = 25.0;
/// Highest threshold at which jaws are tried to be taken apart, in HU.
const HIGHEST: f64 = 1600.0;
/// To which the threshold is found, in HU.
const CLOSE: f64 = 25.0;

pub(super) fn finding(head: &Head<'_>) -> Option<Warning> {
    let (chin, skull) = seeds(head)?;
    let touch = |threshold: f64| {
        let bone = Mask::above(head.image, threshold).and(&head.skin.head);
        let pieces = Pieces::of(&bone, Connection::Faces);
        pieces.piece(chin).is_some() && pieces.piece(chin) == pieces.piece(skull)
    };
    let bone = head.thresholds.bone;
    if !touch(bone) {
        return None;
    }
    let [mut low, mut high] = [bone, HIGHEST];
    while high - low > CLOSE {
        let middle = 0.5 * (low + high);
        if touch(middle) { low = middle } else { high = middle }
    }
    let detail = format!(
        "above {bone:.0} HU the lower jaw hangs together with the skull (teeth or joints touch); they come apart at about \
         {high:.0} HU, and have to be separated by seeds"
    );
    Some(Warning::new("jaws-touch", detail).with("bone_hu", bone).with("apart_hu", high))
}

/// The densest voxels of the chin and of the skull above the nose, near the skin of the midline.
fn seeds(head: &Head<'_>) -> Option<(usize, usize)> {
    let profile = head.profile(&head.skin.tissue);
    let nose = head.nose(&profile)?;
    let [top, bottom] = CHIN.map(|mm| head.below(nose, mm));
    let chin = densest(head, bottom..top, &profile)?;
    let levels = SKULL.map(|mm| nose + (mm / head.level_height()).round() as usize);
    let skull = densest(head, levels[0]..levels[1].min(head.levels()), &profile)?;
    Some((chin, skull))
}

/// The densest voxel of bone at some levels, no deeper behind the skin than bone of the face.
fn densest(head: &Head<'_>, levels: std::ops::Range<usize>, profile: &[f64]) -> Option<usize> {
    let value = |voxel: usize| match head.image.voxels() {
        Voxels::I16(values) => f64::from(values[voxel]),
        Voxels::F32(values) => f64::from(values[voxel]),
    };
    let near = levels.flat_map(|level| {
        let deepest = profile[level] + BEHIND_SKIN;
        head.strip(level).into_iter().filter(move |at| at.depth <= deepest)
    });
    let near = near.map(|at| at.voxel).filter(|&voxel| value(voxel) >= head.thresholds.bone);
    near.max_by(|&a, &b| value(a).total_cmp(&value(b)))
}
