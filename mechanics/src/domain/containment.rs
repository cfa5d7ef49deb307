//! Containment of bone in the skin: how much of each bone lies outside, and whether any of the inside of the skin is free of bone.
//!
//! Both are counted on points spread evenly over the inside of a surface ([`Shell::inside`]): shares are exact to a few per cent
//! of themselves for bone of some size, and to 1/8 for the thinnest.

use rayon::prelude::*;

use super::shell::{BoneShell, Shell};
use super::surface_error::{SurfaceDomainError, SurfaceName};
use crate::mesh::Vector;

/// Bone of which less, as a share, lies inside the skin is refused.
const LEAST_INSIDE: f64 = 0.1;
/// A skin of whose inside less, as a share, is free of bone is refused.
const LEAST_FREE: f64 = 0.005;
/// The same where bone reaches around the skin on all sides.
const LEAST_FREE_AROUND: f64 = 0.1;

/// Where a bone lies by the skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Containment {
    /// How much of the bone lies outside the skin, as a share.
    pub outside: f64,
    /// The middle of what lies outside, in mm; the origin where nothing does.
    pub centre: Vector,
    /// How far that reaches from the skin, in mm.
    pub farthest: f64,
}

/// The containment of each bone, and the share of the inside of the skin that is free of bone; refused where the skin leaves no tissue or a bone lies elsewhere.
pub(super) fn contained(
    skin: &Shell,
    bones: &[BoneShell],
) -> Result<(Vec<Containment>, f64), SurfaceDomainError> {
    let free = skin.share(|point| bones.iter().all(|bone| bone.solid.value(point) <= 0.0));
    let exchanged = bones.iter().any(|bone| reaches_around(&bone.solid, skin));
    if free < if exchanged { LEAST_FREE_AROUND } else { LEAST_FREE } {
        return Err(SurfaceDomainError::NoTissue { percent: 100.0 * (1.0 - free), exchanged });
    }
    let each = bones.iter().map(BoneShell::as_given).enumerate();
    let each = each.map(|(number, bone)| {
        let found = contained_bone(skin, bone);
        match found.outside > 1.0 - LEAST_INSIDE {
            true => Err(refusal(number, skin, bone, found.outside)),
            false => Ok(found),
        }
    });
    Ok((each.collect::<Result<_, _>>()?, free))
}

fn contained_bone(skin: &Shell, bone: &Shell) -> Containment {
    let is_outside = |point: &&Vector| skin.value(point) <= 0.0;
    let outside: Vec<Vector> = bone.inside.par_iter().filter(is_outside).copied().collect();
    let count = outside.len().max(1) as f64;
    let distances = outside.par_iter().map(|point| skin.distance(point));
    Containment {
        outside: outside.len() as f64 / bone.inside.len().max(1) as f64,
        centre: outside.iter().sum::<Vector>() / count,
        farthest: distances.reduce(|| 0.0, f64::max),
    }
}

fn refusal(number: usize, skin: &Shell, bone: &Shell, outside: f64) -> SurfaceDomainError {
    let distances = bone.inside.par_iter().map(|point| skin.distance(point));
    SurfaceDomainError::BoneOutside {
        surface: SurfaceName::Bone(number),
        percent: 100.0 * outside,
        nearest: distances.reduce(|| f64::INFINITY, f64::min),
        skin: Box::new(skin.tree.bounds()),
        bone: Box::new(bone.tree.bounds()),
    }
}

/// The box of a surface lies in that of another.
fn reaches_around(bone: &Shell, skin: &Shell) -> bool {
    let ((low, high), (inner_low, inner_high)) = (bone.tree.bounds(), skin.tree.bounds());
    low.inf(&inner_low) == low && high.sup(&inner_high) == high
}
