//! Penetration depth of surfaces under a plan: bone into bone, bone through skin.

use rayon::prelude::*;

use crate::mesh::area_sampling::{self, AreaSample};
use crate::mesh::{SurfaceSearch, TriangleSurface, Vector};

/// Deeper than this, in mm, the side of an open surface says nothing about inside and outside.
pub const DEEPEST: f64 = 20.0;

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

/// What two closed surfaces have in common; nothing where they do not overlap, or one is open. V = 1/3 ∫ x . n over what of each
/// lies inside the other.
pub fn overlap(one: &TriangleSurface, other: &TriangleSurface) -> Option<Overlap> {
    if !(one.is_closed() && other.is_closed()) {
        return None;
    }
    let searches = [SurfaceSearch::new(one).ok()?, SurfaceSearch::new(other).ok()?];
    let depth = reach(&one.points, Side::Inside, &searches[1]).max(reach(
        &other.points,
        Side::Inside,
        &searches[0],
    ));
    let inside = [inside(one, &searches[1]), inside(other, &searches[0])].concat();
    let area: f64 = inside.iter().map(|part| part.area_vector.norm()).sum();
    if area <= 0.0 {
        return None;
    }
    let middle =
        inside.iter().map(|part| part.point * part.area_vector.norm()).sum::<Vector>() / area;
    let cone = |part: &Part| (part.point - middle).dot(&part.area_vector);
    Some(Overlap {
        depth,
        volume: inside.iter().map(cone).sum::<f64>() / 3.0,
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

fn inside(surface: &TriangleSurface, other: &SurfaceSearch) -> Vec<Part> {
    let count = area_sampling::count_of_every_triangle(surface, DENSITY);
    let samples = area_sampling::every_triangle(surface, DENSITY * (MOST_SAMPLES / count).min(1.0));
    let part = |sample: &AreaSample| {
        let closest = other.closest_within(&sample.point, DEEPEST)?;
        let is_inside = other.signed_distance(&sample.point, &closest) < 0.0;
        let normal = surface.area_vector(sample.triangle as usize).normalize();
        (is_inside && !other.is_on_open_border(&closest))
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
