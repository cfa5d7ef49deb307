//! Bounding volume hierarchy of triangles for distances, winding numbers and line intersections.
//!
//! Winding numbers are those of Jacobson, Kavan, Sorkine-Hornung, Robust inside-outside segmentation using generalized
//! winding numbers, ACM Transactions on Graphics 32 (2013): the solid angle of all triangles over 4 pi, 1 inside and 0
//! outside a closed surface with outward normals. Triangles farther than twice the radius of their box count as `dipoles` do.
//! Solid angles: Van Oosterom, Strackee, IEEE Transactions on Biomedical Engineering 30 (1983) 125-126.

use std::f64::consts::PI;

use super::dipoles::Dipoles;
use super::node_stack::Stack;
use super::triangle::{Corners, Passage, SolidAngles};
use crate::mesh::Vector;

/// Triangles in a leaf.
const LEAF: usize = 4;
/// How many radii away a box counts by its dipoles; also as one length of open edges.
const FAR: f64 = 2.0;

/// A triangle with what the tree needs of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    pub corners: Corners,
    /// The number the caller knows it by.
    pub number: u32,
    /// For each edge, from corner i to the next, its length in mm where the surface does not go on, otherwise 0.
    pub open: [f64; 3],
}

impl Facet {
    fn bounds(&self) -> Bounds {
        Bounds::of(&self.corners)
    }

    fn has_border_at(&self, place: &Vector) -> bool {
        let Corners(corners) = self.corners;
        (0..3).any(|edge| {
            let (from, to) = (corners[edge], corners[(edge + 1) % 3]);
            let height = (to - from).cross(&(place - from)).norm() / (to - from).norm();
            self.open[edge] > 0.0 && height <= 1e-9 * self.open[edge]
        })
    }
}

/// A place on a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    pub point: Vector,
    pub distance: f64,
    pub number: u32,
    /// It lies on an edge at which the surface does not go on.
    pub is_at_border: bool,
}

/// Where a segment meets a triangle: a part of its way from 0 to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hit {
    pub part: f64,
    pub number: u32,
}

#[derive(Clone, Copy, Debug)]
struct Bounds {
    low: Vector,
    high: Vector,
}

impl Bounds {
    const EMPTY: Bounds = Bounds {
        low: Vector::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
        high: Vector::new(f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY),
    };

    fn with(self, other: &Bounds) -> Bounds {
        Bounds { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }

    fn of(corners: &Corners) -> Bounds {
        let [a, b, c] = corners.0;
        Bounds { low: a.inf(&b).inf(&c), high: a.sup(&b).sup(&c) }
    }

    fn square_distance(&self, point: &Vector) -> f64 {
        let below = self.low - point;
        let above = point - self.high;
        let one = |axis: usize| below[axis].max(above[axis]).max(0.0);
        one(0) * one(0) + one(1) * one(1) + one(2) * one(2)
    }

    /// Whether any of a segment lies in the box.
    fn meets(&self, Segment { start, inverse, .. }: &Segment) -> bool {
        let (mut from, mut to) = (0.0f64, 1.0f64);
        for axis in 0..3 {
            let one = (self.low[axis] - start[axis]) * inverse[axis];
            let other = (self.high[axis] - start[axis]) * inverse[axis];
            // 0 * inf is no number, which min and max pass over.
            from = from.max(one.min(other));
            to = to.min(one.max(other));
        }
        from <= to
    }
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Bounds,
    /// Facets of a leaf, or of everything below.
    first: u32,
    count: u32,
    /// The second child of a branch, the first follows it; 0 for a leaf.
    second: u32,
    /// Middle of the area, and the radius about it.
    middle: Vector,
    radius: f64,
    dipoles: Dipoles,
    open_length: f64,
}

/// The tree of one surface.
#[derive(Clone, Debug)]
pub(super) struct TriangleTree {
    nodes: Vec<Node>,
    facets: Vec<Facet>,
}

impl TriangleTree {
    /// Over triangles with finite corners; without any, everything is infinitely far and nothing is around.
    pub(super) fn new(facets: Vec<Facet>) -> TriangleTree {
        let mut tree = TriangleTree { nodes: Vec::new(), facets };
        let all = tree.facets.len();
        if all > 0 {
            tree.build(0, all);
        }
        tree
    }

    fn build(&mut self, first: usize, count: usize) {
        let number = self.nodes.len();
        let facets = &mut self.facets[first..first + count];
        self.nodes.push(node(facets, first));
        if count <= LEAF {
            return;
        }
        let middles = facets.iter().map(|facet| facet.corners.middle());
        let as_bounds = |point: Vector| Bounds { low: point, high: point };
        let spread = middles.map(as_bounds).fold(Bounds::EMPTY, |all, one| all.with(&one));
        let axis = (spread.high - spread.low).imax();
        let half = count / 2;
        // Ties by number, so that the tree is the same whatever the order was.
        facets.select_nth_unstable_by(half, |a, b| {
            let (x, y) = (a.corners.middle()[axis], b.corners.middle()[axis]);
            x.total_cmp(&y).then(a.number.cmp(&b.number))
        });
        self.build(first, half);
        self.nodes[number].second = self.nodes.len() as u32;
        self.build(first + half, count - half);
    }

    /// The lowest and the highest corner; the lowest above the highest without triangles.
    pub(super) fn bounds(&self) -> (Vector, Vector) {
        let all = self.nodes.first().map_or(Bounds::EMPTY, |root| root.bounds);
        (all.low, all.high)
    }

    pub(super) fn facets(&self) -> &[Facet] {
        &self.facets
    }

    /// The nearest place on a triangle that `counts`.
    pub(super) fn nearest(&self, point: &Vector, counts: impl Fn(u32) -> bool) -> Option<Nearest> {
        self.nearest_within(point, f64::INFINITY, counts)
    }

    /// The same if it is less than `limit` mm away; the smaller the limit, the less is searched.
    pub(super) fn nearest_within(
        &self,
        point: &Vector,
        limit: f64,
        counts: impl Fn(u32) -> bool,
    ) -> Option<Nearest> {
        let mut best = limit * limit;
        let mut found = None;
        let mut stack = Stack::new(self.nodes.len());
        while let Some(number) = stack.pop() {
            let node = &self.nodes[number];
            // A square that is no number is not less either.
            if node.bounds.square_distance(point) < best {
                if node.second != 0 {
                    self.push_nearer_last(&mut stack, number, point);
                    continue;
                }
                for facet in self.leaf(node).iter().filter(|facet| counts(facet.number)) {
                    let place = facet.corners.closest(point);
                    let square = (place - point).norm_squared();
                    if square < best {
                        (best, found) = (square, Some((place, facet)));
                    }
                }
            }
        }
        found.map(|(point, facet)| Nearest {
            point,
            distance: best.sqrt(),
            number: facet.number,
            is_at_border: facet.has_border_at(&point),
        })
    }

    fn push_nearer_last(&self, stack: &mut Stack, number: usize, point: &Vector) {
        let second = self.nodes[number].second as usize;
        let distance = |node: usize| self.nodes[node].bounds.square_distance(point);
        let [nearer, farther] = match distance(second) < distance(number + 1) {
            true => [second, number + 1],
            false => [number + 1, second],
        };
        stack.push(farther);
        stack.push(nearer);
    }

    /// Whether any place is less than `radius` mm away.
    pub(super) fn has_within(&self, point: &Vector, radius: f64) -> bool {
        let square = radius * radius;
        let off = |facet: &Facet| facet.corners.closest(point) - point;
        let is_near = |facet: &Facet| off(facet).norm_squared() < square;
        let mut stack = Stack::new(self.nodes.len());
        while let Some(number) = stack.pop() {
            let node = &self.nodes[number];
            if node.bounds.square_distance(point) < square {
                if node.second != 0 {
                    self.push_nearer_last(&mut stack, number, point);
                } else if self.leaf(node).iter().any(is_near) {
                    return true;
                }
            }
        }
        false
    }

    fn leaf(&self, node: &Node) -> &[Facet] {
        &self.facets[node.first as usize..][..node.count as usize]
    }

    /// How often the surface goes around a point; 0 for a point that is not finite.
    pub(super) fn winding(&self, point: &Vector) -> f64 {
        let mut far = 0.0;
        let mut near = SolidAngles::default();
        let mut stack = Stack::new(self.nodes.len());
        while let Some(number) = stack.pop() {
            let node = &self.nodes[number];
            let way = node.middle - point;
            if way.norm_squared() > FAR * FAR * node.radius * node.radius {
                far += node.dipoles.solid_angle(&way);
            } else if node.second != 0 {
                stack.push(node.second as usize);
                stack.push(number + 1);
            } else {
                self.leaf(node).iter().for_each(|facet| near.add(&facet.corners, point));
            }
        }
        let winding = far / (4.0 * PI) + near.winding();
        if winding.is_finite() { winding } else { 0.0 }
    }

    /// A bound of how much the winding number changes in a ball that holds no triangle.
    ///
    /// There its gradient is that of the field of a current along the edges at which the surface does not go on
    /// (Biot-Savart): at most the sum of their lengths over 4 pi times the squares of their distances.
    pub(super) fn winding_change(&self, centre: &Vector, radius: f64) -> f64 {
        let mut slope = 0.0;
        let mut stack = Stack::new(self.nodes.len());
        while let Some(number) = stack.pop() {
            let node = &self.nodes[number];
            if node.open_length == 0.0 {
                continue;
            }
            let clear = node.bounds.square_distance(centre).sqrt() - radius;
            let is_far = clear > FAR * node.radius;
            if !is_far && node.second != 0 {
                stack.push(node.second as usize);
                stack.push(number + 1);
                continue;
            }
            let length =
                if clear > 0.0 { node.open_length / (clear * clear) } else { f64::INFINITY };
            slope += length;
            if slope == f64::INFINITY {
                break;
            }
        }
        radius * slope / (4.0 * PI)
    }

    /// By how much more the surface goes around the end of a segment than around its start, as far as triangles on the way
    /// tell; `None` where that is not certain.
    pub(super) fn jump(&self, start: &Vector, end: &Vector) -> Option<f64> {
        let segment = Segment::new(start, end);
        let mut jump = 0.0;
        for facet in self.along(segment) {
            match facet.corners.passage(start, &segment.way) {
                Passage::Beside => {}
                Passage::Through(more) => jump += more,
                Passage::Doubtful => return None,
            }
        }
        Some(jump)
    }

    /// Where a segment meets triangles.
    pub(super) fn hits(&self, start: &Vector, end: &Vector) -> impl Iterator<Item = Hit> {
        let segment = Segment::new(start, end);
        self.along(segment).filter_map(move |facet| {
            let part = facet.corners.hit(&segment.start, &segment.way)?;
            Some(Hit { part, number: facet.number })
        })
    }

    /// The facets whose boxes a segment meets.
    fn along(&self, segment: Segment) -> impl Iterator<Item = &Facet> {
        let stack = Stack::new(self.nodes.len());
        let leaves = LeavesAlong { tree: self, segment, stack };
        leaves.flatten().filter(move |facet| facet.bounds().meets(&segment))
    }
}

/// A way from a start, all of it.
#[derive(Clone, Copy)]
struct Segment {
    start: Vector,
    way: Vector,
    /// 1 / way.
    inverse: Vector,
}

impl Segment {
    fn new(start: &Vector, end: &Vector) -> Segment {
        let way = end - start;
        Segment { start: *start, way, inverse: way.map(|x| 1.0 / x) }
    }
}

/// The leaves whose boxes a segment meets.
struct LeavesAlong<'a> {
    tree: &'a TriangleTree,
    segment: Segment,
    stack: Stack,
}

impl<'a> Iterator for LeavesAlong<'a> {
    type Item = &'a [Facet];

    fn next(&mut self) -> Option<&'a [Facet]> {
        while let Some(number) = self.stack.pop() {
            let node = &self.tree.nodes[number];
            if !node.bounds.meets(&self.segment) {
                continue;
            }
            if node.second == 0 {
                return Some(self.tree.leaf(node));
            }
            self.stack.push(node.second as usize);
            self.stack.push(number + 1);
        }
        None
    }
}

fn node(facets: &[Facet], first: usize) -> Node {
    let mut bounds = Bounds::EMPTY;
    let (mut area, mut moment) = (0.0, Vector::zeros());
    let mut open_length = 0.0;
    for facet in facets {
        bounds = bounds.with(&Bounds::of(&facet.corners));
        let size = facet.corners.area_vector().norm();
        area += size;
        moment += facet.corners.middle() * size;
        open_length += facet.open.iter().sum::<f64>();
    }
    let middle = if area > 0.0 { moment / area } else { (bounds.low + bounds.high) * 0.5 };
    let dipoles = Dipoles::of(facets.iter().map(|facet| &facet.corners), &middle);
    // Of the box about the middle: its farthest corner.
    let radius = (bounds.high - middle).sup(&(middle - bounds.low)).norm();
    let (first, count) = (first as u32, facets.len() as u32);
    Node { bounds, first, count, second: 0, middle, radius, dipoles, open_length }
}
