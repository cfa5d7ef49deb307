//! Penetration depth of surfaces under a plan: bone into bone, bone through skin.

use nalgebra::Matrix3;
use rayon::prelude::*;

use crate::mesh::area_sampling::{self, AreaSample, spread_over};
use crate::mesh::{SurfaceSearch, TriangleSurface, Vector};

/// Deeper than this, in mm, the side of an open surface says nothing about inside and outside.
pub const DEEPEST: f64 = 20.0;

/// Points of `probes` on one triangle are no farther apart than this, in mm, and more of them than `MOST_PROBES` are set wider.
const APART: f64 = 2.0;
const MOST_PROBES: f64 = 3e4;

/// The points of a surface, and more of them on triangles that are larger than the way between: edges and faces of coarse
/// surfaces pass through others that hold none of their corners.
pub fn probes(surface: &TriangleSurface) -> Vec<Vector> {
    let apart = APART.max((surface.area() / MOST_PROBES).sqrt());
    let mut points = surface.points.clone();
    for [a, b, c] in (0..surface.triangles.len()).map(|triangle| surface.corners(triangle)) {
        let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        let rows = (longest / apart).ceil() as usize;
        if rows > 1 {
            points.extend(spread_over(&[a, b, c], rows));
        }
    }
    points
}

/// The side of a surface on which points are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Inside,
    Outside,
}

/// How far points reach to a side of a surface, in mm; 0 where none does. Points whose nearest point
/// lies on an open border are beside the surface and do not count.
pub fn reach(points: &[Vector], side: Side, surface: &SurfaceSearch) -> f64 {
    let depth = |point: &Vector| {
        let Some(closest) = surface.closest_within(point, DEEPEST) else { return 0.0 };
        if surface.is_on_open_border(&closest) {
            return 0.0;
        }
        let outwards = surface.signed_distance(point, &closest);
        match side {
            Side::Inside => -outwards,
            Side::Outside => outwards,
        }
    };
    points.par_iter().map(depth).reduce(|| 0.0, f64::max)
}

/// Overlap of two closed surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// How deep points of either reach into the other, in mm.
    pub depth: f64,
    /// In mm³, from samples of both surfaces, with an error of some percent.
    pub volume: f64,
    /// The middle of its boundary, and how far that goes from there, in mm.
    pub middle: Vector,
    pub radius: f64,
}

/// Samples of each surface for each mm².
const DENSITY: f64 = 4.0;

/// More than this would take longer than it tells.
const MOST_SAMPLES: f64 = 4e5;

/// What two closed surfaces have in common; nothing where they do not overlap, or one is open. V = ∫ (x . a) (n . a) over what of
/// each lies inside the other, along the axis a that most of it faces, so that narrow sides count for little.
pub fn overlap(one: &TriangleSurface, other: &TriangleSurface) -> Option<Overlap> {
    if !(one.is_closed() && other.is_closed()) {
        return None;
    }
    let searches = [SurfaceSearch::new(one).ok()?, SurfaceSearch::new(other).ok()?];
    let depth = reach(&probes(one), Side::Inside, &searches[1]).max(reach(
        &probes(other),
        Side::Inside,
        &searches[0],
    ));
    // Where both boundaries are one, that of the first counts.
    let inside =
        [inside(one, (other, &searches[1]), true), inside(other, (one, &searches[0]), false)]
            .concat();
    let area: f64 = inside.iter().map(|part| part.area_vector.norm()).sum();
    if area <= 0.0 {
        return None;
    }
    let middle =
        inside.iter().map(|part| part.point * part.area_vector.norm()).sum::<Vector>() / area;
    let across = across(&inside);
    let column = |part: &Part| (part.point - middle).dot(&across) * part.area_vector.dot(&across);
    Some(Overlap {
        depth,
        volume: inside.iter().map(column).sum(),
        middle,
        radius: inside.iter().map(|part| (part.point - middle).norm()).fold(0.0, f64::max),
    })
}

/// A piece of a surface.
#[derive(Clone, Copy)]
struct Part {
    point: Vector,
    area_vector: Vector,
}

/// The axis that most of a boundary faces, of length 1.
fn across(parts: &[Part]) -> Vector {
    let of_part = |part: &Part| {
        let area = part.area_vector.norm();
        part.area_vector * part.area_vector.transpose() / area.max(f64::MIN_POSITIVE)
    };
    let facing: Matrix3<f64> = parts.iter().map(of_part).sum();
    let modes = facing.symmetric_eigen();
    modes.eigenvectors.column(modes.eigenvalues.imax()).into_owned()
}

/// Boundaries as near as this share of the deepest depth lie on each other.
const SAME: f64 = 1e-9;

/// The parts of a surface inside another, and those on its boundary that face the same way, if these are counted.
fn inside(
    surface: &TriangleSurface,
    (other, search): (&TriangleSurface, &SurfaceSearch),
    counts_shared: bool,
) -> Vec<Part> {
    let count = area_sampling::count_of_every_triangle(surface, DENSITY);
    let samples = area_sampling::every_triangle(surface, DENSITY * (MOST_SAMPLES / count).min(1.0));
    let part = |sample: &AreaSample| {
        let closest = search.closest_within(&sample.point, DEEPEST)?;
        let normal = surface.area_vector(sample.triangle as usize).normalize();
        let is_inside = match closest.distance < SAME * DEEPEST {
            true => counts_shared && normal.dot(&other.area_vector(closest.triangle)) > 0.0,
            false => search.signed_distance(&sample.point, &closest) < 0.0,
        };
        (is_inside && !search.is_on_open_border(&closest))
            .then(|| Part { point: sample.point, area_vector: normal * sample.area })
    };
    samples.par_iter().with_min_len(256).filter_map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::sample::block;
    use crate::mesh::{CellShape, TriangleSurface};

    /// A cube of 10 mm with its corner at a place.
    fn cube(corner: Vector) -> TriangleSurface {
        let mesh = block(Vector::new(10.0, 10.0, 10.0), [4, 4, 4], CellShape::Hex8);
        let mut surface = mesh.surface_of(&mesh.boundary_faces());
        surface.points.iter_mut().for_each(|point| *point += corner);
        surface
    }

    #[test]
    fn a_cube_pushed_into_another_reaches_as_deep_as_it_was_pushed() {
        let fixed = SurfaceSearch::new(&cube(Vector::zeros())).expect("a cube has an area");
        for (gap, depth) in [(-3.0, 3.0), (-0.5, 0.5), (0.0, 0.0), (2.0, 0.0)] {
            let pushed = cube(Vector::new(10.0 + gap, 0.0, 0.0));
            let found = reach(&pushed.points, Side::Inside, &fixed);
            // The middle of the pushed face is the deepest: 5 mm from the other sides.
            assert!((found - depth).abs() < 1e-9, "gap {gap}: {found}");
        }
    }

    /// Of two triangles a side.
    fn coarse_box(corner: Vector, size: Vector) -> TriangleSurface {
        let mesh = block(size, [1, 1, 1], CellShape::Hex8);
        let mut surface = mesh.surface_of(&mesh.boundary_faces());
        surface.points.iter_mut().for_each(|point| *point += corner);
        surface
    }

    #[test]
    fn coarse_boxes_that_hold_no_corner_of_each_other_overlap() {
        // A cross of two bars: 10 x 10 x 4 mm in common, neither of which has a corner there.
        let one = coarse_box(Vector::zeros(), Vector::new(60.0, 10.0, 10.0));
        let other = coarse_box(Vector::new(25.0, -25.0, 6.0), Vector::new(10.0, 60.0, 10.0));
        let search = SurfaceSearch::new(&one).expect("a box has an area");
        assert_eq!(reach(&other.points, Side::Inside, &search), 0.0);
        let found = overlap(&one, &other).expect("they overlap");
        assert!((3.0..=4.0 + 1e-9).contains(&found.depth), "{found:?}");
        // Samples are half a mm apart, on sides of 10 mm.
        assert!((found.volume - 400.0).abs() < 24.0, "{found:?}");
    }

    #[test]
    fn overlaps_of_boxes_with_sides_in_common_and_thin_ones_have_their_volume() {
        let size = Vector::new(20.0, 20.0, 10.0);
        let one = coarse_box(Vector::zeros(), size);
        for thick in [4.0, 0.3] {
            let other = coarse_box(Vector::new(0.0, 0.0, 10.0 - thick), size);
            let found = overlap(&one, &other).expect("they overlap");
            let volume = 400.0 * thick;
            assert!((found.volume - volume).abs() < 0.03 * volume, "{thick}: {found:?}");
        }
    }

    #[test]
    fn a_cube_inside_another_reaches_outside_only_where_it_sticks_out() {
        let skin = SurfaceSearch::new(&cube(Vector::zeros())).expect("a cube has an area");
        let mut bone = cube(Vector::zeros());
        bone.points.iter_mut().for_each(|point| *point = *point * 0.5 + Vector::new(2.0, 2.0, 2.0));
        assert_eq!(reach(&bone.points, Side::Outside, &skin), 0.0);
        bone.points.iter_mut().for_each(|point| point.x += 4.0);
        assert!((reach(&bone.points, Side::Outside, &skin) - 1.0).abs() < 1e-9);
    }
}
