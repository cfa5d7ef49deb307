//! Soft tissue between surfaces: inside a skin and outside bones, however damaged they are.
//!
//! A point is inside a surface where its winding number is above half of the surface's level (`assessment`). Lattice edges
//! meet the boundary where they hit triangles; only in holes is the place found by the winding number alone. A
//! surface that is not certain of its inside is refused by name and with its numbers.

use super::airway_map::AirwayMap;
use super::assessment::Assessment;
use super::containment::{Containment, contained};
use super::cut_ends::cut_ends;
use super::hollows::Hollow;
use super::limit::{Limit, Limits};
use super::shell::{BoneShell, Shell, Side};
use super::surface_error::{SurfaceDomainError, SurfaceName};
use super::triangle_tree::Nearest;
use super::{Boundary, Coverage, Crossing, Domain, root};
use crate::mesh::{TriangleSurface, Vector};

/// Parts of a segment that differ by less are one place.
const SAME_PLACE: f64 = 1e-9;

/// A surface whose sheets enclose more of its inside between them is refused.
const MOST_BETWEEN: f64 = 0.08;
/// The same of the tissue. The body goes as far as any of its sheets: where one lies within the other, that is the outer sheet, and
/// where two cross evenly, half of what lies between them more than a sheet. Half-way between the two cases this is 1 % of tissue too
/// much.
const MOST_BETWEEN_OF_TISSUE: f64 = 0.04;

/// An inner wall of a skin that encloses more of what the outer one goes around, as a share, is no airway.
const MOST_HOLLOW: f64 = 0.3;

/// What holes without a lid leave uncertain of more of the tissue is refused: the volume is to be right within as much.
const MOST_IN_HOLES: f64 = 0.01;

/// A skin with bones as a body to mesh.
#[derive(Clone, Debug)]
pub struct SurfaceDomain {
    skin: Shell,
    /// Tissue ends at them; what they enclose is none.
    bones: Vec<BoneShell>,
    /// Whether the hollows of bones are bone of theirs.
    is_solid: bool,
    /// Numbers of the triangles of the skin where the scan ended, ascending.
    cut: Vec<u32>,
    airways: AirwayMap,
    limits: Limits,
    assessments: Vec<Assessment>,
    containments: Vec<Containment>,
}

impl SurfaceDomain {
    /// Between `skin` and `bones`, inside all of `limits`.
    pub fn new(
        skin: &TriangleSurface,
        bones: &[&TriangleSurface],
        limits: &[Limit],
    ) -> Result<SurfaceDomain, SurfaceDomainError> {
        let limits = Limits::new(limits)?;
        let (skin, of_skin) = BoneShell::new(skin, SurfaceName::Skin)?;
        let (skin, walls) = (skin.as_given().clone(), skin.hollow_share(&of_skin));
        let mut assessments = vec![of_skin];
        let mut shells = Vec::with_capacity(bones.len());
        for (number, bone) in bones.iter().enumerate() {
            let (shell, of_bone) = BoneShell::new(bone, SurfaceName::Bone(number))?;
            shells.push(shell);
            assessments.push(of_bone);
        }
        let contained = contained(&skin, &shells).map_err(|error| within_walls(error, walls));
        let (containments, free) = contained?;
        refuse_open(&assessments, of_skin.volume * free)?;
        let ends = cut_ends(skin.tree.facets(), skin.tree.bounds(), of_skin.level);
        let airways = AirwayMap::new(ends.bounds, ends.faces, |point| skin.value(point) > 0.0);
        let cut = ends.triangles;
        Ok(SurfaceDomain {
            skin,
            bones: shells,
            is_solid: false,
            cut,
            airways,
            limits,
            assessments,
            containments,
        })
    }

    /// With the hollows of bones as bone of theirs, for cuts and volumes. No tissue lies in them either way.
    #[must_use]
    pub fn solid(self) -> SurfaceDomain {
        SurfaceDomain { is_solid: true, ..self }
    }

    /// Whether the hollows of bones are bone of theirs.
    pub fn is_solid(&self) -> bool {
        self.is_solid
    }

    /// The hollows of each bone, the largest first.
    pub fn hollows(&self) -> impl Iterator<Item = &[Hollow]> {
        self.bones.iter().map(|bone| &bone.hollows[..])
    }

    /// The bones, with or without their hollows.
    pub(super) fn bone_shells(&self) -> impl Iterator<Item = &Shell> {
        self.bones.iter().map(|bone| if self.is_solid { &bone.solid } else { bone.as_given() })
    }

    fn solids(&self) -> impl Iterator<Item = &Shell> {
        self.bones.iter().map(|bone| &bone.solid)
    }

    /// What was found and mended: the skin's, then those of the bones.
    pub fn assessments(&self) -> &[Assessment] {
        &self.assessments
    }

    /// How the bones lie by the skin.
    pub fn containments(&self) -> &[Containment] {
        &self.containments
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
        let at = |part: f64| inside + (outside - inside) * part;
        let hits = self.skin.tree.hits(inside, outside);
        let skin = hits.map(|hit| (hit.part, self.boundary_of(hit.number, &at(hit.part))));
        let bones = self.solids().flat_map(|bone| bone.tree.hits(inside, outside));
        let mut all: Vec<(f64, Boundary)> =
            skin.chain(bones.map(|hit| (hit.part, Boundary::Bone))).collect();
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
        } else if self.solids().any(|bone| bone.value(outside) > 0.0) {
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
                let each = self.solids();
                let found =
                    each.filter_map(|bone| Some((bone, bone.tree.nearest(point, |_| true)?)));
                found.min_by(|a, b| a.1.distance.total_cmp(&b.1.distance))
            }
        }
    }
}

/// Bone that lies outside a skin, because that has an inner wall around the bone as well as an outer one.
fn within_walls(error: SurfaceDomainError, walls: f64) -> SurfaceDomainError {
    match error {
        SurfaceDomainError::BoneOutside { .. } if walls > MOST_HOLLOW => {
            SurfaceDomainError::TwoWalls { surface: SurfaceName::Skin, percent: 100.0 * walls }
        }
        other => other,
    }
}

/// Refuses a surface whose sheets or holes leave it open where the tissue ends.
fn refuse_open(found: &[Assessment], tissue: f64) -> Result<(), SurfaceDomainError> {
    let bones = (0..found.len()).map(SurfaceName::Bone);
    for (surface, found) in std::iter::once(SurfaceName::Skin).chain(bones).zip(found) {
        let in_holes = found.in_holes * found.volume / tissue;
        if in_holes > MOST_IN_HOLES {
            let (percent, pieces, open_edges) =
                (100.0 * found.in_holes, found.pieces, found.open_edges);
            return Err(SurfaceDomainError::Uncertain { surface, percent, open_edges, pieces });
        }
        let own = found.between_sheets + found.second_sheets_differ;
        let of_tissue = found.between_sheets * found.volume / tissue;
        if own > MOST_BETWEEN || of_tissue > MOST_BETWEEN_OF_TISSUE {
            return Err(SurfaceDomainError::Doubled { surface, percent: 100.0 * own });
        }
    }
    Ok(())
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
        for bone in self.solids() {
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
        self.solids().fold(start, |least, bone| least.min(-bone.value(point)))
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
        self.thickness_below(point, f64::INFINITY)
    }

    fn thickness_below(&self, point: &Vector, limit: f64) -> f64 {
        let nearest = |shell: &Shell| shell.tree.nearest_within(point, limit, |_| true);
        let skin = nearest(&self.skin);
        let bone = self.solids().filter_map(nearest);
        let bone = bone.min_by(|a, b| a.distance.total_cmp(&b.distance));
        let distance = |found: Option<Nearest>| found.map_or(f64::INFINITY, |found| found.distance);
        let nearest = if distance(bone) < distance(skin) { bone } else { skin };
        let across = nearest.map_or(f64::INFINITY, |nearest| self.across(point, &nearest, limit));
        across.min(distance(skin) + distance(bone))
    }
}

impl SurfaceDomain {
    /// From the nearest place through the point to the next surface, if that is less than a limit.
    fn across(&self, point: &Vector, nearest: &Nearest, limit: f64) -> f64 {
        let (low, high) = self.skin.tree.bounds();
        let reach = (high - low).norm().min(limit - nearest.distance);
        let Some(way) = (point - nearest.point).try_normalize(1e-9) else { return f64::INFINITY };
        let end = point + way * reach;
        let shells = self.solids().chain([&self.skin]);
        let hits = shells.flat_map(|shell| shell.tree.hits(point, &end));
        let next = hits.map(|hit| hit.part * reach).reduce(f64::min);
        next.map_or(f64::INFINITY, |next| nearest.distance + next)
    }
}
