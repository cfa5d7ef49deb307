//! Lids on the holes of a surface that is otherwise whole, each as curved as the surface around it.
//!
//! The winding number alone closes a hole as if by a film across it, which costs a chin, and tears where both skins of
//! a thin body have a hole at one place. A lid lies on the quadric surface that fits the hole's border and what is around
//! it best (least squares of heights over the border's plane), and meets the border. It is a chain of triangles from the border to
//! its middle, so that a ragged border, whose triangles then lie upon each other, is closed as well. A border that is not round, or
//! that no quadric fits, is left to the winding number.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use nalgebra::{SMatrix, SVector};

use super::triangle::Corners;
use crate::mesh::Vector;

/// A surface with a larger part of its edges open is damaged all over and gets no lids.
const MOST_OPEN_EDGES: f64 = 0.02;
/// A border of fewer edges is closed flat: there is nothing to tell a curvature from.
const WIDE: usize = 12;
/// The area that a border goes around over that of a disc with the same mean square of distances from the middle: less is no round hole.
const LEAST_ROUNDNESS: f64 = 0.6;
/// How far beyond the border, in its radii, the surface tells how a lid is curved.
const AROUND: f64 = 1.8;
/// The cosine of the angle to a lid of what tells how it is curved: the other side of a thin body does not.
const LEAST_COSINE: f64 = 0.3;
/// Root mean square of what a quadric leaves of the heights, in radii: more is no smooth place.
const MOST_LEFT: f64 = 0.1;
/// Rings of triangles of a lid.
const MOST_RINGS: usize = 24;

/// Triangles that close holes.
#[derive(Clone, Debug, Default)]
pub(super) struct Lids {
    /// Points by number, those beyond the points of the surface being the lids' own.
    pub triangles: Vec<[u32; 3]>,
    pub corners: Vec<Corners>,
    /// Holes that they close.
    pub count: usize,
    /// Wide holes that can have none.
    pub left: usize,
}

/// A surface whose triangles agree on a side, with the edges at which one of them has no neighbour, each as that triangle goes
/// along it.
pub(super) struct Open<'a> {
    pub points: &'a [Vector],
    pub triangles: &'a [[u32; 3]],
    /// Of the triangles, on their side.
    pub corners: &'a [Corners],
    pub edges: &'a [[u32; 2]],
    /// A larger hole, in mm², is none: the surface was cut off.
    pub most_area: f64,
}

/// Lids on all holes that can have one.
pub(super) fn lids(open: &Open<'_>) -> Lids {
    let mut lids = Lids::default();
    if open.edges.is_empty()
        || open.edges.len() as f64 > MOST_OPEN_EDGES * 1.5 * open.triangles.len() as f64
    {
        return lids;
    }
    let borders = borders(open.edges);
    let neighbours = neighbours(open, &borders);
    for border in borders.into_iter().filter(|border| border.len() > 2) {
        let lid = match border.len() < WIDE {
            true => Some(Lid::flat(open, &border)),
            false => Lid::curved(open, &border, &neighbours),
        };
        match lid {
            Some(lid) => lid.add_to(open, &border, &mut lids),
            None => lids.left += 1,
        }
    }
    lids
}

/// Ways around holes along edges, none through a point twice.
fn borders(edges: &[[u32; 2]]) -> Vec<Vec<u32>> {
    let mut onwards: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for &[from, to] in edges {
        onwards.entry(from).or_default().push(to);
    }
    let mut found = Vec::new();
    while let Some((&first, _)) = onwards.first_key_value() {
        let mut path = vec![first];
        while let Some(&here) = path.last() {
            let Some(next) = onwards.get_mut(&here).and_then(Vec::pop) else {
                onwards.remove(&here);
                path.pop();
                continue;
            };
            match path.iter().position(|&earlier| earlier == next) {
                Some(earlier) => {
                    let mut border = path.split_off(earlier + 1);
                    border.insert(0, next);
                    found.push(border);
                }
                None => path.push(next),
            }
        }
    }
    found
}

/// A point over an edge, and the area vector of the triangle there.
type Neighbour = (u32, Vector);

/// The neighbours of each point; none where no border is wide.
fn neighbours(open: &Open<'_>, borders: &[Vec<u32>]) -> HashMap<u32, Vec<Neighbour>> {
    let mut found: HashMap<u32, Vec<Neighbour>> = HashMap::new();
    if borders.iter().any(|border| border.len() >= WIDE) {
        for (&[a, b, c], corners) in open.triangles.iter().zip(open.corners) {
            let side = corners.area_vector();
            for (from, to) in [(a, b), (b, c), (c, a)] {
                found.entry(from).or_default().push((to, side));
                found.entry(to).or_default().push((from, side));
            }
        }
    }
    found
}

/// Where a lid lies: heights over the plane of its border.
struct Lid {
    middle: Vector,
    /// Two ways in the plane and the normal.
    axes: [Vector; 3],
    /// Root mean square of the distances of the border from the middle, in mm.
    radius: f64,
    /// Of 1, u, v, u², uv, v², in radii.
    heights: SVector<f64, 6>,
    rings: usize,
}

impl Lid {
    /// A cone to the middle.
    fn flat(open: &Open<'_>, border: &[u32]) -> Lid {
        let places: Vec<Vector> = border.iter().map(|&point| open.points[point as usize]).collect();
        let middle = places.iter().sum::<Vector>() / places.len() as f64;
        let square = places.iter().map(|place| (place - middle).norm_squared()).sum::<f64>();
        let normal = across(&places, &middle).try_normalize(0.0).unwrap_or_else(Vector::z);
        let one = normal.cross(&Vector::ith(normal.iamin(), 1.0)).normalize();
        let axes = [one, normal.cross(&one), normal];
        let radius = (square / places.len() as f64).sqrt();
        Lid { middle, axes, radius, heights: SVector::zeros(), rings: 1 }
    }

    fn curved(
        open: &Open<'_>,
        border: &[u32],
        neighbours: &HashMap<u32, Vec<Neighbour>>,
    ) -> Option<Lid> {
        let flat = Lid::flat(open, border);
        let places: Vec<Vector> = border.iter().map(|&point| open.points[point as usize]).collect();
        let area = across(&places, &flat.middle).norm();
        let disc = std::f64::consts::PI * flat.radius * flat.radius;
        if area < LEAST_ROUNDNESS * disc || area > open.most_area {
            return None;
        }
        let around = flat.around(open, border, neighbours);
        let mut matrix = SMatrix::<f64, 6, 6>::zeros();
        let mut right = SVector::<f64, 6>::zeros();
        for place in &around {
            let [u, v, height] = flat.on_axes(place);
            let terms = terms(u, v);
            matrix += terms * terms.transpose();
            right += terms * height;
        }
        let heights = matrix.cholesky()?.solve(&right);
        let squares = around.iter().map(|place| {
            let [u, v, height] = flat.on_axes(place);
            (height - terms(u, v).dot(&heights)).powi(2)
        });
        let left = (squares.sum::<f64>() / around.len() as f64).sqrt();
        let ends = places.iter().zip(places.iter().cycle().skip(1));
        let edge = ends.map(|(a, b)| (b - a).norm()).sum::<f64>() / places.len() as f64;
        let rings = ((flat.radius / edge).round() as usize).clamp(1, MOST_RINGS);
        (left <= MOST_LEFT).then_some(Lid { heights, rings, ..flat })
    }

    /// Places of the border and of the surface about it, over edges.
    fn around(
        &self,
        open: &Open<'_>,
        border: &[u32],
        neighbours: &HashMap<u32, Vec<Neighbour>>,
    ) -> Vec<Vector> {
        let place = |point: u32| open.points[point as usize];
        let mut seen: BTreeSet<u32> = border.iter().copied().collect();
        let mut waiting = border.to_vec();
        while let Some(here) = waiting.pop() {
            for &(there, side) in neighbours.get(&here).into_iter().flatten() {
                let is_near = (place(there) - self.middle).norm() < AROUND * self.radius;
                // A border goes around the back of what it bounds.
                let looks_along = -side.dot(&self.axes[2]) > LEAST_COSINE * side.norm();
                if is_near && looks_along && seen.insert(there) {
                    waiting.push(there);
                }
            }
        }
        seen.into_iter().map(place).collect()
    }

    /// In radii.
    fn on_axes(&self, place: &Vector) -> [f64; 3] {
        self.axes.map(|axis| axis.dot(&(place - self.middle)) / self.radius)
    }

    /// The place of the lid on the way from the middle to a place of the border.
    fn place(&self, border: &Vector, part: f64) -> Vector {
        let [u, v, height] = self.on_axes(border);
        let own = |u: f64, v: f64| terms(u, v).dot(&self.heights);
        let height = own(part * u, part * v) + part * part * (height - own(u, v));
        let [along, beside, up] = self.axes;
        self.middle + (along * (part * u) + beside * (part * v) + up * height) * self.radius
    }

    fn add_to(&self, open: &Open<'_>, border: &[u32], lids: &mut Lids) {
        lids.count += 1;
        // Of no more points than triangles.
        let mut next = open.points.len() as u32 + lids.triangles.len() as u32;
        let mut outer: Vec<(u32, Vector)> =
            border.iter().map(|&point| (point, open.points[point as usize])).collect();
        let rim: Vec<Vector> = outer.iter().map(|&(_, place)| place).collect();
        let mut own = |place: Vector| {
            next += 1;
            (next - 1, place)
        };
        let mut add = |three: [(u32, Vector); 3]| {
            lids.triangles.push(three.map(|(point, _)| point));
            lids.corners.push(Corners(three.map(|(_, place)| place)));
        };
        for ring in 1..self.rings {
            let part = 1.0 - ring as f64 / self.rings as f64;
            let inner: Vec<(u32, Vector)> =
                rim.iter().map(|place| own(self.place(place, part))).collect();
            for n in 0..outer.len() {
                let beside = (n + 1) % outer.len();
                add([outer[beside], outer[n], inner[n]]);
                add([outer[beside], inner[n], inner[beside]]);
            }
            outer = inner;
        }
        let middle = own(self.place(&self.middle, 0.0));
        for n in 0..outer.len() {
            add([outer[(n + 1) % outer.len()], outer[n], middle]);
        }
    }
}

/// The area vector of a way around a middle.
fn across(places: &[Vector], middle: &Vector) -> Vector {
    let pairs = places.iter().zip(places.iter().cycle().skip(1));
    pairs.map(|(a, b)| (a - middle).cross(&(b - middle)) * 0.5).sum()
}

fn terms(u: f64, v: f64) -> SVector<f64, 6> {
    SVector::from([1.0, u, v, u * u, u * v, v * v])
}
