//! Triangles that fill loops in a plane, with holes where loops run the other way round.
//!
//! Holes are joined to the loop around them by bridges, and ears are cut off what remains. Only corners of the loops are
//! used, so that the surface that the loops belong to is closed. Loops of damaged surfaces may cross themselves: they are
//! filled as well, with triangles that overlap.
//! Source: O'Rourke, Computational Geometry in C, 2nd ed., 1998, section 1.4.

use robust::{Coord, orient2d};

pub(super) type Point = [f64; 2];

/// Twice the area to the left of a → b → c, of exact sign.
fn left(a: Point, b: Point, c: Point) -> f64 {
    let [a, b, c] = [a, b, c].map(|[x, y]| Coord { x, y });
    orient2d(a, b, c)
}

/// Triangles as numbers of points. Loops are numbers of points; those that run counter-clockwise are filled, those that
/// run clockwise within another are holes of the smallest such.
pub(super) fn fill(points: &[Point], loops: &[Vec<usize>]) -> Vec<[usize; 3]> {
    let areas: Vec<f64> = loops.iter().map(|corners| area(points, corners)).collect();
    let around = |hole: usize| {
        let holds = |&outer: &usize| {
            areas[outer] > 0.0 && holds(points, &loops[outer], points[loops[hole][0]])
        };
        (0..loops.len()).filter(holds).min_by(|&a, &b| areas[a].total_cmp(&areas[b]))
    };
    let mut holes_of = vec![Vec::new(); loops.len()];
    let mut filled = Vec::new();
    for hole in (0..loops.len()).filter(|&number| areas[number] <= 0.0) {
        match around(hole) {
            Some(outer) => holes_of[outer].push(hole),
            None => filled.extend(fill_reversed(points, &loops[hole])),
        }
    }
    for outer in (0..loops.len()).filter(|&number| areas[number] > 0.0) {
        let holes = holes_of[outer].iter().map(|&hole| loops[hole].clone()).collect();
        filled.extend(cut_ears(points, joined(points, loops[outer].clone(), holes)));
    }
    filled
}

fn fill_reversed(points: &[Point], corners: &[usize]) -> Vec<[usize; 3]> {
    let reversed = corners.iter().rev().copied().collect();
    cut_ears(points, reversed).into_iter().map(|[a, b, c]| [a, c, b]).collect()
}

fn sides(corners: &[usize]) -> impl Iterator<Item = (usize, usize)> + '_ {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

fn area(points: &[Point], corners: &[usize]) -> f64 {
    let Some(&first) = corners.first() else { return 0.0 };
    let [x, y] = points[first];
    let local = |point: usize| [points[point][0] - x, points[point][1] - y];
    sides(corners)
        .map(|(a, b)| {
            let [a, b] = [local(a), local(b)];
            (a[0] * b[1] - a[1] * b[0]) / 2.0
        })
        .sum()
}

fn holds(points: &[Point], corners: &[usize], [x, y]: Point) -> bool {
    let to_the_right = |&(a, b): &(usize, usize)| {
        let [a, b] = [points[a], points[b]];
        (a[1] > y) != (b[1] > y) && x < a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1])
    };
    sides(corners).filter(to_the_right).count() % 2 == 1
}

/// One loop that runs around the outer one and, over bridges, around its holes; the rightmost holes first.
fn joined(points: &[Point], mut outer: Vec<usize>, mut holes: Vec<Vec<usize>>) -> Vec<usize> {
    for hole in &mut holes {
        let rightmost = (0..hole.len())
            .max_by(|&a, &b| points[hole[a]][0].total_cmp(&points[hole[b]][0]))
            .unwrap_or(0);
        hole.rotate_left(rightmost);
    }
    holes.sort_by(|a, b| points[b[0]][0].total_cmp(&points[a[0]][0]));
    for number in 0..holes.len() {
        let at = bridge(points, &outer, &holes[number..]);
        let hole = &holes[number];
        let way: Vec<usize> =
            hole.iter().chain(&hole[..1]).chain(&outer[at..=at]).copied().collect();
        outer.splice(at + 1..at + 1, way);
    }
    outer
}

/// Where on the outer loop the bridge to the first corner of the first hole stands: the nearest corner that sees it.
fn bridge(points: &[Point], outer: &[usize], holes: &[Vec<usize>]) -> usize {
    let from = points[holes[0][0]];
    let square = |at: usize| {
        let [x, y] = points[outer[at]];
        (x - from[0]).powi(2) + (y - from[1]).powi(2)
    };
    let mut order: Vec<usize> = (0..outer.len()).collect();
    order.sort_by(|&a, &b| square(a).total_cmp(&square(b)));
    let sees = |at: &usize| {
        let corners = [
            outer[(*at + outer.len() - 1) % outer.len()],
            outer[*at],
            outer[(*at + 1) % outer.len()],
        ];
        let to = points[corners[1]];
        let blocks = |(a, b): (usize, usize)| crosses([from, to], [points[a], points[b]]);
        in_cone(corners.map(|corner| points[corner]), from)
            && !sides(outer).any(blocks)
            && !holes.iter().any(|hole| sides(hole).any(blocks))
    };
    order.iter().copied().find(sees).unwrap_or(order[0])
}

/// Whether a point is seen from the middle of three corners, between the two others on the left.
fn in_cone([before, corner, after]: [Point; 3], seen: Point) -> bool {
    if left(corner, after, before) >= 0.0 {
        left(corner, seen, before) > 0.0 && left(seen, corner, after) > 0.0
    } else {
        !(left(corner, seen, after) >= 0.0 && left(seen, corner, before) >= 0.0)
    }
}

/// Whether two segments have a point in common that is not an end of both.
fn crosses([a, b]: [Point; 2], [c, d]: [Point; 2]) -> bool {
    if [c, d].iter().any(|end| *end == a || *end == b) {
        return false;
    }
    let apart = |one: f64, other: f64| (one > 0.0 && other > 0.0) || (one < 0.0 && other < 0.0);
    !apart(left(a, b, c), left(a, b, d)) && !apart(left(c, d, a), left(c, d, b))
}

/// Ears cut off a loop until a triangle remains. Where none is an ear, the corner that is least bent is cut off.
fn cut_ears(points: &[Point], mut corners: Vec<usize>) -> Vec<[usize; 3]> {
    let mut triangles = Vec::with_capacity(corners.len());
    let mut from = 0;
    while corners.len() > 3 {
        let count = corners.len();
        let ear =
            (0..count).map(|step| (from + step) % count).find(|&at| is_ear(points, &corners, at));
        let at = ear.unwrap_or_else(|| least_bent(points, &corners));
        triangles.push(around(&corners, at));
        corners.remove(at);
        // The next corner but one: ears all around give better triangles than a fan.
        from = (at + 1) % (count - 1);
    }
    if let [a, b, c] = corners[..] {
        triangles.push([a, b, c]);
    }
    triangles
}

fn around(corners: &[usize], at: usize) -> [usize; 3] {
    let count = corners.len();
    [corners[(at + count - 1) % count], corners[at], corners[(at + 1) % count]]
}

fn is_ear(points: &[Point], corners: &[usize], at: usize) -> bool {
    let ear = around(corners, at).map(|corner| points[corner]);
    let [a, b, c] = ear;
    if left(a, b, c) <= 0.0 {
        return false;
    }
    let within = |point: Point| {
        left(a, b, point) >= 0.0 && left(b, c, point) >= 0.0 && left(c, a, point) >= 0.0
    };
    !corners.iter().map(|&corner| points[corner]).any(|p| !ear.contains(&p) && within(p))
}

/// The corner whose triangle has the smallest area.
fn least_bent(points: &[Point], corners: &[usize]) -> usize {
    let bent = |at: usize| {
        let [a, b, c] = around(corners, at).map(|corner| points[corner]);
        left(a, b, c).abs()
    };
    (0..corners.len()).min_by(|&a, &b| bent(a).total_cmp(&bent(b))).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn total(points: &[Point], triangles: &[[usize; 3]]) -> f64 {
        triangles.iter().map(|corners| area(points, corners)).sum()
    }

    #[test]
    fn a_square_with_two_holes_and_an_island_is_filled_once() {
        let square = |x: f64, y: f64, size: f64| {
            [[x, y], [x + size, y], [x + size, y + size], [x, y + size]]
        };
        let points = [
            square(0.0, 0.0, 10.0),
            square(1.0, 1.0, 3.0),
            square(6.0, 6.0, 2.0),
            square(2.0, 2.0, 1.0),
        ]
        .concat();
        let loops = [vec![0, 1, 2, 3], vec![7, 6, 5, 4], vec![11, 10, 9, 8], vec![12, 13, 14, 15]];
        let triangles = fill(&points, &loops);
        assert!(triangles.iter().all(|corners| area(&points, corners) > 0.0));
        assert!((total(&points, &triangles) - (100.0 - 9.0 - 4.0 + 1.0)).abs() < 1e-12);
        // Every side of a loop once, every other side both ways.
        let mut sides_of: Vec<(usize, usize)> = triangles.iter().flat_map(|t| sides(t)).collect();
        sides_of.sort_unstable();
        let open = sides_of.iter().filter(|(a, b)| sides_of.binary_search(&(*b, *a)).is_err());
        assert_eq!(open.count(), 16);
    }

    #[test]
    fn a_comb_is_filled_with_triangles_that_do_not_turn_over() {
        let mut points = vec![[0.0, 0.0], [21.0, 0.0]];
        for tooth in (0..10).rev() {
            let x = f64::from(tooth) * 2.0;
            points.extend([[x + 1.5, 9.0], [x + 1.0, 1.0]]);
        }
        let corners: Vec<usize> = (0..points.len()).collect();
        let triangles = fill(&points, std::slice::from_ref(&corners));
        assert_eq!(triangles.len(), points.len() - 2);
        assert!(triangles.iter().all(|t| area(&points, t) > 0.0));
        assert!((total(&points, &triangles) - area(&points, &corners)).abs() < 1e-12);
    }

    #[test]
    fn a_loop_that_crosses_itself_is_closed_all_the_same() {
        let points = [[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.5], [-1.0, 1.0]];
        let corners = vec![0, 1, 2, 3, 4];
        let triangles = fill(&points, std::slice::from_ref(&corners));
        assert_eq!(triangles.len(), 3);
        assert!((total(&points, &triangles) - area(&points, &corners)).abs() < 1e-12);
    }
}
