//! The cells about one node, and where the node makes the worst of them better.

use super::boundary_set::BoundarySet;
use super::draft::{Draft, FACES};
use crate::domain::Domain;
use crate::mesh::Vector;

/// Parts of a step that are tried.
const STEPS: [f64; 3] = [1.0, 0.4, 0.16];
/// Cells whose sine is at most this above the worst have a part in the direction of ascent.
const SPREAD: f64 = 0.1;
/// A better place must be better by this.
const GAIN: f64 = 1e-4;
/// How far a node may go from the faces of the boundary at it, along their mean normal, in parts of its longest edge: where
/// all angles are above 20 degrees, and where not. Without a limit the sweeps cost a graded head .7 % of its volume.
const OFF: f64 = 0.01;
const OFF_WHERE_POOR: f64 = 0.1;
const POOR: f64 = 0.35;

/// The face that lacks a corner.
const OPPOSITE: [usize; 4] = [2, 3, 1, 0];
/// Rounds of projection onto all boundaries at a crease.
const CREASE_ROUNDS: usize = 6;
/// How far a node of a crease may be from a boundary, in parts of its longest edge.
const MEETS: f64 = 0.01;

/// How far the copies of a node go into their stars, in parts of the way to the middle.
const INWARDS: [f64; 4] = [0.1, 0.03, 0.01, 1e-3];
/// What their worst cells keep of their sine.
const HARDLY: f64 = 0.9;

/// A cell of the star by what stays when the node moves.
#[derive(Clone, Copy)]
struct StarCell {
    /// The face that lacks the node, outwards.
    face: [Vector; 3],
    /// The squares of the lengths of its sides, each from a corner to the next.
    sides: [f64; 3],
    /// One over the square of twice its area.
    inverse: f64,
    /// With the node where it is.
    sine: f64,
}

/// Where a node goes, and the boundaries on which it lies there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Move {
    pub place: Vector,
    pub boundaries: BoundarySet,
}

/// The best place so far, and the smallest sine there.
struct Best {
    worst: f64,
    place: Option<Vector>,
}

/// A node with its cells.
pub(super) struct Star<'a> {
    cells: Vec<StarCell>,
    domain: &'a dyn Domain,
    boundaries: BoundarySet,
    here: Vector,
    /// The longest edge at the node.
    reach: f64,
    /// The smallest sine of the cells.
    worst: f64,
}

impl<'a> Star<'a> {
    pub fn new(draft: &Draft, node: u32, tetrahedra: &[u32], domain: &'a dyn Domain) -> Self {
        let here = draft.nodes[node as usize];
        let cells = tetrahedra.iter().map(|&tet| {
            let nodes = &draft.tetrahedra[tet as usize];
            let own = nodes.iter().position(|&other| other == node).unwrap_or_default();
            StarCell::new(&draft.corners(nodes), own)
        });
        let mut cells: Vec<StarCell> = cells.collect();
        let edges = cells.iter().flat_map(|cell| cell.face.map(|at| (at - here).norm()));
        let reach = edges.fold(0.0, f64::max);
        let boundaries = draft.boundaries[node as usize];
        let sines = cells.iter().map(|cell| cell.sine).enumerate();
        let worst = sines.min_by(|(_, one), (_, other)| one.total_cmp(other));
        let (first, worst) = worst.unwrap_or((0, f64::INFINITY));
        // Most places are worse for the worst cell already.
        cells.swap(0, first);
        Star { cells, domain, boundaries, here, reach, worst }
    }

    /// A place for the node where the worst cell is better, if one is found.
    pub fn better(&self) -> Option<Move> {
        let mut best = Best { worst: self.worst + GAIN, place: None };
        for step in [self.to_middle(), self.ascent()] {
            for part in STEPS {
                self.attempt(step * part, &mut best);
                if best.place.is_some() {
                    break;
                }
            }
        }
        best.place.map(|place| self.move_to(place))
    }

    fn move_to(&self, place: Vector) -> Move {
        Move { place, boundaries: self.boundaries }
    }

    /// The node on its boundaries, if it may lie there with cells that are good enough or no worse.
    pub fn on_boundary(&self, fair: f64) -> Option<Move> {
        let place = self.projected(&self.here, self.boundaries)?;
        let worst = self.worst_at(&place, 0.0);
        let goes = place != self.here && worst > 0.0 && worst >= self.worst.min(fair);
        goes.then(|| self.move_to(place))
    }

    /// The node on its boundaries and on another one, where they meet, if that is within `limit` times the longest edge and
    /// cells stay better than `fair`.
    pub fn on_crease(&self, other: BoundarySet, limit: f64, fair: f64) -> Option<Move> {
        let is_near = |place: &Vector| (place - self.here).norm() < limit * self.reach;
        self.projected(&self.here, other).filter(|there| *there != self.here && is_near(there))?;
        let boundaries = self.boundaries.and(other);
        let place = self.projected(&self.here, boundaries).filter(is_near)?;
        let off = |on| (self.domain.projection(&place, on) - place).norm();
        let meets = boundaries.iter().map(off).fold(0.0, f64::max) < MEETS * self.reach;
        (meets && self.worst_at(&place, fair) >= fair).then_some(Move { place, boundaries })
    }

    /// The node moved by a way or by half of it, if cells are good enough there or no worse and the way does not lead through a
    /// gap or a sheet into what lies behind.
    pub fn moved_by(&self, way: &Vector, fair: f64) -> Option<Move> {
        let outwards = way.dot(&self.outward()) > 0.0;
        let ends = |way: &Vector| (self.domain.value(&(self.here + way * 2.0)) <= 0.0) == outwards;
        let enough = self.worst.min(fair);
        let ways = [*way, way * 0.5].into_iter();
        let good = |way: &Vector| self.worst_at(&(self.here + way), enough) >= enough && ends(way);
        ways.filter(|way| *way != Vector::zeros())
            .find(good)
            .map(|way| self.move_to(self.here + way))
    }

    /// The node at a place or on the way there, as far as cells stay good enough or no worse.
    pub fn towards(&self, place: &Vector, fair: f64) -> Option<Move> {
        let way = place - self.here;
        let enough = self.worst.min(fair);
        let is_way = way.norm() > 0.0 && way.norm() < 0.7 * self.reach;
        let places = STEPS.map(|part| self.here + way * part);
        let good = |place: &Vector| self.worst_at(place, enough) >= enough;
        places.into_iter().filter(|_| is_way).find(good).map(|place| self.move_to(place))
    }

    /// A place a little way into the star, where the worst cell is hardly worse.
    pub fn inwards(&self) -> Option<Move> {
        let way = self.to_middle();
        let places = INWARDS.map(|part| self.here + way * part);
        let good = |place: &Vector| self.worst_at(place, 0.0) > HARDLY * self.worst.min(0.5);
        let place = places.into_iter().find(good).filter(|place| *place != self.here);
        place.map(|place| self.move_to(place))
    }

    fn attempt(&self, step: Vector, best: &mut Best) {
        let mut place = self.here + step;
        if !self.boundaries.is_empty() {
            if self.worst_at(&place, best.worst) <= best.worst {
                return;
            }
            let Some(projected) = self.projected(&place, self.boundaries) else { return };
            place = projected;
            if !self.stays(&place) {
                return;
            }
        }
        let worst = self.worst_at(&place, best.worst);
        if worst > best.worst {
            *best = Best { worst, place: Some(place) };
        }
    }

    /// The nearest place on some boundaries, if it is near and finite.
    fn projected(&self, place: &Vector, boundaries: BoundarySet) -> Option<Vector> {
        let mut at = *place;
        let several = boundaries.iter().count() > 1;
        for _ in 0..if several { CREASE_ROUNDS } else { 1 } {
            at = boundaries.iter().fold(at, |at, on| self.domain.projection(&at, on));
        }
        ((at - place).norm() < 0.5 * self.reach).then_some(at)
    }

    /// The smallest sine with the node at a place, or less than `enough` if it is not above that.
    fn worst_at(&self, place: &Vector, enough: f64) -> f64 {
        let mut worst = f64::INFINITY;
        for cell in &self.cells {
            worst = worst.min(cell.sine_at(place));
            if worst < enough {
                break;
            }
        }
        worst
    }

    /// A place on the boundary is hardly off the faces there: a node that slides down from a ridge takes the ridge with it.
    fn stays(&self, place: &Vector) -> bool {
        let outward = self.outward();
        let off = (place - self.here).dot(&outward).abs();
        let limit = if self.worst < POOR { OFF_WHERE_POOR } else { OFF };
        off <= limit * self.reach * outward.norm()
    }

    /// The gradient of the volume of all cells by the place of the node, times six: outwards, nothing inside the mesh.
    fn outward(&self) -> Vector {
        let gradients = self.cells.iter().map(|cell| {
            let [a, b, c] = cell.face;
            (b - a).cross(&(c - a))
        });
        -gradients.sum::<Vector>()
    }

    /// To the mean of the other corners.
    fn to_middle(&self) -> Vector {
        let sum = self.cells.iter().map(|cell| cell.face.iter().sum::<Vector>());
        sum.sum::<Vector>() / (3.0 * self.cells.len() as f64) - self.here
    }

    /// Up the gradients of the worst cells, so far that the worst would reach 30 degrees if its sine were linear.
    fn ascent(&self) -> Vector {
        let near = self.cells.iter().filter(|cell| cell.sine < self.worst + SPREAD);
        let step = 1e-4 * self.reach;
        let gradient: Vector = near
            .map(|cell| {
                let weight = 1.0 - (cell.sine - self.worst) / SPREAD;
                let slopes = [Vector::x(), Vector::y(), Vector::z()]
                    .map(|axis| (cell.sine_at(&(self.here + axis * step)) - cell.sine) / step);
                Vector::from(slopes) * (weight * weight)
            })
            .sum();
        let slope = gradient.norm();
        if slope == 0.0 || !slope.is_finite() {
            return Vector::zeros();
        }
        let length = ((0.5 - self.worst).max(0.1) / slope).min(0.3 * self.reach);
        gradient * (length / slope)
    }
}

impl StarCell {
    fn new(corners: &[Vector; 4], own: usize) -> Self {
        let face = FACES[OPPOSITE[own]].map(|corner| corners[corner]);
        let [a, b, c] = face;
        let sides = [b - a, c - b, a - c].map(|side| side.norm_squared());
        let inverse = 1.0 / (b - a).cross(&(c - a)).norm_squared();
        let mut cell = StarCell { face, sides, inverse, sine: 0.0 };
        cell.sine = cell.sine_at(&corners[own]);
        cell
    }

    /// `worst_sine` with the node at a place.
    fn sine_at(&self, place: &Vector) -> f64 {
        let [a, b, c] = self.face.map(|corner| corner - place);
        let normals = [a.cross(&b), b.cross(&c), c.cross(&a)];
        let inverse = normals.map(|normal| 1.0 / normal.norm_squared());
        let determinant = normals[0].dot(&c);
        let edges = [a, b, c].map(|edge| edge.norm_squared());
        let at_side = |n: usize| self.sides[n] * self.inverse * inverse[n];
        let at_edge = |n: usize| edges[n] * inverse[n] * inverse[(n + 2) % 3];
        let smallest = |of: &dyn Fn(usize) -> f64| of(0).min(of(1)).min(of(2));
        let smallest = smallest(&at_side).min(smallest(&at_edge));
        // A face without area has no normal; the sine is 0 then.
        if smallest.is_finite() { determinant * smallest.sqrt() } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshing::shape::worst_sine;

    #[test]
    fn the_sine_of_a_cell_of_a_star_is_that_of_the_cell_with_its_node_moved() {
        let corners = [[0.0, 0.0, 0.0], [1.2, 0.1, 0.0], [0.3, 0.9, 0.2], [0.4, 0.2, 1.1]];
        let corners = corners.map(Vector::from);
        for own in 0..4 {
            let cell = StarCell::new(&corners, own);
            for by in [[0.0, 0.0, 0.0], [0.1, -0.2, 0.05], [3.0, -2.0, 1.0], [-2.0, 1.0, 2.0]] {
                let mut moved = corners;
                moved[own] += Vector::from(by);
                let (sine, expected) = (cell.sine_at(&moved[own]), worst_sine(&moved));
                assert!((sine - expected).abs() < 1e-14, "{own} {by:?}: {sine} {expected}");
            }
        }
    }
}
