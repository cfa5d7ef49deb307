//! Winding numbers from an octree of cells instead of from all triangles.
//!
//! From one place to another a winding number changes by one at each triangle that the segment between them passes, and
//! otherwise as the field of a current along the edges at which the surface does not go on (`TriangleTree::winding_change`).
//! Each cell knows the number at its centre; where few open edges are near, counting the triangles on a short
//! segment gives it anywhere in the cell, and where no triangle meets the cell either, it is that of the centre.

use rayon::prelude::*;

use super::triangle_tree::TriangleTree;
use crate::mesh::Vector;

/// Halvings of the box of a surface: 4 mm for a head.
const DEPTH: usize = 6;
/// A winding number that changes less within a cell than this counts as known there.
const STEADY: f64 = 0.03;

/// Bounds of the winding number in a ball.
#[derive(Clone, Copy, Debug)]
struct Ball {
    /// At its centre.
    winding: f64,
    /// No triangle meets it.
    is_clear: bool,
    /// Between triangles the winding number hardly changes.
    is_steady: bool,
}

#[derive(Clone, Copy, Debug)]
enum Cell {
    Whole(Ball),
    /// The number of the first of eight children; the bits of a child's place are those of its axes.
    Halved(u32),
}

/// A cell to be looked at: its number, its centre and, from the cell it is part of, a place with a known winding number.
#[derive(Clone, Copy)]
struct Waiting {
    number: usize,
    centre: Vector,
    from: Option<(Vector, f64)>,
}

/// Cells of a cube around a surface.
#[derive(Clone, Debug)]
pub(super) struct WindingCells {
    centre: Vector,
    half: f64,
    cells: Vec<Cell>,
}

impl WindingCells {
    pub(super) fn new(tree: &TriangleTree) -> WindingCells {
        let (low, high) = tree.bounds();
        let half = (high - low).max() * 0.505;
        let centre = (low + high) * 0.5;
        let mut cells = vec![Cell::Halved(0)];
        // A surface without open edges goes around nothing outside.
        let far = centre + Vector::new(4.0, 2.9, 2.3) * half;
        let from = (tree.winding_change(&centre, half) == 0.0).then_some((far, 0.0));
        let mut front = vec![Waiting { number: 0, centre, from }];
        for depth in 0..=DEPTH {
            let half = half / f64::from(1u32 << depth);
            let look = |waiting: &Waiting| ball(tree, waiting, half * 3f64.sqrt() * (1.0 + 1e-9));
            let balls: Vec<Ball> = front.par_iter().map(look).collect();
            let mut next = Vec::new();
            for (waiting, ball) in front.iter().zip(balls) {
                if depth == DEPTH || (ball.is_clear && ball.is_steady) {
                    cells[waiting.number] = Cell::Whole(ball);
                    continue;
                }
                let first = cells.len();
                cells[waiting.number] = Cell::Halved(first as u32);
                cells.resize(first + 8, Cell::Whole(ball));
                let from = ball.is_steady.then_some((waiting.centre, ball.winding));
                next.extend((0..8).map(|child| Waiting {
                    number: first + child,
                    centre: waiting.centre + offset(child) * (0.5 * half),
                    from,
                }));
            }
            front = next;
        }
        WindingCells { centre, half, cells }
    }

    /// The winding number of a surface that these are the cells of, off by some hundredths.
    pub(super) fn winding(&self, tree: &TriangleTree, point: &Vector) -> f64 {
        match self.find(point) {
            Some((ball, _)) if ball.is_clear && ball.is_steady => ball.winding,
            Some((ball, centre)) if ball.is_steady => {
                let jump = tree.jump(&centre, point);
                jump.map_or_else(|| tree.winding(point), |jump| ball.winding + jump)
            }
            Some(_) | None => tree.winding(point),
        }
    }

    /// The cell of a point and its centre.
    fn find(&self, point: &Vector) -> Option<(Ball, Vector)> {
        let mut half = self.half;
        if !(point - self.centre).iter().all(|x| x.abs() < half) {
            return None;
        }
        let mut centre = self.centre;
        let mut cell = self.cells[0];
        loop {
            match cell {
                Cell::Whole(ball) => return Some((ball, centre)),
                Cell::Halved(first) => {
                    half *= 0.5;
                    let upper = |axis: usize| usize::from(point[axis] >= centre[axis]) << axis;
                    let child = upper(0) | upper(1) | upper(2);
                    centre += offset(child) * half;
                    cell = self.cells[first as usize + child];
                }
            }
        }
    }
}

fn ball(tree: &TriangleTree, waiting: &Waiting, radius: f64) -> Ball {
    let Waiting { centre, from, .. } = waiting;
    let jumped = from.and_then(|(place, winding)| Some(winding + tree.jump(&place, centre)?));
    Ball {
        winding: jumped.unwrap_or_else(|| tree.winding(centre)),
        is_clear: !tree.has_within(centre, radius),
        is_steady: tree.winding_change(centre, radius) < STEADY,
    }
}

/// From the centre of a cell to that of a child, in half edges of the child.
fn offset(child: usize) -> Vector {
    let sign = |axis: usize| if child >> axis & 1 == 1 { 1.0 } else { -1.0 };
    Vector::new(sign(0), sign(1), sign(2))
}

#[cfg(test)]
mod tests {
    use super::super::mending::mend;
    use super::*;
    use crate::mesh::TriangleSurface;

    /// An octahedron of four levels of halved triangles on a sphere of 10 mm, where `is_open` without each 17th triangle: too many
    /// holes for lids.
    fn tree(is_open: bool) -> TriangleTree {
        let [x, y, z] = [Vector::x(), Vector::y(), Vector::z()];
        let mut faces = vec![];
        for (a, b) in [(x, y), (y, -x), (-x, -y), (-y, x)] {
            faces.extend([[a, b, z], [b, a, -z]]);
        }
        for _ in 0..4 {
            let halves = |[a, b, c]: [Vector; 3]| {
                let [ab, bc, ca] = [a + b, b + c, c + a].map(|middle| middle.normalize());
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            };
            faces = faces.into_iter().flat_map(halves).collect();
        }
        let stays = |&(n, _): &(usize, &[Vector; 3])| !is_open || n % 17 > 0;
        let kept: Vec<_> = faces.iter().enumerate().filter(stays).map(|(_, face)| face).collect();
        let points = kept.iter().copied().flatten().map(|corner| corner * 10.0).collect();
        let triangles = (0..kept.len() as u32).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
        let mended = mend(&TriangleSurface { points, triangles, node_ids: None });
        assert_eq!(mended.open_edges > 0, is_open);
        TriangleTree::new(mended.facets)
    }

    #[test]
    fn cells_and_triangles_agree_on_winding_numbers_whole_or_not() {
        for is_open in [false, true] {
            let tree = tree(is_open);
            let cells = WindingCells::new(&tree);
            for n in 0..20_000 {
                let part = |step: f64| (n as f64 * step).fract() * 24.0 - 12.0;
                let point = Vector::new(part(0.819_172_5), part(0.671_043_6), part(0.549_700_5));
                let (found, wanted) = (cells.winding(&tree, &point), tree.winding(&point));
                // Twice what may change in a cell, and dipoles.
                assert!((found - wanted).abs() < 0.1, "{is_open} {point}: {found} {wanted}");
            }
        }
    }

    #[test]
    fn the_winding_number_of_a_closed_surface_is_one_inside_and_zero_outside() {
        let tree = tree(false);
        for n in 1..2000 {
            let part = |step: f64| (n as f64 * step).fract() * 24.0 - 12.0;
            let point = Vector::new(part(0.819_172_5), part(0.671_043_6), part(0.549_700_5));
            let wanted = if point.norm() < 10.0 { 1.0 } else { 0.0 };
            if (point.norm() - 10.0).abs() > 0.1 {
                let found = tree.winding(&point);
                // What dipoles beyond two radii leave.
                assert!((found - wanted).abs() < 0.03, "{point}: {found}");
            }
        }
    }
}
