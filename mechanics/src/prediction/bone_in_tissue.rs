//! Bone that goes into tissue where contact, which would hold them apart, is not solved.

use super::scene::Scene;
use crate::boundary::contact::{BoneInside, Embedded, bones_inside};
use crate::mesh::{Vector, Warning};

/// Without contact bones that lie deeper in tissue than this, in mm, are reported: beside a cut tissue is joined to neither side.
const IN_TISSUE_MM: f64 = 0.5;

/// Warnings of bones that went into tissue where contact, which would hold them apart, was not asked for.
pub(super) fn bones_in_tissue(scene: &Scene, displacement: &[Vector]) -> Vec<Warning> {
    if scene.bones.is_empty() || scene.settings.contact.is_unilateral() {
        return Vec::new();
    }
    let rest = scene.mesh.surface_of(&scene.boundary);
    let moved = rest.displaced(displacement);
    let told = |BoneInside { bone, depth, at, points }: BoneInside| {
        let detail = format!(
            "bone {:?} lies in tissue, up to {depth:.2} mm deep and deeper than before the movement, with {points} of the points of its corners and edges: nothing holds them apart where tissue is not joined to bone, and no error estimate includes that; request `contact` to prevent it",
            scene.bones[bone].name
        );
        let warning = Warning::new("bone-in-tissue", detail).with("depth_mm", depth);
        let warning = warning.with("points", points as f64);
        warning.with("x_mm", at.x).with("y_mm", at.y).with("z_mm", at.z)
    };
    let inside = bones_inside([&rest, &moved], &scene.bones, IN_TISSUE_MM, Embedded::Never);
    inside.into_iter().map(told).collect()
}
