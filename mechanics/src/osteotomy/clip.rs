//! Closed triangle surfaces parted by a plane, with a cap on either side that fills what was cut.
//!
//! What lies exactly on the plane counts as below it, so that no corner is on neither side. Both caps have the same
//! triangles: the volumes of the two parts are that of the whole up to rounding.

use std::collections::{BTreeMap, HashMap};

use super::cap::{Point, fill};
use super::cut::{Plane, Side};
use crate::mesh::{TriangleSurface, Vector};

/// Why a surface cannot be parted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ClipError {
    #[error("{edges} edges of the surface have no triangle on their other side: it is not closed")]
    Open { edges: usize },
    #[error("triangle {triangle} names point {point} of {points}")]
    NoSuchPoint { triangle: usize, point: u32, points: usize },
    #[error("point {point} is no number")]
    NotFinite { point: usize },
}

/// A surface parted by a plane; both parts are closed.
#[derive(Clone, Debug, PartialEq)]
pub struct Halves {
    pub below: TriangleSurface,
    pub above: TriangleSurface,
    /// The area of either cap in mm².
    pub cut_area_mm2: f64,
}

/// Parts a closed surface. Points at the same place count as one.
pub fn split(surface: &TriangleSurface, plane: &Plane) -> Result<Halves, ClipError> {
    let welded = welded(surface)?;
    check_closed(&welded)?;
    let mut parts = DividedSurface::new(&welded, plane);
    for &triangle in &welded.triangles {
        parts.add(triangle);
    }
    let cap = parts.cap();
    let cut_area_mm2 = cap.iter().map(|corners| parts.area(corners)).sum();
    parts.below.extend(&cap);
    parts.above.extend(cap.iter().map(|[a, b, c]| [*a, *c, *b]));
    Ok(Halves {
        below: used(&parts.points, &parts.below),
        above: used(&parts.points, &parts.above),
        cut_area_mm2,
    })
}

/// A surface whose points are the places of its triangles, each once; triangles that are lines are left out.
pub(super) fn welded(surface: &TriangleSurface) -> Result<TriangleSurface, ClipError> {
    let points = surface.points.len();
    for (triangle, corners) in surface.triangles.iter().enumerate() {
        if let Some(&point) = corners.iter().find(|point| **point as usize >= points) {
            return Err(ClipError::NoSuchPoint { triangle, point, points });
        }
    }
    if let Some(point) = surface.points.iter().position(|x| !x.iter().all(|x| x.is_finite())) {
        return Err(ClipError::NotFinite { point });
    }
    Ok(used(&surface.points, &surface.triangles))
}

/// The triangles with the places that they use, each once.
fn used(points: &[Vector], triangles: &[[u32; 3]]) -> TriangleSurface {
    let mut numbers: HashMap<[u64; 3], u32> = HashMap::new();
    let mut kept = TriangleSurface::default();
    for corners in triangles {
        let corners = corners.map(|corner| {
            let place = points[corner as usize];
            // Zero has two signs and is one place.
            let key = [0, 1, 2].map(|axis| (place[axis] + 0.0).to_bits());
            *numbers.entry(key).or_insert_with(|| {
                kept.points.push(place);
                kept.points.len() as u32 - 1
            })
        });
        let [a, b, c] = corners;
        if a != b && b != c && c != a {
            kept.triangles.push(corners);
        }
    }
    kept
}

/// Refuses a surface with an edge that is not run through as often one way as the other.
fn check_closed(surface: &TriangleSurface) -> Result<(), ClipError> {
    let mut balance: HashMap<[u32; 2], i32> = HashMap::new();
    for [a, b, c] in &surface.triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *balance.entry([*from.min(to), *from.max(to)]).or_default() +=
                if from < to { 1 } else { -1 };
        }
    }
    match balance.values().filter(|balance| **balance != 0).count() {
        0 => Ok(()),
        edges => Err(ClipError::Open { edges }),
    }
}

struct DividedSurface<'a> {
    plane: &'a Plane,
    points: Vec<Vector>,
    heights: Vec<f64>,
    /// For each edge that the plane crosses, its lower end first, the point where it does.
    crossings: HashMap<[u32; 2], u32>,
    below: Vec<[u32; 3]>,
    above: Vec<[u32; 3]>,
    /// Sides of the cap of the part below, from one crossing to the next.
    rim: BTreeMap<u32, Vec<u32>>,
}

impl<'a> DividedSurface<'a> {
    fn new(surface: &TriangleSurface, plane: &'a Plane) -> Self {
        DividedSurface {
            plane,
            heights: surface.points.iter().map(|point| plane.height(point)).collect(),
            points: surface.points.clone(),
            crossings: HashMap::new(),
            below: Vec::new(),
            above: Vec::new(),
            rim: BTreeMap::new(),
        }
    }

    fn side(&self, point: u32) -> Side {
        if self.heights[point as usize] > 0.0 { Side::Above } else { Side::Below }
    }

    fn add(&mut self, triangle: [u32; 3]) {
        let sides = triangle.map(|corner| self.side(corner));
        let lone = (0..3).find(|&corner| {
            sides[corner] != sides[(corner + 1) % 3] && sides[corner] != sides[(corner + 2) % 3]
        });
        let Some(lone) = lone else {
            self.part(sides[0]).push(triangle);
            return;
        };
        let [a, b, c] = [0, 1, 2].map(|step| triangle[(lone + step) % 3]);
        let [p, q] = [self.crossing(a, b), self.crossing(a, c)];
        let rest = sides[(lone + 1) % 3];
        self.part(sides[lone]).push([a, p, q]);
        self.part(rest).extend([[p, b, c], [p, c, q]]);
        let (from, to) = match sides[lone] {
            Side::Above => (p, q),
            Side::Below => (q, p),
        };
        self.rim.entry(from).or_default().push(to);
    }

    fn part(&mut self, side: Side) -> &mut Vec<[u32; 3]> {
        match side {
            Side::Below => &mut self.below,
            Side::Above => &mut self.above,
        }
    }

    /// Where the plane crosses an edge, the same point for all triangles at the edge.
    fn crossing(&mut self, a: u32, b: u32) -> u32 {
        let [low, high] = if self.side(a) == Side::Below { [a, b] } else { [b, a] };
        if let Some(&point) = self.crossings.get(&[low, high]) {
            return point;
        }
        let [from, to] = [low, high].map(|end| self.points[end as usize]);
        let [below, above] = [low, high].map(|end| self.heights[end as usize]);
        let point = self.points.len() as u32;
        self.points.push(from + (to - from) * (below / (below - above)));
        self.crossings.insert([low, high], point);
        point
    }

    /// The cap of the part below.
    fn cap(&mut self) -> Vec<[u32; 3]> {
        let [u, v] = self.plane.axes();
        let mut loops = loops(std::mem::take(&mut self.rim));
        for corners in &mut loops {
            // Where the plane passes through a corner of the surface, several edges cross it at one place.
            corners.dedup_by_key(|corner| self.points[*corner as usize]);
        }
        let numbers: Vec<u32> = loops.iter().flatten().copied().collect();
        let flat = |&number: &u32| {
            let offset = self.points[number as usize] - self.plane.point();
            [offset.dot(&u), offset.dot(&v)]
        };
        let flat: Vec<Point> = numbers.iter().map(flat).collect();
        let mut next = 0;
        let counted = loops.iter().map(|corners| {
            let first = next;
            next += corners.len();
            (first..next).collect()
        });
        let loops: Vec<Vec<usize>> = counted.collect();
        let triangles = fill(&flat, &loops);
        triangles.into_iter().map(|corners| corners.map(|corner| numbers[corner])).collect()
    }

    fn area(&self, corners: &[u32; 3]) -> f64 {
        let [a, b, c] = corners.map(|corner| self.points[corner as usize]);
        (b - a).cross(&(c - a)).dot(&self.plane.normal()) / 2.0
    }
}

/// Loops of sides, each used once. On a closed surface as many sides begin at a point as end there.
fn loops(mut sides: BTreeMap<u32, Vec<u32>>) -> Vec<Vec<u32>> {
    let mut loops = Vec::new();
    while let Some((&first, _)) = sides.first_key_value() {
        let mut corners = vec![first];
        let mut at = first;
        while let Some(ends) = sides.get_mut(&at) {
            let next = ends.pop();
            if ends.is_empty() {
                sides.remove(&at);
            }
            match next {
                Some(next) if next != first => {
                    corners.push(next);
                    at = next;
                }
                Some(_) | None => break,
            }
        }
        loops.push(corners);
    }
    loops
}
