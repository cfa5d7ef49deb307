//! A skin that was scanned by itself, in the place of that of an image where it covers the head.
//!
//! Depth s below the scanned skin, in mm, becomes values V = t + a clamp(s / r): t is the threshold of skin, r two voxels, so that V
//! lies at t on the scanned skin. They take the place of the image's values I about the skin as w V + (1 - w) I. The weight w is 1
//! where the scan covers, and falls to 0 towards its open border and where it lies far from the skin of the image, so that the
//! root of the sum goes from one skin to the other between the two, and the surface has no hole there. Bone and airways keep their values.

use rayon::prelude::*;

use super::compartments::{Compartment, Division};
use super::flood::place;
use crate::image::ImageVolume;
use crate::image::distance::nearest_marked;
use crate::mesh::closest_point::SearchError;
use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::surface_edges::edges;
use crate::mesh::{SurfaceSearch, TriangleSurface, Vector};

/// Values of full tissue and of air lie this share of the span of thresholds from that of skin: below bone.
const SHARE: f64 = 0.6;
/// Half the width of the ramp between them, in the longest step between voxels.
const RAMP: f64 = 2.0;
/// The skin of the image counts again from this share of the reach on, more and more.
const FADES: f64 = 0.7;
/// Holes of the scan whose border is shorter, in mm, are no border: what lies around them closes them.
const SMALL_HOLE: f64 = 40.0;
/// Bone this far outside the scanned skin is reported, in mm.
const OUTSIDE: f64 = 1.0;

/// A surface of skin where it lies in the image: open where the camera saw no more, or closed. Lengths in mm.
#[derive(Clone, Debug, PartialEq)]
pub struct ScannedSkin {
    /// Faces outwards.
    pub surface: TriangleSurface,
    /// Farther from the skin of the image it does not count.
    pub reach: f64,
    /// Within so much of its open border it counts less and less.
    pub blend: f64,
}

/// Depth below a scanned skin, in mm, and how much it counts, 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Depth {
    depth: f64,
    weight: f64,
}

/// What the place of a scanned skin made of an image.
pub(super) struct Replaced {
    pub values: Vec<f32>,
    /// Voxels of bone that lie outside the scanned skin.
    pub bone_outside: usize,
}

struct Field<'a> {
    skin: &'a ScannedSkin,
    search: SurfaceSearch,
    /// From each point to the open border.
    to_border: Vec<f64>,
}

impl<'a> Field<'a> {
    fn new(skin: &'a ScannedSkin) -> Result<Self, SearchError> {
        let search = SurfaceSearch::new(&skin.surface)?;
        Ok(Field { to_border: to_border(&skin.surface), skin, search })
    }

    fn at(&self, point: &Vector) -> Option<Depth> {
        let ScannedSkin { surface, reach, blend } = self.skin;
        let closest = self.search.closest_within(point, *reach)?;
        let corners = surface.triangles[closest.triangle].into_iter().zip(closest.barycentric);
        let border: f64 =
            corners.map(|(corner, weight)| weight * self.to_border[corner as usize]).sum();
        let near = smooth((reach - closest.distance) / ((1.0 - FADES) * reach));
        let depth = -self.search.signed_distance(point, &closest);
        Some(Depth { depth, weight: near * smooth(border / blend) })
    }
}

/// 0 below 0, 1 above 1, and as smooth as a cubic between them.
fn smooth(share: f64) -> f64 {
    let share = share.clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

/// From each point to the nearest point of a long open border, in mm; infinite where there is none.
pub(super) fn to_border(surface: &TriangleSurface) -> Vec<f64> {
    let sides = surface.sorted_sides();
    let open: Vec<[u32; 2]> =
        edges(&sides).filter(|edge| edge.len() == 1).map(|edge| edge[0].points).collect();
    let mut loops = DisjointSets::new(surface.points.len());
    open.iter().for_each(|&[a, b]| loops.join(a, b));
    let mut lengths = vec![0.0; surface.points.len()];
    for &[a, b] in &open {
        let length = (surface.points[a as usize] - surface.points[b as usize]).norm();
        lengths[loops.root(a) as usize] += length;
    }
    let long = open.into_iter().filter(|edge| lengths[loops.root(edge[0]) as usize] > SMALL_HOLE);
    let mut points: Vec<u32> = long.flatten().collect();
    points.sort_unstable();
    points.dedup();
    let places: Vec<Vector> = points.iter().map(|&point| surface.points[point as usize]).collect();
    let nearest = |point: &Vector| {
        let squares = places.iter().map(|place| (place - point).norm_squared());
        squares.fold(f64::INFINITY, f64::min).sqrt()
    };
    surface.points.par_iter().with_min_len(64).map(nearest).collect()
}

/// The values of an image for its skin, with the scanned one in it.
pub(super) fn replaced(
    image: &ImageVolume,
    values: &[f32],
    all: &[Compartment],
    (division, skin): (&Division, &ScannedSkin),
) -> Result<Replaced, SearchError> {
    let field = Field::new(skin)?;
    let Division { size, spacing, skin: threshold, bone, .. } = *division;
    let is_air = |voxel: usize| all[voxel] == Compartment::OuterAir;
    let to_air = nearest_marked(size, spacing, is_air);
    let to_head = nearest_marked(size, spacing, |voxel| !is_air(voxel));
    let step = spacing.into_iter().fold(0.0, f64::max);
    let ramp = RAMP * step;
    let height = SHARE * (bone - threshold);
    let blended = |voxel: usize, value: f64| {
        let far = to_air[voxel].distance().max(to_head[voxel].distance());
        let found = (far <= skin.reach + ramp).then(|| image.centre(place(voxel, size)));
        let Depth { depth, weight } = found.and_then(|point| field.at(&point))?;
        let of_scan = threshold + height * (depth / ramp).clamp(-1.0, 1.0);
        Some((weight * of_scan + (1.0 - weight) * value, weight > 0.5 && depth < -OUTSIDE))
    };
    let one = |voxel: usize| {
        let value = f64::from(values[voxel]);
        let is_near_air = to_air[voxel].distance() <= RAMP * step;
        match all[voxel] {
            Compartment::Bone | Compartment::Cavity | Compartment::Lining => {
                let is_out = is_near_air && blended(voxel, value).is_some_and(|found| found.1);
                (value, is_out && all[voxel] == Compartment::Bone)
            }
            Compartment::OuterAir => {
                // What hangs together with the head nowhere is air.
                let air = if value < threshold { value } else { threshold - height };
                (blended(voxel, air).map_or(value, |found| found.0), false)
            }
            Compartment::Tissue if is_near_air => {
                (blended(voxel, value).map_or(value, |found| found.0), false)
            }
            Compartment::Tissue | Compartment::InnerAir => {
                (blended(voxel, value).map_or(value, |found| found.0.min(value)), false)
            }
        }
    };
    let all: Vec<(f64, bool)> = (0..values.len()).into_par_iter().map(one).collect();
    let bone_outside = all.iter().filter(|found| found.1).count();
    Ok(Replaced { values: all.into_iter().map(|found| found.0 as f32).collect(), bone_outside })
}
