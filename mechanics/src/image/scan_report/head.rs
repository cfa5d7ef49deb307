//! A head in its scan, with the axes of the body.

use crate::image::mask::{Grid, Mask};
use crate::image::outer_skin::{OuterSkin, outer_skin};
use crate::image::thresholds::Thresholds;
use crate::image::volume::ImageVolume;

/// Nostrils and lips that are apart by less than twice this, in mm, are closed.
const CLOSING: f64 = 4.0;
/// Half the width of the strip that counts as the midline, in mm.
const MIDLINE: f64 = 4.0;

/// An axis of the image, and which way along it something lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct AxisDirection {
    pub axis: usize,
    /// Whether the number of the voxel grows that way.
    pub grows: bool,
}

pub(super) struct Head<'a> {
    pub image: &'a ImageVolume,
    pub grid: Grid,
    pub thresholds: Thresholds,
    pub skin: OuterSkin,
    pub up: AxisDirection,
    pub front: AxisDirection,
    /// From right to left.
    across: usize,
    /// The voxel in the middle, along that axis.
    middle: f64,
}

impl<'a> Head<'a> {
    /// Of an image in LPS.
    pub fn new(image: &'a ImageVolume, thresholds: Thresholds) -> Head<'a> {
        let directions = image.directions();
        let along = |component: usize, taken: &[usize]| {
            let free = (0..3).filter(|axis| !taken.contains(axis));
            let size = |axis: &usize| directions[*axis][component].abs();
            free.max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(component)
        };
        let up = along(2, &[]);
        let front = along(1, &[up]);
        let across = 3 - up - front;
        let solid = Mask::above(image, thresholds.skin);
        let skin = outer_skin(&solid, up, CLOSING);
        let grid = Grid::of(image);
        let middle = middle(&skin.tissue, across);
        Head {
            image,
            grid,
            thresholds,
            skin,
            up: AxisDirection { axis: up, grows: directions[up].z > 0.0 },
            // Posterior is positive.
            front: AxisDirection { axis: front, grows: directions[front].y < 0.0 },
            across,
            middle,
        }
    }

    /// The place in the row of an axis that is so many voxels away from its lower, or its back end.
    fn place(&self, way: AxisDirection, steps: usize) -> usize {
        if way.grows { steps } else { self.grid.size[way.axis] - 1 - steps }
    }

    /// How many levels there are, from below upwards.
    pub fn levels(&self) -> usize {
        self.grid.size[self.up.axis]
    }

    /// In mm.
    pub fn level_height(&self) -> f64 {
        self.grid.spacing[self.up.axis]
    }

    /// The voxels of the strip of the midline at a level, the foremost first; each with its depth from the front end of
    /// the image, in mm.
    pub fn strip(&self, level: usize) -> Vec<StripVoxel> {
        let half = MIDLINE / self.grid.spacing[self.across];
        let last = self.grid.size[self.across] - 1;
        let from = (self.middle - half).round().max(0.0) as usize;
        let to = ((self.middle + half).round().max(0.0) as usize).min(last);
        let depths = self.grid.size[self.front.axis];
        let mut voxels = Vec::new();
        for step in (0..depths).rev() {
            for across in from..=to {
                let mut index = [0; 3];
                index[self.up.axis] = self.place(self.up, level);
                index[self.front.axis] = self.place(self.front, step);
                index[self.across] = across;
                let depth = (depths - 1 - step) as f64 * self.grid.spacing[self.front.axis];
                voxels.push(StripVoxel { voxel: self.grid.number(index), depth });
            }
        }
        voxels
    }

    /// How deep the first voxel of a mask lies at each level of the midline, in mm; infinite where there is none.
    pub fn profile(&self, mask: &Mask) -> Vec<f64> {
        let depth = |level| {
            let strip = self.strip(level);
            strip.iter().find(|at| mask.inside[at.voxel]).map_or(f64::INFINITY, |at| at.depth)
        };
        (0..self.levels()).map(depth).collect()
    }

    /// The level of the tip of the nose: the foremost of the midline.
    pub fn nose(&self, profile: &[f64]) -> Option<usize> {
        let level = (0..profile.len()).min_by(|&a, &b| profile[a].total_cmp(&profile[b]))?;
        profile[level].is_finite().then_some(level)
    }

    /// Levels so far below another, in mm.
    pub fn below(&self, level: usize, mm: f64) -> usize {
        level.saturating_sub((mm / self.level_height()).round() as usize)
    }
}

#[derive(Clone, Copy)]
pub(super) struct StripVoxel {
    pub voxel: usize,
    pub depth: f64,
}

/// The mean place of a mask along an axis.
fn middle(mask: &Mask, axis: usize) -> f64 {
    let inside = mask.inside.iter().enumerate().filter(|(_, inside)| **inside);
    let (count, sum) = inside
        .fold((0_u64, 0_u64), |(n, sum), (at, _)| (n + 1, sum + mask.grid.index(at)[axis] as u64));
    if count == 0 { 0.0 } else { sum as f64 / count as f64 }
}
