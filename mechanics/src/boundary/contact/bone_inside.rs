//! Bone that lies in tissue: contact holds nodes of tissue against bone, so that bone narrower than the cells of tissue may
//! enter between their nodes.

use rayon::prelude::*;

use super::bone::BoneSurface;
use crate::mesh::surface_edges::edges;
use crate::mesh::{SurfaceSearch, TriangleSurface, Vector};

/// Points on an edge of bone are at most this part of an edge of tissue apart.
const SPACING: f64 = 0.5;

/// The most points on an edge.
const MOST_ON_EDGE: f64 = 200.0;

/// A bone of which points lie in tissue, deeper than at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct BoneInside {
    /// Its number among the bones.
    pub bone: usize,
    /// Of the deepest point: how far it is to the boundary of tissue, in mm.
    pub depth: f64,
    pub at: Vector,
    /// How many points do.
    pub points: usize,
}

/// Whether points of bone that lie in tissue at rest, as those of bone that meshes of tissue contain, count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Embedded {
    /// Those that have moved as much themselves as they lie deeper.
    IfMoved,
    Never,
}

/// The bones that lie more than so many mm deeper in tissue after all movement than at rest, of the boundary of the tissue then
/// and at rest. Corners are looked at, and points between them where edges of bone are longer than those of tissue.
pub fn bones_inside(
    [rest, moved]: [&TriangleSurface; 2],
    bones: &[BoneSurface],
    deeper_mm: f64,
    embedded: Embedded,
) -> Vec<BoneInside> {
    let searches = [rest, moved].map(SurfaceSearch::new);
    let [Ok(at_rest), Ok(after)] = &searches else { return Vec::new() };
    let (spacing, (low, high)) = (SPACING * median_shortest_side(rest), moved.bounds());
    let is_within = |at: &Vector| {
        at.iter().zip(&low).all(|(x, low)| x >= low)
            && at.iter().zip(&high).all(|(x, high)| x <= high)
    };
    let of_bone = |(number, bone): (usize, &BoneSurface)| {
        let deeper = |x: &Vector| {
            let by = bone.movement.displacement(x);
            let at = x + by;
            let deep = if is_within(&at) { depth(after, &at) } else { 0.0 };
            if deep <= deeper_mm {
                return None;
            }
            let before = depth(at_rest, x);
            // Where bone lies in tissue that bulges, it has not gone in.
            let has_gone =
                before <= deeper_mm || embedded == Embedded::IfMoved && by.norm() >= deep - before;
            (has_gone && deep > before + deeper_mm).then_some((deep, at))
        };
        let points = points_of(&bone.surface, spacing);
        let inside: Vec<(f64, Vector)> = points.par_iter().filter_map(deeper).collect();
        let (depth, at) = *inside.iter().max_by(|one, other| one.0.total_cmp(&other.0))?;
        Some(BoneInside { bone: number, depth, at, points: inside.len() })
    };
    bones.iter().enumerate().filter_map(of_bone).collect()
}

/// How far a point lies behind a surface, in mm; 0 before it.
fn depth(search: &SurfaceSearch, at: &Vector) -> f64 {
    (-search.signed_distance(at, &search.closest(at))).max(0.0)
}

/// The median of the shortest sides of triangles, in mm.
fn median_shortest_side(surface: &TriangleSurface) -> f64 {
    let shortest = |triangle: usize| {
        let [a, b, c] = surface.corners(triangle);
        (b - a).norm().min((c - b).norm()).min((a - c).norm())
    };
    let mut edges: Vec<f64> = (0..surface.triangles.len()).map(shortest).collect();
    edges.sort_by(f64::total_cmp);
    edges.get(edges.len() / 2).copied().unwrap_or(f64::INFINITY)
}

/// The corners of triangles, and points on their edges no farther apart than a spacing in mm.
fn points_of(surface: &TriangleSurface, spacing: f64) -> Vec<Vector> {
    let mut corners = surface.triangles.as_flattened().to_vec();
    corners.sort_unstable();
    corners.dedup();
    let sides = surface.sorted_sides();
    let at = |point: u32| surface.points[point as usize];
    let between = |[a, b]: [u32; 2]| {
        let along = at(b) - at(a);
        let parts = (along.norm() / spacing).ceil().min(MOST_ON_EDGE);
        (1..parts as u32).map(move |part| at(a) + along * (f64::from(part) / parts))
    };
    let corners = corners.iter().map(|&corner| at(corner));
    corners.chain(edges(&sides).flat_map(|edge| between(edge[0].points))).collect()
}
