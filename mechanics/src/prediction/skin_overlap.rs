//! Self-intersection of the predicted skin, which models without contact allow.
//!
//! Pairs of triangles that cross after the movement and did not before it are counted; scanned lips touch, and some
//! of their triangles cross at rest. How deep: the triangles that cross cut the skin into parts, and an edge that
//! pierces one triangle only begins outside and ends inside. Points of the parts that such edges end in lie inside what
//! is not theirs; their depth is how far they lie behind the closest triangle of another part that crosses or lies inside, along its normal:
//! along the surface a point may be far from all that crosses, as where walls are flush. Where that is of another body, the way to what of
//! that body faces the point is taken if it is shorter. The depth
//! is not above the true one, because a point may be closer to the rim of its own part. Where a closed surface does not wind around a point
//! in front of it the point lies outside after all.

use std::collections::BTreeSet;

use super::skin::Skin;
use crate::mesh::crossing::{Piercing, TrianglePair, cross, pass, piercings, self_crossings};
use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::{SurfaceSearch, TriangleSurface, Vector, Warning};

/// The code of the warning.
pub const SKIN_OVERLAPS: &str = "skin-overlaps";

/// Triangles that pass through each other by less than this, in mm, lie on each other; and by less than that they are not told of,
/// because contact is met to half of it.
const TOUCHING_MM: f64 = 1e-5;
const TOLD_MM: f64 = 2e-3;

/// A closed surface winds around a point just in front of its own by about 1 where the point lies behind other skin, and by about 0 where not.
const BEHIND: f64 = 0.3;

/// So far in front, in mm; and how many angles of triangles are looked at for that.
const BEFORE_MM: f64 = 1e-3;
const MOST_ANGLES: usize = 5_000_000;

/// Points of which the depth is taken, evenly chosen.
const MEASURED_POINTS: usize = 1000;

/// The point that lies deepest behind what is not its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Deepest {
    /// In mm.
    pub depth: f64,
    pub at: Vector,
    /// Of all that lies behind what is not its own, on both sides, in mm²: a third of each triangle for each of its corners there.
    pub area: f64,
}

/// How much deeper moved skin passes through itself than at rest, and where; none where no depth is known.
pub(super) fn added_overlap(skin: &Skin, moved: &TriangleSurface) -> Option<Deepest> {
    let depth_of = |surface: &TriangleSurface| {
        let passes = |pair: &TrianglePair| pass(surface, pair, TOUCHING_MM);
        deepest(surface, &self_crossings(surface, passes).pairs)
    };
    let found = depth_of(moved)?;
    let at_rest = depth_of(&skin.surface).map_or(0.0, |own| own.depth);
    Some(Deepest { depth: found.depth - at_rest, ..found })
}

/// A warning that counts the triangles of a moved skin that cross and did not cross at rest. The points of the moved
/// skin have to be finite.
pub fn skin_overlap(skin: &Skin, moved: &TriangleSurface) -> Option<Warning> {
    let rest = &skin.surface;
    let passes = |surface: &TriangleSurface, pair: &TrianglePair| pass(surface, pair, TOLD_MM);
    let found = self_crossings(moved, |pair| !cross(rest, pair) && passes(moved, pair));
    if found.count == 0 && found.untried == 0 {
        return None;
    }
    let at_rest = self_crossings(rest, |pair| passes(rest, pair)).count;
    let through = |pair: &TrianglePair| pass(moved, pair, TOUCHING_MM);
    let deepest = deepest(moved, &self_crossings(moved, through).pairs);
    let (few, depth) = (
        if found.untried > 0 { "at least " } else { "" },
        deepest.as_ref().map_or_else(String::new, |own| {
            format!(", {:.1} mm deep, on {:.0} mm2 of both sides", own.depth, own.area)
        }),
    );
    let place = place(skin, &found.pairs);
    let detail = format!(
        "the predicted skin passes through itself{place}: {few}{} pairs of triangles cross that did not at rest{depth}",
        found.count
    );
    let warning = Warning::new(SKIN_OVERLAPS, detail)
        .with("pairs", found.count as f64)
        .with("pairs_at_rest", at_rest as f64);
    let warning = match found.untried {
        0 => warning,
        untried => warning.with("triangles_not_tried_against_all", untried as f64),
    };
    Some(match deepest {
        None => warning,
        Some(Deepest { depth, at, area }) => warning
            .with("depth_mm", depth)
            .with("area_mm2", area)
            .with("x_mm", at.x)
            .with("y_mm", at.y)
            .with("z_mm", at.z),
    })
}

/// The named parts of the skin that take part, or nothing.
fn place(skin: &Skin, pairs: &[TrianglePair]) -> String {
    let triangles = pairs.as_flattened().iter();
    let points: BTreeSet<u32> =
        triangles.flat_map(|&triangle| skin.surface.triangles[triangle as usize]).collect();
    let takes_part = |points_of: &[u32]| points_of.iter().any(|point| points.contains(point));
    let regions = skin.regions.iter().filter(|(_, points)| takes_part(points));
    let names: Vec<String> = regions.map(|(name, _)| format!("{name:?}")).collect();
    match names.is_empty() {
        true => String::new(),
        false => format!(" at {}", names.join(", ")),
    }
}

/// The deepest of the points that lie behind skin that is not theirs, if any is found there.
fn deepest(surface: &TriangleSurface, pairs: &[TrianglePair]) -> Option<Deepest> {
    let part_of = parts_inside(surface, pairs);
    let inside: Vec<u32> =
        (0..part_of.len() as u32).filter(|&p| part_of[p as usize].is_some()).collect();
    let crosses: BTreeSet<u32> = pairs.as_flattened().iter().copied().collect();
    let is_near = |(number, corners): &(u32, &[u32; 3])| {
        crosses.contains(number) || corners.iter().any(|&corner| part_of[corner as usize].is_some())
    };
    let near: Vec<bool> = (0_u32..).zip(&surface.triangles).map(|one| is_near(&one)).collect();
    let search = SurfaceSearch::new(surface).ok()?;
    let share_inside = |triangle: usize| {
        let corners = surface.triangles[triangle].iter();
        corners.filter(|&&corner| part_of[corner as usize].is_some()).count() as f64 / 3.0
    };
    let triangles = 0..surface.triangles.len();
    let area = triangles.map(|one| share_inside(one) * surface.area_vector(one).norm()).sum();
    let (normals, body_of) = (surface.point_normals(), bodies(surface));
    let depth = |&point: &u32| {
        let own = part_of[point as usize];
        let is_other = |triangle: usize| {
            let corners = surface.triangles[triangle];
            near[triangle] && corners.iter().all(|&corner| part_of[corner as usize] != own)
        };
        let at = surface.points[point as usize];
        let closest = search.closest_where(&at, is_other)?;
        let behind = (closest.point - at).dot(&search.pseudo_normal(&closest));
        let behind = Some(behind).filter(|behind| *behind > 0.0)?;
        let body = |triangle: usize| body_of[surface.triangles[triangle][0] as usize];
        let other = body(closest.triangle);
        let faces = |triangle: usize| {
            body(triangle) == other
                && surface.area_vector(triangle).dot(&normals[point as usize]) < 0.0
        };
        let is_of_other = other != body_of[point as usize];
        let nearer = is_of_other.then(|| search.closest_within_where(&at, behind, faces)).flatten();
        let depth = nearer.map_or(behind, |facing| facing.distance);
        (depth > 0.0).then_some(Deepest { depth, at, area })
    };
    let step = inside.len().div_ceil(MEASURED_POINTS).max(1);
    let measured = inside.iter().step_by(step).filter_map(|point| Some((*point, depth(point)?)));
    let mut measured: Vec<(u32, Deepest)> = measured.collect();
    measured.sort_by(|(_, one), (_, other)| other.depth.total_cmp(&one.depth));
    if !surface.is_closed() {
        return measured.into_iter().next().map(|(_, deepest)| deepest);
    }
    // Where only an edge or a corner passes, what hangs together with its end lies outside.
    let is_behind = |(point, own): &(u32, Deepest)| {
        let before = own.at + normals[*point as usize] * BEFORE_MM;
        surface.winding_number(0..surface.triangles.len(), &before) > BEHIND
    };
    let looked_at = MOST_ANGLES.div_ceil(surface.triangles.len().max(1));
    measured.into_iter().take(looked_at).find(is_behind).map(|(_, deepest)| deepest)
}

/// For each point what it hangs together with.
fn bodies(surface: &TriangleSurface) -> Vec<u32> {
    let mut bodies = DisjointSets::new(surface.points.len());
    for &[a, b, c] in &surface.triangles {
        bodies.join(a, b);
        bodies.join(b, c);
    }
    (0..surface.points.len() as u32).map(|point| bodies.root(point)).collect()
}

/// For each point the part of the skin that it belongs to, where that lies behind other skin. A part with more than
/// half of the points is what the others lie behind.
fn parts_inside(surface: &TriangleSurface, pairs: &[TrianglePair]) -> Vec<Option<u32>> {
    let mut is_cut = vec![false; surface.triangles.len()];
    for &triangle in pairs.as_flattened() {
        is_cut[triangle as usize] = true;
    }
    let mut parts = DisjointSets::new(surface.points.len());
    let whole = surface.triangles.iter().zip(&is_cut).filter(|(_, is_cut)| !**is_cut);
    for (&[a, b, c], _) in whole {
        parts.join(a, b);
        parts.join(b, c);
    }
    let mut points_of = vec![0_usize; surface.points.len()];
    for point in 0..surface.points.len() as u32 {
        points_of[parts.root(point) as usize] += 1;
    }
    let mut is_inside = vec![false; surface.points.len()];
    for point in ends_inside(surface, pairs) {
        let part = parts.root(point) as usize;
        is_inside[part] = 2 * points_of[part] <= surface.points.len();
    }
    let part = |point: u32| Some(parts.root(point)).filter(|&part| is_inside[part as usize]);
    (0..surface.points.len() as u32).map(part).collect()
}

/// The inner ends of edges that pierce one triangle only.
fn ends_inside(surface: &TriangleSurface, pairs: &[TrianglePair]) -> Vec<u32> {
    let mut found: Vec<Piercing> = pairs.iter().flat_map(|pair| piercings(surface, pair)).collect();
    let edge = |piercing: &Piercing| {
        let [front, behind] = piercing.edge;
        [front.min(behind), front.max(behind)]
    };
    // An edge is met in each of its triangles.
    found.sort_unstable_by_key(|piercing| (edge(piercing), *piercing));
    found.dedup();
    let of_edges = found.chunk_by(|one, other| edge(one) == edge(other));
    of_edges.filter(|of_edge| of_edge.len() == 1).map(|of_edge| of_edge[0].edge[1]).collect()
}
