//! Straight pieces of the lines of a muscle, and those near each cell of a mesh: cells are halved by their places until few are
//! left, each half with the pieces that may be the nearest to a place in it.

use rayon::prelude::*;

use crate::mesh::ball::Ball;
use crate::mesh::{Vector, VolumeMesh, bounds_of};

/// So many cells have their pieces in common.
const FEW: usize = 4;

/// Pieces farther than the nearest by less than this share of the reach may be as near as it, to rounding.
const MARGIN: f64 = 1e-4;

/// A straight piece of a line: its start, the way to its end, and the box around all that is within its reach.
pub(super) struct Piece {
    pub from: Vector,
    pub along: Vector,
    pub reach: [Vector; 2],
}

impl Piece {
    pub(super) fn new(from: Vector, to: Vector, within: f64) -> Self {
        let margin = Vector::repeat(within);
        Piece { from, along: to - from, reach: [from.inf(&to) - margin, from.sup(&to) + margin] }
    }

    pub(super) fn squared_distance(&self, place: &Vector) -> f64 {
        let share = (place - self.from).dot(&self.along) / self.along.norm_squared();
        let foot = self.from + self.along * share.clamp(0.0, 1.0);
        (place - foot).norm_squared()
    }
}

/// A search for the cells that pieces reach.
pub(super) struct Search<F> {
    pub within: f64,
    /// What is made of a cell with the pieces near it.
    pub made: F,
}

impl<T: Send, F: Fn(usize, &[&Piece]) -> Option<T> + Sync> Search<F> {
    /// What is made of those of some cells of a mesh that pieces may reach, in no order.
    pub(super) fn run(&self, mesh: &VolumeMesh, cells: &[u32], pieces: &[Piece]) -> Vec<T> {
        let of = cells.par_iter().map(|&cell| (cell, Ball::of(mesh, cell as usize)));
        let mut cells: Vec<(u32, Ball)> = of.collect();
        let pieces: Vec<&Piece> = pieces.iter().collect();
        self.halved(&mut cells, &pieces)
    }

    fn halved(&self, cells: &mut [(u32, Ball)], pieces: &[&Piece]) -> Vec<T> {
        let Some([low, high]) = bounds_of(cells.iter().map(|(_, ball)| &ball.middle)) else {
            return Vec::new();
        };
        let middle = (low + high) / 2.0;
        let reaches = cells.iter().map(|(_, ball)| (ball.middle - middle).norm() + ball.radius());
        let near = self.near(pieces, &middle, reaches.fold(0.0, f64::max));
        if near.is_empty() {
            return Vec::new();
        }
        if cells.len() <= FEW {
            let made = cells.iter().filter_map(|(cell, _)| (self.made)(*cell as usize, &near));
            return made.collect();
        }
        let (axis, half) = ((high - low).imax(), cells.len() / 2);
        let order = |(a, x): &(u32, Ball), (b, y): &(u32, Ball)| {
            x.middle[axis].total_cmp(&y.middle[axis]).then(a.cmp(b))
        };
        cells.select_nth_unstable_by(half, order);
        let (one, other) = cells.split_at_mut(half);
        let (mut made, more) =
            rayon::join(|| self.halved(one, &near), || self.halved(other, &near));
        made.extend(more);
        made
    }

    /// The pieces that may be the nearest to a place in a ball, in their order.
    fn near<'a>(&self, pieces: &[&'a Piece], middle: &Vector, radius: f64) -> Vec<&'a Piece> {
        let distance = |piece: &&Piece| piece.squared_distance(middle).sqrt();
        let distances: Vec<f64> = pieces.iter().map(distance).collect();
        let nearest = distances.iter().copied().fold(f64::INFINITY, f64::min);
        let farthest = (nearest + radius).min(self.within) + radius + MARGIN * self.within;
        let of = pieces.iter().zip(distances).filter(|(_, distance)| *distance <= farthest);
        of.map(|(piece, _)| *piece).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::CellShape;
    use crate::mesh::sample::block;

    #[test]
    fn a_cell_has_the_nearest_piece_of_each_of_its_corners_and_far_ones_are_left_out() {
        let mesh = block(Vector::repeat(30.0), [20; 3], CellShape::Hex8);
        let place = |k: usize| [0.819, 0.671, 0.549].map(|step| (k as f64 * step).fract() * 30.0);
        let places: Vec<Vector> = (1..=41).map(|k| Vector::from(place(k))).collect();
        let within = 12.0;
        let pieces: Vec<Piece> =
            places.windows(2).map(|pair| Piece::new(pair[0], pair[1], within)).collect();
        let from = |near: &[&Piece], x: &Vector| {
            let squared = near.iter().map(|piece| piece.squared_distance(x));
            squared.fold(within * within, f64::min)
        };
        let all: Vec<&Piece> = pieces.iter().collect();
        let made = |cell: usize, near: &[&Piece]| {
            for x in mesh.corners(cell) {
                assert_eq!(from(near, &x), from(&all, &x), "{cell} {x}");
            }
            Some((cell, near.len()))
        };
        let cells: Vec<u32> = (0..8000).collect();
        let mut found = Search { within, made }.run(&mesh, &cells, &pieces);
        found.sort_unstable();
        let missed = (0..8000).filter(|cell| !found.iter().any(|(own, _)| own == cell));
        let is_reached = |cell: usize| mesh.corners(cell).any(|x| from(&all, &x) < 144.0);
        assert!(!missed.into_iter().any(is_reached));
        let looked: usize = found.iter().map(|(_, near)| near).sum();
        assert!(looked < 8000 * 40 / 2, "{looked} of {}", 8000 * 40);
    }
}
