//! Inside of a closed surface, however damaged: a tree of its triangles with the cells of its winding number.

use rayon::prelude::*;

use super::assessment::{Assessed, Assessment, assess};
use super::hollows::Hollow;
use super::mending::{MOST_OPEN, RepairedSurface, mend};
use super::surface_error::{SurfaceDomainError, SurfaceName};
use super::triangle_tree::TriangleTree;
use super::winding_cells::WindingCells;
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

/// A side of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    In,
    Out,
}

/// A surface that tells its inside.
#[derive(Clone, Debug)]
pub(super) struct Shell {
    pub(super) tree: TriangleTree,
    cells: WindingCells,
    /// Winding number above which a point is inside.
    threshold: f64,
    /// Points spread evenly over its inside.
    pub(super) inside: Vec<Vector>,
}

/// A bone or a skin as it was given, and with its hollows as part of it.
#[derive(Clone, Debug)]
pub(super) struct BoneShell {
    /// Without the walls of hollows.
    pub(super) solid: Shell,
    /// With them; none where there are no hollows.
    hollow: Option<Shell>,
    /// The largest first.
    pub(super) hollows: Vec<Hollow>,
}

impl BoneShell {
    pub(super) fn new(
        surface: &TriangleSurface,
        name: SurfaceName,
    ) -> Result<(BoneShell, Assessment), SurfaceDomainError> {
        let (given, assessment, mended) = Shell::assessed(surface, name)?;
        let hollows = mended.hollows.list;
        if hollows.is_empty() {
            return Ok((BoneShell { solid: given, hollow: None, hollows }, assessment));
        }
        let is_wall = |n: &usize| mended.hollows.walls.binary_search(n).is_ok();
        let facets = mended.facets.iter().enumerate().filter(|(n, _)| !is_wall(n));
        let tree = TriangleTree::new(facets.map(|(_, facet)| *facet).collect());
        let cells = WindingCells::new(&tree);
        let (threshold, inside) = (given.threshold, given.inside.clone());
        let solid = Shell { tree, cells, threshold, inside };
        let bone = BoneShell { solid, hollow: Some(given), hollows };
        Ok((bone, assessment))
    }

    /// How much of what it goes around its largest hollow is.
    pub(super) fn hollow_share(&self, found: &Assessment) -> f64 {
        let hollow = self.hollows.first().map_or(0.0, |hollow| hollow.volume);
        hollow / (hollow + found.volume)
    }

    /// With the walls of its hollows.
    pub(super) fn as_given(&self) -> &Shell {
        self.hollow.as_ref().unwrap_or(&self.solid)
    }
}

impl Shell {
    pub(super) fn new(
        surface: &TriangleSurface,
        name: SurfaceName,
    ) -> Result<(Shell, Assessment), SurfaceDomainError> {
        let (shell, assessment, _) = Shell::assessed(surface, name)?;
        Ok((shell, assessment))
    }

    fn assessed(
        surface: &TriangleSurface,
        name: SurfaceName,
    ) -> Result<(Shell, Assessment, RepairedSurface), SurfaceDomainError> {
        check(surface, name)?;
        let mended = mend(surface);
        let tree = TriangleTree::new(mended.facets.clone());
        let triangles = mended.facets.len();
        if triangles == 0 {
            let triangles = surface.triangles.len();
            return Err(SurfaceDomainError::Empty { surface: name, triangles });
        }
        let open_edges = mended.open_edges;
        let cells = WindingCells::new(&tree);
        let Some(Assessed { assessment, inside }) = assess(&mended, &tree, &cells) else {
            return Err(SurfaceDomainError::NoInside { surface: name, triangles, open_edges });
        };
        refuse_uncertain_inside(&assessment, name)?;
        let threshold = 0.5 * assessment.level;
        Ok((Shell { tree, cells, threshold, inside }, assessment, mended))
    }

    /// Positive inside, at most 1 in size.
    pub(super) fn value(&self, point: &Vector) -> f64 {
        (self.cells.winding(&self.tree, point) - self.threshold).clamp(-1.0, 1.0)
    }

    /// The share of its inside for which something holds.
    pub(super) fn share(&self, holds: impl Fn(&Vector) -> bool + Sync) -> f64 {
        let count = self.inside.par_iter().filter(|point| holds(point)).count();
        count as f64 / self.inside.len().max(1) as f64
    }

    /// From a point to its nearest triangle, in mm.
    pub(super) fn distance(&self, point: &Vector) -> f64 {
        let nearest = self.tree.nearest(point, |_| true);
        nearest.map_or(f64::INFINITY, |nearest| nearest.distance)
    }

    /// On which side all of a ball lies, where that is certain: no triangle meets it, and the winding number at its centre is
    /// farther from the threshold than it can change within.
    pub(super) fn side(&self, centre: &Vector, radius: f64) -> Option<Side> {
        if self.tree.has_within(centre, radius) {
            return None;
        }
        let excess = self.cells.winding(&self.tree, centre) - self.threshold;
        let change = self.tree.winding_change(centre, radius) + INEXACT;
        (excess.abs() > change).then_some(if excess > 0.0 { Side::In } else { Side::Out })
    }

    /// Newton's steps to the threshold of the winding number, by differences, no farther than `distance`.
    pub(super) fn level_near(&self, start: &Vector, distance: f64) -> Option<Vector> {
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

/// Refuses a surface whose inside is not certain.
fn refuse_uncertain_inside(
    found: &Assessment,
    surface: SurfaceName,
) -> Result<(), SurfaceDomainError> {
    let Assessment { level, uncertain, opening, pieces, open_edges, .. } = *found;
    let percent = |share: f64| 100.0 * share;
    if level < LEAST_LEVEL {
        return Err(SurfaceDomainError::Incomplete { surface, level, open_edges });
    }
    if opening > MOST_OPEN {
        let percent = percent(opening);
        return Err(SurfaceDomainError::Open { surface, percent, open_edges });
    }
    if uncertain > MOST_UNCERTAIN {
        let percent = percent(uncertain);
        return Err(SurfaceDomainError::Uncertain { surface, percent, open_edges, pieces });
    }
    Ok(())
}

fn check(surface: &TriangleSurface, name: SurfaceName) -> Result<(), SurfaceDomainError> {
    let points = surface.points.len();
    for (triangle, corners) in surface.triangles.iter().enumerate() {
        if let Some(&point) = corners.iter().find(|&&corner| corner as usize >= points) {
            return Err(SurfaceDomainError::Corner { surface: name, triangle, point, points });
        }
    }
    let is_far = |x: &&f64| !x.is_finite() || x.abs() > FARTHEST;
    for (point, place) in surface.points.iter().enumerate() {
        if let Some(&coordinate) = place.iter().find(is_far) {
            return Err(SurfaceDomainError::Coordinate { surface: name, point, coordinate });
        }
    }
    let (low, high) = surface.bounds();
    let size = high - low;
    let box_area = 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x);
    let times = surface.area() / box_area;
    match times > MOST_AREA {
        true => Err(SurfaceDomainError::Tangled { surface: name, times }),
        false => Ok(()),
    }
}
