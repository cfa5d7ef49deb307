//! Triangles of one surface that pass through each other.
//!
//! Two triangles cross where each has corners strictly on both sides of the other's plane and an edge of one passes
//! through the other. Triangles that only touch, or lie in one plane, do not; a corner or an edge that both have is
//! no crossing, what lies beyond it may be one. On which side a corner lies is decided exactly.
//! Source: Shewchuk, Adaptive precision floating-point arithmetic and fast robust geometric predicates, Discrete &
//! Computational Geometry 18 (1997), section 4.3 (orientation).

use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use rayon::prelude::*;
use robust::{Coord3D, orient3d};
use std::cmp::Ordering;

use super::bounds::parry_box;
use super::{TriangleSurface, Vector};

/// Pairs that are kept for one triangle; the others are only counted, so that memory grows with the surface.
const KEPT_FOR_A_TRIANGLE: usize = 16;

/// Triangles that one triangle is tried against. A triangle of a sound surface is near some dozens.
const TRIED_FOR_A_TRIANGLE: u64 = 4096;

/// Two triangles by their numbers, the smaller first.
pub type TrianglePair = [u32; 2];

/// Triangles of a surface that cross others of it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Crossings {
    /// At most 16 for each triangle, ascending.
    pub pairs: Vec<TrianglePair>,
    /// All of them.
    pub count: u64,
    /// Triangles that are near more than 4096 others and were not tried against all of them.
    pub untried: u64,
    /// Pairs that were tried, which is what a search takes: those whose boxes meet.
    pub tried: u64,
}

/// The crossings of one triangle with those of higher numbers.
struct OfTriangle {
    others: Vec<u32>,
    count: u64,
    tried: u64,
    is_untried: bool,
}

/// The pairs of triangles that cross, of those that count. The points have to be finite.
pub fn self_crossings(
    surface: &TriangleSurface,
    counts: impl Fn(&TrianglePair) -> bool + Sync,
) -> Crossings {
    let boxes: Vec<Aabb> = (0..surface.triangles.len()).map(|one| box_of(surface, one)).collect();
    let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
    let of_triangle = |one: usize| {
        let mut found = OfTriangle { others: Vec::new(), count: 0, tried: 0, is_untried: false };
        let near = tree.intersect_aabb(&boxes[one]).filter(|&other| other as usize > one);
        for other in near {
            if found.tried == TRIED_FOR_A_TRIANGLE {
                found.is_untried = true;
                break;
            }
            found.tried += 1;
            let pair = [one as u32, other];
            if cross(surface, &pair) && counts(&pair) {
                found.count += 1;
                found.others.push(other);
            }
        }
        found.others.sort_unstable();
        found.others.truncate(KEPT_FOR_A_TRIANGLE);
        (found.tried > 0).then_some((one as u32, found))
    };
    let numbers = (0..surface.triangles.len()).into_par_iter();
    let found: Vec<(u32, OfTriangle)> = numbers.filter_map(of_triangle).collect();
    Crossings {
        count: found.iter().map(|(_, found)| found.count).sum(),
        tried: found.iter().map(|(_, found)| found.tried).sum(),
        untried: found.iter().filter(|(_, found)| found.is_untried).count() as u64,
        pairs: found
            .iter()
            .flat_map(|(one, found)| found.others.iter().map(|other| [*one, *other]))
            .collect(),
    }
}

fn box_of(surface: &TriangleSurface, triangle: usize) -> Aabb {
    let [a, b, c] = surface.corners(triangle);
    let (low, high) = (a.inf(&b).inf(&c), a.sup(&b).sup(&c));
    parry_box([low, high])
}

/// An edge that passes through a triangle or its border.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Piercing {
    /// The points of the edge, the one in front of the triangle first.
    pub edge: [u32; 2],
    pub triangle: u32,
}

/// Whether two triangles of a surface pass through each other.
pub fn cross(surface: &TriangleSurface, pair: &TrianglePair) -> bool {
    let [one, other] = pair.map(|number| surface.triangles[number as usize]);
    if one.iter().filter(|corner| other.contains(corner)).count() > 1 {
        return false;
    }
    let points = &surface.points;
    let of_other = sides(points, &one, &other);
    if !is_on_both(&of_other) {
        return false;
    }
    let of_one = sides(points, &other, &one);
    is_on_both(&of_one)
        && (pierced(points, &other, &of_other, &one).next().is_some()
            || pierced(points, &one, &of_one, &other).next().is_some())
}

/// Where the edges of two triangles that cross pass through the other one.
pub fn piercings(surface: &TriangleSurface, &[one, other]: &TrianglePair) -> Vec<Piercing> {
    let corners = |number: u32| &surface.triangles[number as usize];
    let through = |edges_of: u32, triangle: u32| {
        let (edges_of, plane) = (corners(edges_of), corners(triangle));
        let sides = sides(&surface.points, plane, edges_of);
        let edges: Vec<[u32; 2]> = pierced(&surface.points, edges_of, &sides, plane).collect();
        edges.into_iter().map(move |edge| Piercing { edge, triangle })
    };
    through(one, other).chain(through(other, one)).collect()
}

/// Whether two triangles pass through each other by more than a length in mm: an edge of one has ends that lie that far in front
/// of the other and behind it. Surfaces that lie on each other cross by what rounding leaves.
pub fn pass(surface: &TriangleSurface, pair: &TrianglePair, by: f64) -> bool {
    piercings(surface, pair).iter().any(|piercing| {
        let [corner, _, _] = surface.corners(piercing.triangle as usize);
        let normal = surface.area_vector(piercing.triangle as usize).normalize();
        let side = |end: u32| normal.dot(&(surface.points[end as usize] - corner));
        let [front, behind] = piercing.edge.map(side);
        front > by && behind < -by
    })
}

/// On which side of a triangle's plane the corners of another lie, greater behind it; on it where they are the
/// triangle's own.
fn sides(points: &[Vector], plane: &[u32; 3], corners: &[u32; 3]) -> [Ordering; 3] {
    let [a, b, c] = plane.map(|corner| &points[corner as usize]);
    corners.map(|corner| match plane.contains(&corner) {
        true => Ordering::Equal,
        false => side([a, b, c, &points[corner as usize]]),
    })
}

/// The sign of the volume of a tetrahedron: greater where the last corner lies behind the others.
fn side(corners: [&Vector; 4]) -> Ordering {
    // What lies on one corner, or with all of them in a plane across an axis, would take exact arithmetic to be seen.
    let [first, .., last] = corners;
    let is_flat = |axis: usize| corners.iter().all(|corner| corner[axis] == first[axis]);
    if corners[..3].contains(&last) || (0..3).any(is_flat) {
        return Ordering::Equal;
    }
    let [a, b, c, d] = corners.map(|x| Coord3D { x: x.x, y: x.y, z: x.z });
    // Adding zero makes one of the two zeros.
    (orient3d(a, b, c, d) + 0.0).total_cmp(&0.0)
}

fn is_on_both(sides: &[Ordering; 3]) -> bool {
    sides.contains(&Ordering::Less) && sides.contains(&Ordering::Greater)
}

/// The edges of a triangle, whose corners lie on these sides of another, that pass through that one or its border; the
/// end in front of it first.
fn pierced<'a>(
    points: &'a [Vector],
    triangle: &'a [u32; 3],
    sides: &'a [Ordering; 3],
    other: &[u32; 3],
) -> impl Iterator<Item = [u32; 2]> + 'a {
    let [a, b, c] = other.map(|corner| &points[corner as usize]);
    let ends = (0..3).flat_map(|front| [[front, (front + 1) % 3], [front, (front + 2) % 3]]);
    ends.filter(move |[front, behind]| {
        if sides[*front] != Ordering::Less || sides[*behind] != Ordering::Greater {
            return false;
        }
        let [p, q] = [front, behind].map(|end| &points[triangle[*end] as usize]);
        let around = [side([p, q, a, b]), side([p, q, b, c]), side([p, q, c, a])];
        !is_on_both(&around)
    })
    .map(|[front, behind]| [triangle[front], triangle[behind]])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles: the unit one in the plane z = 0, and another of given corners.
    fn pair(corners: [[f64; 3]; 3]) -> TriangleSurface {
        let own = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let points = own.into_iter().chain(corners).map(Vector::from).collect();
        TriangleSurface { points, triangles: vec![[0, 1, 2], [3, 4, 5]], node_ids: None }
    }

    fn is_crossed(corners: [[f64; 3]; 3]) -> bool {
        let surface = pair(corners);
        let turned = TriangleSurface { triangles: vec![[5, 3, 4], [2, 1, 0]], ..surface.clone() };
        let found = cross(&surface, &[0, 1]);
        assert_eq!(cross(&turned, &[0, 1]), found);
        found
    }

    #[test]
    fn an_edge_through_a_triangle_crosses_it_and_one_beside_it_does_not() {
        let needle = |x: f64, y: f64| [[x, y, -1.0], [x, y, 1.0], [x + 9.0, y, 0.5]];
        assert!(is_crossed(needle(0.2, 0.2)));
        assert!(is_crossed(needle(0.5, 0.5)), "through the middle of an edge");
        assert!(!is_crossed(needle(0.6, 0.6)));
        // Past the corner by less than f64 tells apart by ordinary arithmetic.
        let just = 0.5 + f64::EPSILON;
        assert!(!is_crossed([[just, 0.5, -1.0], [just, 0.5, 1.0], [9.0, 9.0, 0.0]]));
    }

    #[test]
    fn an_edge_that_pierces_a_triangle_begins_in_front_of_it() {
        // The normal of the unit triangle is +z.
        let surface = pair([[0.2, 0.2, -1.0], [0.2, 0.2, 1.0], [9.0, 0.2, 0.5]]);
        let found = piercings(&surface, &[0, 1]);
        assert!(found.contains(&Piercing { edge: [4, 3], triangle: 0 }), "{found:?}");
        assert!(found.iter().all(|piercing| piercing.triangle == 0 || piercing.edge[0] < 3));
    }

    #[test]
    fn triangles_that_only_touch_do_not_cross() {
        // A corner on the face, an edge on the face, and the same triangle once more.
        assert!(!is_crossed([[0.2, 0.2, 0.0], [0.2, 0.2, 1.0], [0.3, 0.2, 1.0]]));
        assert!(!is_crossed([[0.1, 0.2, 0.0], [0.9, 0.7, 0.0], [0.3, 0.2, 1.0]]));
        assert!(!is_crossed([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]));
        assert!(!is_crossed([[0.1, 0.1, 0.0], [2.0, 0.1, 0.0], [0.1, 2.0, 0.0]]), "in its plane");
    }

    #[test]
    fn triangles_with_a_common_corner_cross_beyond_it_only() {
        let mut surface = pair([[0.0; 3], [0.4, 0.2, -1.0], [0.4, 0.2, 1.0]]);
        surface.triangles[1] = [0, 4, 5];
        assert!(cross(&surface, &[0, 1]));
        surface.points[4] = Vector::new(-0.4, -0.2, -1.0);
        surface.points[5] = Vector::new(-0.4, -0.2, 1.0);
        assert!(!cross(&surface, &[0, 1]));
        // Folded along a common edge, to within a hair.
        surface.points[4] = Vector::new(0.3, 0.4, 1e-300);
        surface.triangles[1] = [1, 0, 4];
        assert!(!cross(&surface, &[0, 1]));
    }

    /// Points of a sheet that is folded over a second time.
    fn wave(x: usize, y: usize) -> Vector {
        let (x, y) = (x as f64, y as f64);
        Vector::new(
            x - 3.0 * (1.3 * x).sin(),
            y + 0.3 * (0.7 * x).cos(),
            2.0 * (0.9 * x + 0.1 * y).sin(),
        )
    }

    #[test]
    fn the_tree_finds_every_pair_that_trying_all_finds() {
        const SIDE: usize = 20;
        let at = |x: usize, y: usize| (y * SIDE + x) as u32;
        let squares = (0..SIDE - 1).flat_map(|y| (0..SIDE - 1).map(move |x| (x, y)));
        let surface = TriangleSurface {
            points: (0..SIDE * SIDE).map(|point| wave(point % SIDE, point / SIDE)).collect(),
            triangles: squares
                .flat_map(|(x, y)| {
                    let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
                    [[a, b, c], [a, c, d]]
                })
                .collect(),
            node_ids: None,
        };
        let count = surface.triangles.len() as u32;
        let all = (0..count).flat_map(|one| (one + 1..count).map(move |other| [one, other]));
        let tried: Vec<TrianglePair> = all.filter(|pair| cross(&surface, pair)).collect();
        assert!(tried.len() > 50, "{}", tried.len());
        let found = self_crossings(&surface, |_| true);
        assert_eq!((found.count, &found.pairs, found.untried), (tried.len() as u64, &tried, 0));
        let some = self_crossings(&surface, |pair| pair[0] % 2 == 0);
        assert_eq!(
            some.pairs,
            found.pairs.iter().filter(|p| p[0] % 2 == 0).copied().collect::<Vec<_>>()
        );
    }
}
