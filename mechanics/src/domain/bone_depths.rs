//! Depth of each voxel in the surfaces of bone, for the division of bone voxel by voxel.

use rayon::prelude::*;

use super::flood::place;
use super::shell::Shell;
use super::surface::SurfaceDomain;
use crate::image::distance::nearest_marked;
use crate::image::{ImageVolume, Placement, Voxels};
use crate::mesh::Vector;
use crate::mesh::enclosed::Enclosed;

/// Voxels of the box of all bone, at most.
const MOST_VOXELS: f64 = 1.5e6;
/// Edges of voxels are no shorter, in mm.
const FINEST: f64 = 1.0;
/// By how much edges grow until voxels are few enough.
const COARSER: f64 = 1.02;
/// Within so many edges of voxels from a surface depths are exact. Farther outside they are not distinguished.
const NEAR: f64 = 2.0;

/// A bone of which more, as a share, lies in another lies within it.
const WITHIN: f64 = 0.9;

/// Bone between surfaces on a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct BoneDepths {
    /// From each voxel to the nearest surface in mm, to half a voxel: positive in bone, no less than two voxels
    /// below zero.
    pub image: ImageVolume,
    /// The number of the bone that each voxel belongs to, or is nearest to.
    pub deepest: Vec<u16>,
    /// Of each bone, without what belongs to another one that lies in it.
    pub solids: Vec<Enclosed>,
}

/// The grid of the voxels.
struct Grid {
    low: Vector,
    edge: f64,
    size: [usize; 3],
}

impl SurfaceDomain {
    /// The depths of its bones on a grid of cubes about all of them. Without bones those of one far outside.
    pub fn bone_depths(&self) -> BoneDepths {
        let boxes = self.bone_shells().map(|bone| bone.tree.bounds());
        let around = boxes.reduce(|(low, high), (a, b)| (low.inf(&a), high.sup(&b)));
        let grid = Grid::around(around.unwrap_or_default());
        let area = grid.size[0] * grid.size[1];
        let near = NEAR * grid.edge;
        let order = Precedence::of(self);
        let layer = |number: usize| -> Layer {
            let own = number * area..(number + 1) * area;
            let mut layer = Layer::default();
            for voxel in own {
                let point = grid.centre(voxel);
                let depths = self.bone_shells().map(|bone| depth(bone, &point, near));
                let depths: Vec<f64> = depths.collect();
                let most = depths.iter().copied().reduce(f64::max).unwrap_or(-1.0);
                let owner = (0..depths.len()).reduce(|own, next| order.owner(&depths, own, next));
                layer.depths.push(most as f32);
                layer.deepest.push(owner.unwrap_or_default() as u16);
                layer.moments.resize(depths.len(), Moments::default());
                add_shares(&mut layer.moments, &depths, &order, owner, (grid.edge, &point));
            }
            layer
        };
        let layers: Vec<Layer> = (0..grid.size[2]).into_par_iter().map(layer).collect();
        let mut moments = vec![Moments::default(); self.bone_shells().count()];
        for layer in &layers {
            moments.iter_mut().zip(&layer.moments).for_each(|(sum, own)| sum.add(own));
        }
        let mut depths: Vec<f32> = layers.iter().flat_map(|layer| &layer.depths).copied().collect();
        let deepest = layers.into_iter().flat_map(|layer| layer.deepest).collect();
        exact_deep_depths(&mut depths, &grid, near);
        let steps = [Vector::x(), Vector::y(), Vector::z()].map(|axis| axis * grid.edge);
        let placement = Placement { origin: grid.low, steps };
        let image = ImageVolume::new(grid.size, placement, Voxels::F32(depths));
        let image = image.expect("cubes of finite depths are an image");
        let solids = moments.iter().map(|own| own.solid(grid.edge)).collect();
        BoneDepths { image, deepest, solids }
    }
}

/// What is found in a layer of voxels, and in it of each bone.
#[derive(Default)]
struct Layer {
    depths: Vec<f32>,
    deepest: Vec<u16>,
    moments: Vec<Moments>,
}

/// Voxels of a bone, those on its surface by their share, and the sum of their centres in mm.
#[derive(Clone, Default)]
struct Moments {
    voxels: f64,
    centres: Vector,
}

impl Moments {
    fn add(&mut self, other: &Moments) {
        self.voxels += other.voxels;
        self.centres += other.centres;
    }

    fn solid(&self, edge: f64) -> Enclosed {
        Enclosed {
            volume_mm3: self.voxels * edge.powi(3),
            centre: self.centres / self.voxels.max(1.0),
        }
    }
}

/// Adds the share of a voxel that lies in each bone: all of one half an edge deep, none half an edge outside, so that a plane that
/// moves through the grid has the volume behind it. What one bone has is left out of those after it: bones that lie within the owner
/// come first, then the owner, then the others, inner ones first.
fn add_shares(
    moments: &mut [Moments],
    depths: &[f64],
    order: &Precedence,
    owner: Option<usize>,
    (edge, point): (f64, &Vector),
) {
    let is_in_owner = |bone: &usize| owner.is_some_and(|own| order.within[*bone][own]);
    let is_other = |bone: &usize| Some(*bone) != owner && !is_in_owner(bone);
    let bones = order.innermost_first.iter().copied();
    let mut left = 1.0;
    for bone in bones.clone().filter(is_in_owner).chain(owner).chain(bones.filter(is_other)) {
        let share = (0.5 + depths[bone] / edge).clamp(0.0, left);
        moments[bone].add(&Moments { voxels: share, centres: point * share });
        left -= share;
    }
}

/// Which of several bones a place belongs to that lies in more than one: the one that lies within the other, else the one in which it
/// lies deeper, else the smaller. The order in which bones are given decides between equal ones alone.
struct Precedence {
    /// In mm³.
    volumes: Vec<f64>,
    /// For each bone those that it lies within.
    within: Vec<Vec<bool>>,
    /// The bones, those that lie within most others first.
    innermost_first: Vec<usize>,
}

impl Precedence {
    fn of(domain: &SurfaceDomain) -> Precedence {
        let bones: Vec<&Shell> = domain.bone_shells().collect();
        let volumes: Vec<f64> = domain.assessments()[1..].iter().map(|of| of.volume).collect();
        let lies_within = |one: usize, other: usize| {
            one != other
                && volumes[one] < volumes[other]
                && bones[one].share(|point| bones[other].value(point) > 0.0) > WITHIN
        };
        let all = 0..bones.len();
        let within: Vec<Vec<bool>> = all
            .clone()
            .map(|one| all.clone().map(|other| lies_within(one, other)).collect())
            .collect();
        let mut innermost_first: Vec<usize> = all.collect();
        let others_around =
            |bone: usize| within[bone].iter().filter(|is_within| **is_within).count();
        innermost_first.sort_by_key(|&bone| std::cmp::Reverse(others_around(bone)));
        Precedence { volumes, within, innermost_first }
    }

    fn owner(&self, depths: &[f64], one: usize, other: usize) -> usize {
        if depths[other] > 0.0 && self.within[other][one] {
            return other;
        }
        if depths[one] > 0.0 && self.within[one][other] {
            return one;
        }
        let deeper = depths[other].total_cmp(&depths[one]);
        match deeper.then(self.volumes[one].total_cmp(&self.volumes[other])).is_gt() {
            true => other,
            false => one,
        }
    }
}

impl Grid {
    /// With two voxels more on each side, so that all bone ends within.
    fn around((low, high): (Vector, Vector)) -> Grid {
        let size = |edge: f64| (high - low).map(|x| (x / edge).ceil() + 4.0);
        let mut edge = FINEST;
        while size(edge).product() > MOST_VOXELS {
            edge *= COARSER;
        }
        let size = size(edge).map(|count| count as usize);
        Grid { low: low.add_scalar(-2.0 * edge), edge, size: size.into() }
    }

    fn centre(&self, voxel: usize) -> Vector {
        self.low + Vector::from(place(voxel, self.size).map(|n| n as f64)) * self.edge
    }
}

/// How deep a point lies in a bone, in mm, from `-near` to `near`.
fn depth(bone: &Shell, point: &Vector, near: f64) -> f64 {
    let side = if bone.value(point) > 0.0 { 1.0 } else { -1.0 };
    let nearest = bone.tree.nearest_within(point, near, |_| true);
    side * nearest.map_or(near, |nearest| nearest.distance)
}

/// Depths of `near` and more: to the nearest voxel outside, less its own way to the surface.
fn exact_deep_depths(depths: &mut [f32], grid: &Grid, near: f64) {
    let outside = nearest_marked(grid.size, [grid.edge; 3], |voxel| depths[voxel] <= 0.0);
    for (voxel, outside) in outside.iter().enumerate() {
        if depths[voxel] >= near as f32 && outside.voxel != u32::MAX {
            let deeper = outside.distance() as f32 + depths[outside.voxel as usize];
            depths[voxel] = depths[voxel].max(deeper);
        }
    }
}
