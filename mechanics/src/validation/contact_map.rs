//! Contact of two surfaces: where they are near to each other or in each other, as numbers and as regions.
//!
//! The gap of a point of the first surface is its signed distance from the second, negative inside. What lies nearer
//! than a stated length is contact; triangles with contact that share a corner are one region. Points whose closest
//! point lies on an open border are beside the second surface and do not count.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::penetration::DEEPEST;
use crate::mesh::area_sampling::{self, AreaSample};
use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::{SurfaceSearch, TriangleSurface, Vector};

/// Samples of the first surface for each mm².
const DENSITY: f64 = 16.0;

/// More than this would take longer than it tells.
const MOST_SAMPLES: f64 = 8e5;

/// A stretch of contact. Areas are of the first surface, in mm².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactRegion {
    pub area: f64,
    /// What of it lies inside the second surface.
    pub overlap_area: f64,
    /// How deep, in mm; 0 where nothing does.
    pub depth: f64,
    /// The smallest gap, in mm; minus the depth where something lies inside.
    pub least_gap: f64,
    /// The middle by area.
    pub middle: Vector,
}

/// The samples of a surface that touch another, and their gaps in mm.
fn touching(
    first: &TriangleSurface,
    second: &SurfaceSearch,
    within: f64,
) -> Vec<(AreaSample, f64)> {
    let count = area_sampling::count_of_every_triangle(first, DENSITY);
    let density = DENSITY * (MOST_SAMPLES / count).min(1.0);
    let samples = area_sampling::every_triangle(first, density);
    let gap = |sample: &AreaSample| {
        let closest = second.closest_within(&sample.point, DEEPEST)?;
        let gap = second.signed_distance(&sample.point, &closest);
        (gap <= within && !second.is_on_open_border(&closest)).then_some((*sample, gap))
    };
    samples.par_iter().with_min_len(256).filter_map(gap).collect()
}

/// The regions of the first surface that are nearer to the second than `within`, in mm, or inside it, the largest first.
pub fn contact_regions(
    first: &TriangleSurface,
    second: &SurfaceSearch,
    within: f64,
) -> Vec<ContactRegion> {
    let touching = touching(first, second, within);
    let mut sets = DisjointSets::new(first.points.len());
    for (sample, _) in &touching {
        let [a, b, c] = first.triangles[sample.triangle as usize];
        sets.join(a, b);
        sets.join(a, c);
    }
    let mut regions: BTreeMap<u32, ContactRegion> = BTreeMap::new();
    for (sample, gap) in touching {
        let root = sets.root(first.triangles[sample.triangle as usize][0]);
        let region = regions.entry(root).or_insert(ContactRegion {
            area: 0.0,
            overlap_area: 0.0,
            depth: 0.0,
            least_gap: f64::INFINITY,
            middle: Vector::zeros(),
        });
        region.area += sample.area;
        region.overlap_area += if gap < 0.0 { sample.area } else { 0.0 };
        region.depth = region.depth.max(-gap);
        region.least_gap = region.least_gap.min(gap);
        region.middle += sample.point * sample.area;
    }
    let mut regions: Vec<ContactRegion> = regions.into_values().collect();
    regions.iter_mut().for_each(|region| region.middle /= region.area);
    regions.sort_by(|a, b| b.area.total_cmp(&a.area));
    regions
}

/// The signed distance of each point of the first surface from the second, in mm; `farthest` where it is farther or
/// beside an open border.
pub fn gaps(first: &TriangleSurface, second: &SurfaceSearch, farthest: f64) -> Vec<f64> {
    let gap = |point: &Vector| {
        let closest = second.closest_within(point, farthest)?;
        let gap = second.signed_distance(point, &closest);
        (!second.is_on_open_border(&closest)).then_some(gap)
    };
    first.points.par_iter().with_min_len(256).map(|point| gap(point).unwrap_or(farthest)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::CellShape;
    use crate::mesh::sample::block;

    /// A block with its lower corner at a place.
    fn brick(size: [f64; 3], cells: [usize; 3], corner: [f64; 3]) -> TriangleSurface {
        let mesh = block(Vector::from(size), cells, CellShape::Hex8);
        let mut surface = mesh.surface_of(&mesh.boundary_faces());
        surface.points.iter_mut().for_each(|point| *point += Vector::from(corner));
        surface
    }

    /// Both bricks as one surface.
    fn both(one: &TriangleSurface, other: &TriangleSurface) -> TriangleSurface {
        let offset = one.points.len() as u32;
        let shifted = other.triangles.iter().map(|corners| corners.map(|corner| corner + offset));
        TriangleSurface {
            points: [one.points.as_slice(), &other.points].concat(),
            triangles: one.triangles.iter().copied().chain(shifted).collect(),
            node_ids: None,
        }
    }

    #[test]
    fn two_cusps_on_a_plate_are_two_regions_with_their_areas_and_depth() {
        let plate = brick([60.0, 40.0, 10.0], [6, 4, 1], [0.0; 3]);
        let plate = SurfaceSearch::new(&plate).unwrap();
        // One cusp of 6 x 4 mm is 0.5 mm inside, another of 3 x 3 mm is 0.1 mm off.
        let inside = brick([6.0, 4.0, 8.0], [6, 4, 8], [10.0, 10.0, 9.5]);
        let near = brick([3.0, 3.0, 8.0], [3, 3, 8], [40.0, 20.0, 10.1]);
        let found = contact_regions(&both(&inside, &near), &plate, 0.3);
        let [first, second] = found[..] else { panic!("{found:?}") };
        // Below and half a millimetre up the sides, and to the contact 0.8 mm up: by samples, of 0.06 mm2.
        assert!((first.overlap_area - (24.0 + 0.5 * 20.0)).abs() < 1.0, "{first:?}");
        assert!((first.area - (24.0 + 0.8 * 20.0)).abs() < 1.6, "{first:?}");
        assert!((first.depth - 0.5).abs() < 1e-9 && (first.least_gap + 0.5).abs() < 1e-9);
        assert!((first.middle - Vector::new(13.0, 12.0, 9.65)).norm() < 0.1, "{first:?}");
        assert!((second.area - (9.0 + 0.2 * 12.0)).abs() < 0.8, "{second:?}");
        assert_eq!((second.overlap_area, second.depth), (0.0, 0.0));
        assert!((second.least_gap - 0.1).abs() < 1e-9, "{second:?}");
        assert!(contact_regions(&near, &plate, 0.05).is_empty());
    }

    #[test]
    fn gaps_are_signed_and_bounded() {
        let plate = SurfaceSearch::new(&brick([60.0, 40.0, 10.0], [6, 4, 1], [0.0; 3])).unwrap();
        let cusp = brick([2.0, 2.0, 8.0], [1, 1, 1], [20.0, 20.0, 9.0]);
        let found = gaps(&cusp, &plate, 5.0);
        for (point, gap) in cusp.points.iter().zip(found) {
            let expected = if point.z < 10.0 { -1.0 } else { 5.0 };
            assert!((gap - expected).abs() < 1e-9, "{point} {gap}");
        }
    }
}
