//! Soft tissue between surfaces: inside a skin and outside bones, however damaged they are.
//!
//! A point is inside a surface where its winding number is above half of the surface's level (`assessment`). Lattice edges
//! meet the boundary where they hit triangles; only in holes is the place found by the winding number alone. A
//! surface that is not certain of its inside is refused by name and with its numbers.

use super::airway_map::AirwayMap;
use super::assessment::{Assessment, assess};
use super::cut_ends::cut_ends;
use super::limit::{Limit, LimitError, Limits};
use super::mending::mend;
use super::triangle_tree::{Hit, Nearest, TriangleTree};
use super::winding_cells::WindingCells;
use super::{Boundary, Coverage, Crossing, Domain, root};
use crate::mesh::{TriangleSurface, Vector};

/// Farthest coordinate of a surface, in mm: a kilometre.
const FARTHEST: f64 = 1e6;
/// A surface with more of its inside uncertain is refused.
const MOST_UNCERTAIN: f64 = 0.1;
/// Triangles of more than this many times the area of their box are refused: searches among them would not end.
const MOST_AREA: f64 = 20.0;
/// A surface of which less is left is refused.
const LEAST_LEVEL: f64 = 0.3;
/// What a winding number may be off by: dipoles, and what cells leave out.
const INEXACT: f64 = 0.08;
/// Parts of a segment that differ by less are one place.
const SAME_PLACE: f64 = 1e-9;

/// Why surfaces bound no tissue. Surfaces are named "skin" and "bone 1", "bone 2", ... in their order.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SurfaceDomainError {
    #[error(
        "{surface}: point {point} has a coordinate {coordinate}; up to 1e6 mm from the origin are possible"
    )]
    Coordinate { surface: String, point: usize, coordinate: f64 },
    #[error("{surface}: triangle {triangle} names point {point} of {points}")]
    Corner { surface: String, triangle: usize, point: u32, points: usize },
    #[error("{surface}: none of {triangles} triangles has an area")]
    Empty { surface: String, triangles: usize },
    #[error(
        "{surface}: {triangles} triangles with {open_edges} open edges enclose nothing: no winding number above 0.2"
    )]
    NoInside { surface: String, triangles: usize, open_edges: usize },
    #[error(
        "{surface}: the winding number inside is {level:.2} where a whole surface has 1: too much of it is missing or turned ({open_edges} open edges)"
    )]
    Incomplete { surface: String, level: f64, open_edges: usize },
    #[error(
        "{surface}: {percent:.0} % of the inside is uncertain, with winding numbers between 0.2 and 0.8 ({open_edges} open edges, {pieces} pieces)"
    )]
    Uncertain { surface: String, percent: f64, open_edges: usize, pieces: usize },
    #[error(
        "{surface}: its triangles have {times:.0} times the area of its box; more than 20 times is no surface of a body"
    )]
    Tangled { surface: String, times: f64 },
    #[error(transparent)]
    Limit(#[from] LimitError),
}

/// A side of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    In,
    Out,
}

/// A surface that tells its inside.
#[derive(Clone, Debug)]
struct Shell {
    tree: TriangleTree,
    cells: WindingCells,
    /// Winding number above which a point is inside.
    threshold: f64,
}

/// A skin with bones as a body to mesh.
#[derive(Clone, Debug)]
pub struct SurfaceDomain {
    skin: Shell,
    bones: Vec<Shell>,
    /// Numbers of the triangles of the skin where the scan ended, ascending.
    cut: Vec<u32>,
    airways: AirwayMap,
    limits: Limits,
    assessments: Vec<Assessment>,
}

impl SurfaceDomain {
    /// Between `skin` and `bones`, inside all of `limits`.
    pub fn new(
        skin: &TriangleSurface,
        bones: &[&TriangleSurface],
        limits: &[Limit],
    ) -> Result<SurfaceDomain, SurfaceDomainError> {
        let limits = Limits::new(limits)?;
        let (skin, of_skin) = Shell::new(skin, "skin")?;
        let mut assessments = vec![of_skin];
        let mut shells = Vec::with_capacity(bones.len());
        for (number, bone) in bones.iter().enumerate() {
            let (shell, of_bone) = Shell::new(bone, &format!("bone {}", number + 1))?;
            shells.push(shell);
            assessments.push(of_bone);
        }
        let bounds = skin.tree.bounds();
        let ends = cut_ends(skin.tree.facets(), bounds);
        let airways = AirwayMap::new(bounds, ends.faces, |point| skin.value(point) > 0.0);
        let cut = ends.triangles;
        Ok(SurfaceDomain { skin, bones: shells, cut, airways, limits, assessments })
    }

    /// What was found and mended: the skin's, then those of the bones.
    pub fn assessments(&self) -> &[Assessment] {
        &self.assessments
    }

    /// How many triangles of the skin lie on flat ends of the scan.
    pub fn cut_triangles(&self) -> usize {
        self.cut.len()
    }

    fn is_cut(&self, triangle: u32) -> bool {
        self.cut.binary_search(&triangle).is_ok()
    }

    /// What a place on a triangle of the skin bounds.
    fn boundary_of(&self, triangle: u32, place: &Vector) -> Boundary {
        match (self.is_cut(triangle), self.airways.is_airway(place)) {
            (true, _) => Boundary::Cut,
            (false, true) => Boundary::Airway,
            (false, false) => Boundary::Skin,
        }
    }

    /// All places where a segment meets triangles or leaves the limits, in their order.
    fn meetings(&self, inside: &Vector, outside: &Vector) -> Vec<(f64, Boundary)> {
        let mut hits: Vec<Hit> = Vec::new();
        self.skin.tree.hits(inside, outside, &mut hits);
        let at = |part: f64| inside + (outside - inside) * part;
        let skin = hits.iter().map(|hit| (hit.part, self.boundary_of(hit.number, &at(hit.part))));
        let mut all: Vec<(f64, Boundary)> = skin.collect();
        hits.clear();
        self.bones.iter().for_each(|bone| bone.tree.hits(inside, outside, &mut hits));
        all.extend(hits.iter().map(|hit| (hit.part, Boundary::Bone)));
        if self.limits.value(outside) <= 0.0 {
            let place = root::between(inside, outside, |point| self.limits.value(point));
            let part = (place - inside).norm() / (outside - inside).norm();
            all.extend(part.is_finite().then_some((part, Boundary::Cut)));
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        all.dedup_by(|later, earlier| later.0 - earlier.0 < SAME_PLACE);
        all
    }

    /// Where the winding number changes without a triangle: in a hole.
    fn in_hole(&self, inside: &Vector, outside: &Vector) -> Crossing {
        let point = root::between(inside, outside, |point| self.value(point));
        let boundary = if self.skin.value(outside) <= 0.0 {
            let nearest = self.skin.tree.nearest(&point, |_| true);
            nearest.map_or(Boundary::Skin, |nearest| self.boundary_of(nearest.number, &point))
        } else if self.bones.iter().any(|bone| bone.value(outside) > 0.0) {
            Boundary::Bone
        } else {
            Boundary::Cut
        };
        Crossing { point, boundary }
    }

    /// The nearest place on a boundary and the surface that it lies on.
    fn nearest(&self, point: &Vector, boundary: Boundary) -> Option<(&Shell, Nearest)> {
        let of_skin = |is_cut: bool| {
            let nearest = self.skin.tree.nearest(point, |number| self.is_cut(number) == is_cut);
            nearest.map(|nearest| (&self.skin, nearest))
        };
        match boundary {
            Boundary::Skin | Boundary::Airway => of_skin(false),
            Boundary::Cut => of_skin(true),
            Boundary::Bone => {
                let each = self.bones.iter();
                let found =
                    each.filter_map(|bone| Some((bone, bone.tree.nearest(point, |_| true)?)));
                found.min_by(|a, b| a.1.distance.total_cmp(&b.1.distance))
            }
        }
    }
}

impl Domain for SurfaceDomain {
    fn bounds(&self) -> (Vector, Vector) {
        let (low, high) = self.skin.tree.bounds();
        let margin = Vector::repeat((high - low).norm() * 1e-3);
        (low - margin, high + margin)
    }

    fn coverage(&self, centre: &Vector, radius: f64) -> Coverage {
        let cut = self.limits.value(centre);
        let skin = if cut <= -radius { Some(Side::Out) } else { self.skin.side(centre, radius) };
        if skin == Some(Side::Out) {
            return Coverage::Outside;
        }
        let mut is_free = true;
        for bone in &self.bones {
            match bone.side(centre, radius) {
                Some(Side::In) => return Coverage::Outside,
                Some(Side::Out) => {}
                None => is_free = false,
            }
        }
        match is_free && skin == Some(Side::In) && cut > radius {
            true => Coverage::Inside,
            false => Coverage::Mixed,
        }
    }

    fn value(&self, point: &Vector) -> f64 {
        let start = self.limits.value(point).clamp(-1.0, 1.0).min(self.skin.value(point));
        if start <= 0.0 {
            return start;
        }
        self.bones.iter().fold(start, |least, bone| least.min(-bone.value(point)))
    }

    fn crossing(&self, inside: &Vector, outside: &Vector) -> Crossing {
        let all = self.meetings(inside, outside);
        let at = |part: f64| inside + (outside - inside) * part;
        let found = |(part, boundary): (f64, Boundary)| Crossing { point: at(part), boundary };
        if let [only] = all[..] {
            return found(only);
        }
        let mut before = *inside;
        for (number, &meeting) in all.iter().enumerate() {
            let next = all.get(number + 1).map_or(1.0, |next| next.0);
            let beyond = at(0.5 * (meeting.0 + next));
            if self.value(&beyond) <= 0.0 {
                return found(meeting);
            }
            before = beyond;
        }
        self.in_hole(&before, outside)
    }

    fn projection(&self, point: &Vector, boundary: Boundary) -> Vector {
        let of_limits = self.limits.with_gradient(point);
        let found = self.nearest(point, boundary);
        if boundary == Boundary::Cut {
            let is_nearer = |nearest: &Nearest| of_limits.value.abs() < nearest.distance;
            if found.as_ref().is_none_or(|(_, nearest)| is_nearer(nearest)) {
                let on = point - of_limits.gradient * of_limits.value;
                return if on.iter().all(|x| x.is_finite()) { on } else { *point };
            }
        }
        let Some((shell, nearest)) = found else { return *point };
        match nearest.is_at_border {
            true => shell.level_near(point, nearest.distance).unwrap_or(*point),
            false => nearest.point,
        }
    }

    fn thickness(&self, point: &Vector) -> f64 {
        let distance = |shell: &Shell| shell.tree.nearest(point, |_| true);
        let Some(skin) = distance(&self.skin) else { return f64::INFINITY };
        let bones = self.bones.iter().filter_map(distance);
        let bone = bones.min_by(|a, b| a.distance.total_cmp(&b.distance));
        let sum = bone.map_or(f64::INFINITY, |bone| skin.distance + bone.distance);
        let nearest = bone.filter(|bone| bone.distance < skin.distance).unwrap_or(skin);
        sum.min(self.across(point, &nearest))
    }
}

impl SurfaceDomain {
    /// From the nearest place through the point to the next surface.
    fn across(&self, point: &Vector, nearest: &Nearest) -> f64 {
        let (low, high) = self.skin.tree.bounds();
        let reach = (high - low).norm();
        let Some(way) = (point - nearest.point).try_normalize(1e-9) else { return f64::INFINITY };
        let mut hits = Vec::new();
        for shell in self.bones.iter().chain([&self.skin]) {
            shell.tree.hits(point, &(point + way * reach), &mut hits);
        }
        let next = hits.iter().map(|hit| hit.part * reach).reduce(f64::min);
        next.map_or(f64::INFINITY, |next| nearest.distance + next)
    }
}

impl Shell {
    fn new(
        surface: &TriangleSurface,
        name: &str,
    ) -> Result<(Shell, Assessment), SurfaceDomainError> {
        check(surface, name)?;
        let surface_name = || name.to_owned();
        let mended = mend(surface);
        let tree = TriangleTree::new(mended.facets.clone());
        let triangles = mended.facets.len();
        if triangles == 0 {
            let triangles = surface.triangles.len();
            return Err(SurfaceDomainError::Empty { surface: surface_name(), triangles });
        }
        let open_edges = mended.open_edges;
        let cells = WindingCells::new(&tree);
        let Some(assessment) = assess(&mended, &tree, &cells) else {
            return Err(SurfaceDomainError::NoInside {
                surface: surface_name(),
                triangles,
                open_edges,
            });
        };
        let Assessment { level, uncertain, pieces, .. } = assessment;
        if level < LEAST_LEVEL {
            return Err(SurfaceDomainError::Incomplete {
                surface: surface_name(),
                level,
                open_edges,
            });
        }
        if uncertain > MOST_UNCERTAIN {
            let percent = 100.0 * uncertain;
            let surface = surface_name();
            return Err(SurfaceDomainError::Uncertain { surface, percent, open_edges, pieces });
        }
        let threshold = 0.5 * level;
        Ok((Shell { tree, cells, threshold }, assessment))
    }

    /// Positive inside, at most 1 in size.
    fn value(&self, point: &Vector) -> f64 {
        (self.cells.winding(&self.tree, point) - self.threshold).clamp(-1.0, 1.0)
    }

    /// On which side all of a ball lies, where that is certain: no triangle meets it, and the winding number at its centre is
    /// farther from the threshold than it can change within.
    fn side(&self, centre: &Vector, radius: f64) -> Option<Side> {
        if self.tree.has_within(centre, radius) {
            return None;
        }
        let excess = self.cells.winding(&self.tree, centre) - self.threshold;
        let change = self.tree.winding_change(centre, radius) + INEXACT;
        (excess.abs() > change).then_some(if excess > 0.0 { Side::In } else { Side::Out })
    }

    /// Newton's steps to the threshold of the winding number, by differences, no farther than `distance`.
    fn level_near(&self, start: &Vector, distance: f64) -> Option<Vector> {
        let step = 0.02 * distance;
        let excess = |point: &Vector| self.tree.winding(point) - self.threshold;
        let mut point = *start;
        for _ in 0..4 {
            let slope = |axis: Vector| {
                (excess(&(point + axis * step)) - excess(&(point - axis * step))) / (2.0 * step)
            };
            let gradient = Vector::new(slope(Vector::x()), slope(Vector::y()), slope(Vector::z()));
            point -= gradient * (excess(&point) / gradient.norm_squared());
        }
        let is_near = (point - start).norm() <= distance;
        (is_near && excess(&point).abs() < 0.01).then_some(point)
    }
}

fn check(surface: &TriangleSurface, name: &str) -> Result<(), SurfaceDomainError> {
    let name = || name.to_owned();
    let points = surface.points.len();
    for (triangle, corners) in surface.triangles.iter().enumerate() {
        if let Some(&point) = corners.iter().find(|&&corner| corner as usize >= points) {
            return Err(SurfaceDomainError::Corner { surface: name(), triangle, point, points });
        }
    }
    let is_far = |x: &&f64| !x.is_finite() || x.abs() > FARTHEST;
    for (point, place) in surface.points.iter().enumerate() {
        if let Some(&coordinate) = place.iter().find(is_far) {
            return Err(SurfaceDomainError::Coordinate { surface: name(), point, coordinate });
        }
    }
    let (low, high) = surface.bounds();
    let size = high - low;
    let box_area = 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x);
    let times = surface.area() / box_area;
    match times > MOST_AREA {
        true => Err(SurfaceDomainError::Tangled { surface: name(), times }),
        false => Ok(()),
    }
}
