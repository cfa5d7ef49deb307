//! Cleaning of scanned and exported surfaces: flat triangles, doubled ones, and triangles
//! that disagree about inside and outside.

use super::error::FormatError;
use crate::mesh::surface_edges::{TriangleSide, count_edges, edges};
use crate::mesh::{TriangleSurface, Warning, bounds_of};

/// A triangle whose longest edge is shorter than this part of the bounding box is a point.
const SMALLEST_EDGE: f64 = 1e-12;

/// Drops flat and doubled triangles, makes neighbours agree, and turns a closed surface outwards.
pub(super) fn clean(
    surface: &mut TriangleSurface,
    warnings: &mut Vec<Warning>,
) -> Result<(), FormatError> {
    drop_flat(surface, warnings)?;
    drop_doubled(surface, warnings);
    make_consistent(surface, warnings);
    Ok(())
}

fn warn(warnings: &mut Vec<Warning>, code: &'static str, count: usize, what: &str) {
    if count > 0 {
        let warning = Warning::new(code, format!("{count} triangles {what}"));
        warnings.push(warning.with("count", count as f64));
    }
}

fn drop_flat(
    surface: &mut TriangleSurface,
    warnings: &mut Vec<Warning>,
) -> Result<(), FormatError> {
    let size = bounds_of(&surface.points).map_or(0.0, |[low, high]| (high - low).norm());
    let shortest = size * SMALLEST_EDGE;
    let keep: Vec<bool> = (0..surface.triangles.len())
        .map(|triangle| !is_flat(surface, triangle, shortest))
        .collect();
    let before = surface.triangles.len();
    let mut kept = keep.iter();
    surface.triangles.retain(|_| kept.next().copied().unwrap_or(true));
    if surface.triangles.is_empty() {
        return Err(FormatError::Degenerate { what: "triangles", count: before as u64 });
    }
    let dropped = before - surface.triangles.len();
    warn(warnings, "degenerate-triangles", dropped, "without area were dropped");
    Ok(())
}

fn is_flat(surface: &TriangleSurface, triangle: usize, shortest: f64) -> bool {
    let [a, b, c] = surface.corners(triangle);
    let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
    let twice_the_area = (b - a).cross(&(c - a)).norm();
    longest <= shortest || twice_the_area <= f64::EPSILON * longest * longest
}

/// Of triangles with the same three corners the first one stays.
fn drop_doubled(surface: &mut TriangleSurface, warnings: &mut Vec<Warning>) {
    let mut order: Vec<([u32; 3], u32)> = surface.triangles.iter().zip(0..).map(sorted).collect();
    order.sort_unstable();
    let (mut same, mut flipped) = (0, 0);
    let mut drop = vec![false; surface.triangles.len()];
    for group in order.chunk_by(|one, other| one.0 == other.0) {
        let first = surface.triangles[group[0].1 as usize];
        for &(_, triangle) in &group[1..] {
            drop[triangle as usize] = true;
            if has_same_winding(first, surface.triangles[triangle as usize]) {
                same += 1;
            } else {
                flipped += 1;
            }
        }
    }
    let mut dropped = drop.iter();
    surface.triangles.retain(|_| !dropped.next().copied().unwrap_or(false));
    warn(warnings, "duplicate-triangles", same, "stood twice in the file");
    warn(
        warnings,
        "flipped-duplicates",
        flipped,
        "stood a second time in the file, facing the other way",
    );
}

fn sorted((&triangle, number): (&[u32; 3], u32)) -> ([u32; 3], u32) {
    let mut key = triangle;
    key.sort_unstable();
    (key, number)
}

fn has_same_winding([a, b, c]: [u32; 3], other: [u32; 3]) -> bool {
    [[a, b, c], [b, c, a], [c, a, b]].contains(&other)
}

fn make_consistent(surface: &mut TriangleSurface, warnings: &mut Vec<Warning>) {
    let mut sides = surface.sorted_sides();
    if count_edges(&sides).inconsistent > 0 {
        let flipped = flip_minorities(surface, &sides);
        warn(warnings, "triangles-flipped", flipped, "faced the other way than their neighbours");
        sides = surface.sorted_sides();
    }
    let counts = count_edges(&sides);
    let is_closed = counts.open == 0 && counts.nonmanifold == 0 && counts.inconsistent == 0;
    if is_closed && surface.signed_volume() < 0.0 {
        for triangle in &mut surface.triangles {
            triangle.swap(1, 2);
        }
        let all = surface.triangles.len();
        warn(warnings, "surface-turned", all, "of a closed surface faced inwards");
    }
}

/// In each connected part the triangles that disagree with most others are turned.
fn flip_minorities(surface: &mut TriangleSurface, sides: &[TriangleSide]) -> usize {
    let neighbours = neighbours(surface.triangles.len(), sides);
    let mut turned: Vec<Option<bool>> = vec![None; surface.triangles.len()];
    let mut flipped = 0;
    for start in 0..surface.triangles.len() {
        if turned[start].is_some() {
            continue;
        }
        turned[start] = Some(false);
        let mut part = vec![start];
        let mut next = 0;
        while next < part.len() {
            let triangle = part[next];
            next += 1;
            for &(other, agrees) in neighbours[triangle].iter().flatten() {
                let other = other as usize;
                if turned[other].is_none() {
                    turned[other] = turned[triangle].map(|here| here == agrees);
                    part.push(other);
                }
            }
        }
        let count = part.iter().filter(|&&t| turned[t] == Some(true)).count();
        let turn_these = count * 2 <= part.len();
        for &triangle in &part {
            if turned[triangle] == Some(turn_these) {
                surface.triangles[triangle].swap(1, 2);
                flipped += 1;
            }
        }
    }
    flipped
}

/// For each triangle its neighbours across edges of exactly two triangles, and whether both
/// agree about outside.
fn neighbours(triangles: usize, sides: &[TriangleSide]) -> Vec<[Option<(u32, bool)>; 3]> {
    let mut neighbours = vec![[None; 3]; triangles];
    for edge in edges(sides) {
        let [one, other] = edge else { continue };
        let agrees = one.ascending != other.ascending;
        for (from, to) in [(one, other), (other, one)] {
            let slots = &mut neighbours[from.triangle as usize];
            if let Some(slot) = slots.iter_mut().find(|slot| slot.is_none()) {
                *slot = Some((to.triangle, agrees));
            }
        }
    }
    neighbours
}
