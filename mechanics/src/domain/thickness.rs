//! Thickness of soft tissue about each voxel: from the outer skin to bone or an airway, whichever is nearer.
//!
//! The distance to the nearest voxel of the other side, less the part of that voxel that is not of it (its value's way from
//! the threshold over its slope): exact for a flat boundary along an axis, within a fraction of a voxel otherwise.

use super::compartments::{Compartment, Division};
use super::flood::{Size, neighbours};
use crate::image::distance::nearest_marked;

/// A field whose level separates two sides.
#[derive(Clone, Copy)]
pub(super) struct Level<'a> {
    pub values: &'a [f32],
    pub level: f64,
}

/// State of each voxel of the grid.
pub(super) struct Surroundings {
    /// In mm; infinite where one of the sides is missing.
    pub thickness: Vec<f32>,
    /// The nearest air is that of an airway.
    pub airway: Vec<bool>,
}

/// The surroundings of each voxel; `skin` separates air from the body, `bone` soft tissue from bone.
pub(super) fn surroundings(
    all: &[Compartment],
    division: &Division,
    skin: Level<'_>,
    bone: Level<'_>,
) -> Surroundings {
    let distances = |side: Level<'_>, counts: &dyn Fn(Compartment) -> bool| {
        distances(division, side, |voxel| counts(all[voxel]))
    };
    let outer = distances(skin, &|near| near == Compartment::OuterAir);
    let inner = distances(skin, &|near| near == Compartment::InnerAir);
    let bony = distances(bone, &Compartment::is_bony);
    let airway = inner.iter().zip(&outer).map(|(inner, outer)| inner < outer).collect();
    let others = inner.into_iter().zip(bony).map(|(inner, bony)| inner.min(bony));
    let thickness =
        outer.iter().zip(others).map(|(outer, other)| (outer + other).max(0.0)).collect();
    Surroundings { thickness, airway }
}

/// From each voxel to the boundary of one side, in mm; negative within it.
fn distances(division: &Division, side: Level<'_>, counts: impl Fn(usize) -> bool) -> Vec<f32> {
    let nearest = nearest_marked(division.size, division.spacing, counts);
    let to_boundary = nearest.iter().map(|nearest| match nearest.voxel {
        u32::MAX => f32::INFINITY,
        voxel => (nearest.distance() - depth(voxel as usize, division, side)) as f32,
    });
    to_boundary.collect()
}

/// How far the boundary is from the centre of a voxel, at most one voxel: by the steepest differences to its neighbours, since
/// the boundary lies on one side of it.
fn depth(voxel: usize, division: &Division, side: Level<'_>) -> f64 {
    let mut squares = [0.0f64; 3];
    for near in neighbours(voxel, division.size) {
        let axis = axis_between(voxel, near, division.size);
        let rise = f64::from(side.values[near]) - f64::from(side.values[voxel]);
        squares[axis] = squares[axis].max((rise / division.spacing[axis]).powi(2));
    }
    let most = division.spacing.iter().copied().fold(0.0, f64::max);
    let slope = squares.iter().sum::<f64>().sqrt();
    let away = (f64::from(side.values[voxel]) - side.level).abs() / slope;
    if away.is_finite() { away.min(most) } else { 0.0 }
}

/// The axis along which two neighbours lie.
fn axis_between(voxel: usize, near: usize, [nx, ny, _]: Size) -> usize {
    match voxel.abs_diff(near) {
        step if step == nx * ny => 2,
        step if step == nx => 1,
        _ => 0,
    }
}
