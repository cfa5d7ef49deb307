//! Penetration depth of surfaces under a plan: bone into bone, bone through skin.

use rayon::prelude::*;

use crate::mesh::{SurfaceSearch, Vector};

/// Deeper than this, in mm, the side of an open surface says nothing about inside and outside.
const DEEPEST: f64 = 20.0;

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
        let Some(closest) = surface.nearer_than(point, DEEPEST) else { return 0.0 };
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
