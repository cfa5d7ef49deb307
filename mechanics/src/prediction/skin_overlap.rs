//! Self-intersection of the predicted skin, which models without contact allow.
//!
//! Pairs of triangles that cross after the movement and did not before it are counted; scanned lips touch, and some
//! of their triangles cross at rest. How deep: the triangles that cross cut the skin into parts, and an edge that
//! pierces one triangle only begins outside and ends inside. Points of the parts that such edges end in lie inside what
//! is not theirs; their depth is how far they lie behind the closest triangle of another part that crosses or lies inside, along its normal:
//! along the surface a point may be far from all that crosses, as where walls are flush. Where that is of another body, the way to what of
//! that body faces the point is taken if it is shorter. Of an edge that passes through other skin, in through one triangle and out through
//! another or to an end that lies inside, the middle of what lies inside is as deep as the way to the closest triangle of another body, or
//! of its own one that does not continue it.
//! The depth is not above the true one, because a point may be closer to the rim of its own part, an edge deeper beside that middle, and
//! nothing goes deeper than it moved.
//! Where a closed surface does not wind around a point in front of it the point lies outside after all.

use std::collections::BTreeSet;

use super::skin::Skin;
use crate::mesh::crossing::{Piercing, TrianglePair, cross, pass, piercings, self_crossings};
use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::{ClosestPoint, SurfaceSearch, TriangleSurface, Vector, Warning};

/// The code of the warning.
pub const SKIN_OVERLAPS: &str = "skin-overlaps";

/// Triangles that pass through each other by less than this, in mm, lie on each other; and by less than that they are not told of,
/// because contact is met to half of it.
const TOUCHING_MM: f64 = 1e-5;
const TOLD_MM: f64 = 2e-3;

/// A closed surface winds around a point just in front of its own by about 1 where the point lies behind other skin, and by about 0 where not.
const BEHIND: f64 = 0.3;

/// Skin of the same body whose normals differ by less than what has this cosine continues an edge.
const ALONG: f64 = 0.5;

/// So far in front, in mm; and how many angles of triangles are looked at.
const BEFORE_MM: f64 = 1e-3;
const MOST_ANGLES: usize = 5_000_000;

/// Points, and edges, of which the depth is taken, evenly chosen.
const MEASURED: usize = 1000;

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
    let depth_of = |surface: &TriangleSurface, rest: Option<&TriangleSurface>| {
        let passes = |pair: &TrianglePair| pass(surface, pair, TOUCHING_MM);
        deepest(surface, rest, &self_crossings(surface, passes).pairs)
    };
    let found = depth_of(moved, Some(&skin.surface))?;
    let in_all = |surface| depth_of(surface, None).map_or(0.0, |own| own.depth);
    Some(Deepest { depth: found.depth.min(in_all(moved) - in_all(&skin.surface)), ..found })
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
    let deepest = deepest(moved, Some(rest), &self_crossings(moved, through).pairs);
    // Edges may cross what they only lie on.
    if found.untried == 0 && deepest.as_ref().is_some_and(|own| own.depth <= TOLD_MM) {
        return None;
    }
    let (few, depth) = (
        if found.untried > 0 { "at least " } else { "" },
        deepest.as_ref().map_or_else(String::new, |own| {
            // A tenth of a millimetre is much where only edges pass.
            let digits = if own.depth < 1.0 { 2 } else { 1 };
            let on = match own.area > 0.0 {
                true => format!("on {:.0} mm2 of both sides", own.area),
                false => "at edges only".to_owned(),
            };
            format!(", {:.digits$} mm deep, {on}", own.depth)
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

/// The deepest of the points and edges that lie behind skin that is not theirs, if any is found there.
fn deepest(
    surface: &TriangleSurface,
    rest: Option<&TriangleSurface>,
    pairs: &[TrianglePair],
) -> Option<Deepest> {
    let skin = Penetration::new(surface, rest, pairs)?;
    let share_inside = |triangle: usize| {
        let corners = surface.triangles[triangle].iter();
        corners.filter(|&&corner| skin.part_of[corner as usize].is_some()).count() as f64 / 3.0
    };
    let triangles = 0..surface.triangles.len();
    let area = triangles.map(|one| share_inside(one) * surface.area_vector(one).norm()).sum();
    let points = 0..skin.part_of.len() as u32;
    let inside: Vec<u32> = points.filter(|&p| skin.part_of[p as usize].is_some()).collect();
    let edges = edges_inside(surface, pairs, &skin.part_of);
    let of_points = evenly(&inside).filter_map(|&point| skin.of_point(point));
    let of_edges = evenly(&edges).filter_map(|edge| skin.of_edge(edge));
    let mut measured: Vec<PlaceBehind> = of_points.chain(of_edges).collect();
    measured.sort_by(|one, other| other.depth.total_cmp(&one.depth));
    let told = |PlaceBehind { at, depth, .. }: PlaceBehind| Deepest { depth, at, area };
    if !surface.is_closed() {
        return measured.into_iter().next().map(told);
    }
    // Where only an edge or a corner passes, what hangs together with its end lies outside.
    let is_behind = |own: &PlaceBehind| {
        let before = own.at + own.normal * BEFORE_MM;
        surface.winding_number(0..surface.triangles.len(), &before) > BEHIND
    };
    let looked_at = MOST_ANGLES.div_ceil(surface.triangles.len().max(1));
    measured.into_iter().take(looked_at).find(is_behind).map(told)
}

/// At most so many as are measured.
fn evenly<T>(all: &[T]) -> impl Iterator<Item = &T> {
    all.iter().step_by(all.len().div_ceil(MEASURED).max(1))
}

/// A place of skin behind what is not its own.
struct PlaceBehind {
    at: Vector,
    /// The unit normal of the skin there.
    normal: Vector,
    /// In mm.
    depth: f64,
}

/// A part of an edge that lies behind other skin: its points and, as parts of the way between them, its ends.
struct EdgeInside {
    edge: [u32; 2],
    part: [f64; 2],
}

/// Skin some of whose triangles cross others.
struct Penetration<'a> {
    surface: &'a TriangleSurface,
    rest: Option<&'a TriangleSurface>,
    search: SurfaceSearch,
    /// For each point the part behind other skin that it belongs to.
    part_of: Vec<Option<u32>>,
    /// Triangles that cross or have a corner behind other skin.
    near: Vec<bool>,
    normals: Vec<Vector>,
    body_of: Vec<u32>,
}

impl<'a> Penetration<'a> {
    fn new(
        surface: &'a TriangleSurface,
        rest: Option<&'a TriangleSurface>,
        pairs: &[TrianglePair],
    ) -> Option<Self> {
        let part_of = parts_inside(surface, pairs);
        let crosses: BTreeSet<u32> = pairs.as_flattened().iter().copied().collect();
        let is_near = |(number, corners): (u32, &[u32; 3])| {
            let mut corners = corners.iter();
            crosses.contains(&number) || corners.any(|&corner| part_of[corner as usize].is_some())
        };
        let near = (0_u32..).zip(&surface.triangles).map(is_near).collect();
        let search = SurfaceSearch::new(surface).ok()?;
        let (normals, body_of) = (surface.point_normals(), bodies(surface));
        Some(Penetration { surface, rest, search, part_of, near, normals, body_of })
    }

    fn body(&self, triangle: usize) -> u32 {
        self.body_of[self.surface.triangles[triangle][0] as usize]
    }

    fn of_point(&self, point: u32) -> Option<PlaceBehind> {
        let Penetration { surface, search, part_of, near, .. } = self;
        let own = part_of[point as usize];
        let is_other = |triangle: usize| {
            let corners = surface.triangles[triangle];
            near[triangle] && corners.iter().all(|&corner| part_of[corner as usize] != own)
        };
        let (at, normal) = (surface.points[point as usize], self.normals[point as usize]);
        let closest = search.closest_where(&at, is_other)?;
        let behind = (closest.point - at).dot(&search.pseudo_normal(&closest));
        let behind = Some(behind).filter(|behind| *behind > 0.0)?;
        let other = self.body(closest.triangle);
        let faces = |triangle: usize| {
            self.body(triangle) == other && surface.area_vector(triangle).dot(&normal) < 0.0
        };
        let is_of_other = other != self.body_of[point as usize];
        let nearer = is_of_other.then(|| search.closest_within_where(&at, behind, faces)).flatten();
        let depth = nearer.as_ref().map_or(behind, |facing| facing.distance);
        let most = self.approach(&[(point, 1.0)], &nearer.unwrap_or(closest));
        (depth > 0.0).then_some(PlaceBehind { at, normal, depth: depth.min(most) })
    }

    fn of_edge(&self, EdgeInside { edge, part }: &EdgeInside) -> Option<PlaceBehind> {
        let Penetration { surface, search, .. } = self;
        let [from, to] = edge.map(|end| surface.points[end as usize]);
        let along = 0.5 * (part[0] + part[1]);
        let at = from + (to - from) * along;
        let normal: Vector = edge.iter().map(|&end| self.normals[end as usize]).sum();
        let normal = normal.try_normalize(0.0)?;
        let is_other = |triangle: usize| {
            let area = surface.area_vector(triangle);
            let turns = || area.dot(&normal) < ALONG * area.norm();
            let is_around = edge.iter().any(|end| surface.triangles[triangle].contains(end));
            !is_around && (self.body(triangle) != self.body_of[edge[0] as usize] || turns())
        };
        let closest = search.closest_where(&at, is_other)?;
        let is_behind = (closest.point - at).dot(&search.pseudo_normal(&closest)) >= 0.0;
        let middle = [(edge[0], 1.0 - along), (edge[1], along)];
        let depth = closest.distance.min(self.approach(&middle, &closest));
        is_behind.then_some(PlaceBehind { at, normal, depth })
    }

    /// How far the mean of points by their weights moved against a place of the skin, in mm; infinite without a rest that it moved from.
    fn approach(&self, points: &[(u32, f64)], place: &ClosestPoint) -> f64 {
        let Some(rest) = self.rest else { return f64::INFINITY };
        let moved = |&(point, weight): &(u32, f64)| {
            (self.surface.points[point as usize] - rest.points[point as usize]) * weight
        };
        let corners = self.surface.triangles[place.triangle].into_iter().zip(place.barycentric);
        let of_place: Vector = corners.map(|corner| moved(&corner)).sum();
        (points.iter().map(moved).sum::<Vector>() - of_place).norm()
    }
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
    let found = sorted_piercings(surface, pairs);
    let of_edges = found.chunk_by(|one, other| ends(one) == ends(other));
    of_edges.filter(|of_edge| of_edge.len() == 1).map(|of_edge| of_edge[0].edge[1]).collect()
}

/// The parts of edges between where they go in through a triangle and where they come out through the next one, or end in a part
/// behind other skin.
fn edges_inside(
    surface: &TriangleSurface,
    pairs: &[TrianglePair],
    part_of: &[Option<u32>],
) -> Vec<EdgeInside> {
    let found = sorted_piercings(surface, pairs);
    let of_edges = found.chunk_by(|one, other| ends(one) == ends(other));
    let parts = of_edges.flat_map(|of_edge| {
        let edge = ends(&of_edge[0]);
        let mut passed: Vec<(f64, bool)> = of_edge
            .iter()
            .map(|piercing| (along(surface, edge, piercing.triangle), piercing.edge == edge))
            .collect();
        let [begins, ends] = edge.map(|end| part_of[end as usize].is_some());
        passed
            .extend(begins.then_some((0.0, true)).into_iter().chain(ends.then_some((1.0, false))));
        passed.sort_by(|(one, _), (other, _)| one.total_cmp(other));
        let between = |pair: &[(f64, bool)]| match *pair {
            [(from, true), (to, false)] => Some(EdgeInside { edge, part: [from, to] }),
            _ => None,
        };
        passed.windows(2).filter_map(between).collect::<Vec<_>>()
    });
    parts.collect()
}

/// Where the plane of a triangle is between the ends of an edge on both sides of it, as a part of the way.
fn along(surface: &TriangleSurface, edge: [u32; 2], triangle: u32) -> f64 {
    let [corner, ..] = surface.corners(triangle as usize);
    let normal = surface.area_vector(triangle as usize);
    let [from, to] = edge.map(|end| normal.dot(&(surface.points[end as usize] - corner)));
    from / (from - to)
}

/// Where edges pierce triangles, those of an edge side by side. An edge is met in each of its triangles and is there once.
fn sorted_piercings(surface: &TriangleSurface, pairs: &[TrianglePair]) -> Vec<Piercing> {
    let mut found: Vec<Piercing> = pairs.iter().flat_map(|pair| piercings(surface, pair)).collect();
    found.sort_unstable_by_key(|piercing| (ends(piercing), *piercing));
    found.dedup();
    found
}

/// The points of an edge that pierces, the smaller number first.
fn ends(piercing: &Piercing) -> [u32; 2] {
    let [front, behind] = piercing.edge;
    [front.min(behind), front.max(behind)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::CellShape;
    use crate::mesh::sample::block;

    /// A block of 10 mm, and a bar of 4 mm at a height, which reaches beyond it on both sides.
    fn bar_on_block(height: f64) -> TriangleSurface {
        let surface = |size: [f64; 3]| {
            let mesh = block(Vector::from(size), [1, 1, 1], CellShape::Hex8);
            mesh.surface_of(&mesh.boundary_faces())
        };
        let (mut both, bar) = (surface([10.0, 10.0, 10.0]), surface([4.0, 20.0, 4.0]));
        let first = both.points.len() as u32;
        let corner = Vector::new(3.0, -5.0, height);
        both.points.extend(bar.points.iter().map(|point| point + corner));
        both.triangles.extend(bar.triangles.iter().map(|own| own.map(|point| point + first)));
        both
    }

    fn told(height: f64) -> Option<Warning> {
        let surface = bar_on_block(10.5);
        let skin = Skin { surface, regions: Default::default(), off: Default::default() };
        skin_overlap(&skin, &bar_on_block(height))
    }

    #[test]
    fn edges_that_pass_through_skin_are_as_deep_as_what_they_pass_through_faces_them() {
        let warning = told(9.7).unwrap();
        let number = |name: &str| warning.numbers.iter().find(|(own, _)| *own == name).unwrap().1;
        assert!((number("depth_mm") - 0.3).abs() < 1e-12 && number("area_mm2") == 0.0);
        assert!((9.7..=10.0).contains(&number("z_mm")), "{warning:?}");
        assert!(warning.detail.contains(", 0.30 mm deep, at edges only"), "{}", warning.detail);
        assert_eq!(told(10.0), None);
        assert_eq!(told(10.1), None);
    }
}
