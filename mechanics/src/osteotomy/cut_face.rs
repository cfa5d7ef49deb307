//! Faces of cuts: where a saw goes through the bone of a segment, as closed paths on the plane of the cut.
//!
//! The surface of the segment is sliced half a voxel inside the cut, since surfaces of labelled voxels are bevelled by about as
//! much where they are cut, and the slice is brought onto the plane. Paths turn one way around bone and the other way
//! around holes in it.

use std::collections::BTreeMap;

use super::cut::{Cut, Plane, Side};
use super::rule::Osteotomy;
use crate::mesh::{TriangleSurface, Vector};

/// The bone of a segment at one of its cuts.
#[derive(Clone, Debug, PartialEq)]
pub struct CutFace {
    pub cut: usize,
    pub segment: usize,
    /// Points on the plane of the cut, in mm, in their order; the last is joined to the first.
    pub paths: Vec<Vec<Vector>>,
    /// Of bone, in mm².
    pub area: f64,
}

/// Every cut of every segment that goes through its bone; `surfaces` are those of the segments, closed, made of voxels of
/// that size in mm.
pub fn cut_faces(osteotomy: &Osteotomy, surfaces: &[TriangleSurface], voxel: f64) -> Vec<CutFace> {
    let mut faces = Vec::new();
    for (segment, (rule, surface)) in osteotomy.segments().iter().zip(surfaces).enumerate() {
        for side in &rule.sides {
            let cut = &osteotomy.cuts()[side.cut];
            let paths = paths(surface, cut, side.side, 0.5 * voxel);
            let area = paths.iter().map(|path| area(cut.plane(), path)).sum::<f64>().abs();
            if !paths.is_empty() {
                faces.push(CutFace { cut: side.cut, segment, paths, area });
            }
        }
    }
    faces
}

fn paths(surface: &TriangleSurface, cut: &Cut, side: Side, inside: f64) -> Vec<Vec<Vector>> {
    let depth = cut.kerf() / 2.0 + inside;
    let height = match side {
        Side::Below => -depth,
        Side::Above => depth,
    };
    let on_plane = |point: Vector| point - cut.plane().normal() * cut.plane().height(&point);
    let sliced = slices(surface, &cut.plane().raised(height)).into_iter();
    let onto = sliced.map(|path| path.into_iter().map(on_plane).collect::<Vec<_>>());
    // Beside the extent of a cut lies bone that was not sawn, and what spans nothing was only touched.
    let sawn = |path: Vec<Vector>| match cut.clipped(&path) {
        Some(clipped) => clipped,
        None if path.iter().any(|point| cut.reaches(point)) => path,
        None => Vec::new(),
    };
    let spans = |path: &Vec<Vector>| area(cut.plane(), path).abs() > inside * inside;
    onto.map(sawn).filter(spans).collect()
}

/// The closed paths along which a plane meets a surface.
fn slices(surface: &TriangleSurface, plane: &Plane) -> Vec<Vec<Vector>> {
    let heights: Vec<f64> = surface.points.iter().map(|point| plane.height(point)).collect();
    let is_above = |point: u32| heights[point as usize] >= 0.0;
    // From the side of a triangle on which the way around it rises through the plane to that on which it falls.
    let mut next: BTreeMap<[u32; 2], Vec<[u32; 2]>> = BTreeMap::new();
    for corners in &surface.triangles {
        let (mut rising, mut falling) = (None, None);
        for side in 0..3 {
            let (from, to) = (corners[side], corners[(side + 1) % 3]);
            match (is_above(from), is_above(to)) {
                (false, true) => rising = Some([from, to]),
                (true, false) => falling = Some([to, from]),
                (false, false) | (true, true) => {}
            }
        }
        if let (Some(rising), Some(falling)) = (rising, falling) {
            next.entry(rising).or_default().push(falling);
        }
    }
    let crossing = |[below, above]: [u32; 2]| {
        let [low, high] = [below, above].map(|point| heights[point as usize]);
        let [from, to] = [below, above].map(|point| surface.points[point as usize]);
        from + (to - from) * (low / (low - high))
    };
    let mut paths = Vec::new();
    while let Some((&first, _)) = next.iter().next() {
        let (mut path, mut at) = (vec![crossing(first)], first);
        while let Some(to) = next.get_mut(&at).and_then(Vec::pop) {
            if next.get(&at).is_some_and(Vec::is_empty) {
                next.remove(&at);
            }
            if to == first {
                paths.push(std::mem::take(&mut path));
                break;
            }
            path.push(crossing(to));
            at = to;
        }
    }
    paths
}

/// In the axes of the plane; negative of a path that turns the other way.
fn area(plane: &Plane, path: &[Vector]) -> f64 {
    let [u, v] = plane.axes();
    let flat = |point: &Vector| (point - plane.point()).dot(&u);
    let up = |point: &Vector| (point - plane.point()).dot(&v);
    let sides = path.iter().zip(path.iter().cycle().skip(1));
    sides.map(|(a, b)| (flat(a) * up(b) - flat(b) * up(a)) / 2.0).sum()
}
