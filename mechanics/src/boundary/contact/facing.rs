//! Points of the boundary that face each other through air: the closest ones with opposing normals.
//!
//! Every node of the boundary that may move is held against the triangles of other parts of it. The normal is the mean of those of both
//! sides; where one side is held as a whole it is that of this side, which moves as a rigid body. Two points face each other
//! where each lies in front of the other at rest: the two sides of one fold of tissue do not, nor do neighbours on a surface
//! that bulges. Points that lie in each other at rest, as those of scanned lips do, start with no gap.

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use super::row::ContactRow;
use crate::boundary::Hold;
use crate::mesh::volume::BoundaryFace;
use crate::mesh::{ClosestPoint, SurfaceSearch, TriangleSurface, Vector, VolumeMesh};

/// The cosine of normals that oppose each other is below this.
const OPPOSED: f64 = -0.3;

/// Points that lie in each other at rest are at most this part of the edges of their triangle deep.
const DEEPEST: f64 = 0.5;

/// Points this many edges of tissue apart, or fewer, do not lie in each other: they are two sides of one fold.
const FOLD: usize = 4;

/// The boundary of a mesh as a surface that may touch itself.
pub struct FacingSurfaces<'a> {
    mesh: &'a VolumeMesh,
    /// With `node_ids`.
    rest: TriangleSurface,
    rest_normals: Vec<Vector>,
    /// For each point, whether its node is held in every direction.
    is_held: Vec<bool>,
    /// The cells around each node.
    around: Vec<Vec<u32>>,
    /// For each point, how far it is looked for what it faces, in mm: the longest edge around it.
    reach: Vec<f64>,
    /// For each point, how deep it lies in other tissue at rest, in mm: 0 or below.
    at_rest: Vec<f64>,
}

/// The boundary after a displacement.
struct Moved {
    surface: TriangleSurface,
    normals: Vec<Vector>,
    search: SurfaceSearch,
}

impl<'a> FacingSurfaces<'a> {
    pub fn new(mesh: &'a VolumeMesh, boundary: &[BoundaryFace], holds: &[Hold]) -> Self {
        let rest = mesh.surface_of(boundary);
        let mut held = vec![false; mesh.nodes.len()];
        holds
            .iter()
            .filter(|hold| hold.count() == 3)
            .for_each(|hold| held[hold.node as usize] = true);
        let nodes = rest.node_ids.as_deref().unwrap_or_default();
        let mut surfaces = FacingSurfaces {
            mesh,
            rest_normals: rest.point_normals(),
            is_held: nodes.iter().map(|&node| held[node as usize]).collect(),
            around: cells_around(mesh),
            reach: longest_edges(&rest),
            at_rest: vec![0.0; rest.points.len()],
            rest,
        };
        surfaces.at_rest = surfaces.depths_at_rest();
        surfaces
    }

    /// For each node the area in mm² that a force on it presses on: a third of the triangles around it, seen along the force.
    pub fn areas(&self, forces: &[Vector]) -> BTreeMap<u32, f64> {
        let nodes = self.nodes();
        let mut areas = BTreeMap::new();
        for (triangle, corners) in self.rest.triangles.iter().enumerate() {
            let third = self.rest.area_vector(triangle) / 3.0;
            for node in corners.map(|corner| nodes[corner as usize]) {
                if let Some(along) = forces[node as usize].try_normalize(f64::MIN_POSITIVE) {
                    *areas.entry(node).or_default() += (-third.dot(&along)).max(0.0);
                }
            }
        }
        areas
    }

    /// The rows of the points that face another near by after a displacement, linear about it.
    pub fn rows(&self, displacement: &[Vector]) -> Vec<ContactRow> {
        let Some(moved) = self.moved(displacement) else { return Vec::new() };
        let points = (0..self.rest.points.len() as u32).into_par_iter();
        points.filter_map(|point| self.row(&moved, point)).collect()
    }

    fn nodes(&self) -> &[u32] {
        self.rest.node_ids.as_deref().unwrap_or_default()
    }

    fn moved(&self, displacement: &[Vector]) -> Option<Moved> {
        let mut surface = self.rest.clone();
        for (point, &node) in surface.points.iter_mut().zip(self.nodes()) {
            *point += displacement[node as usize];
        }
        let search = SurfaceSearch::new(&surface).ok()?;
        Some(Moved { normals: surface.point_normals(), search, surface })
    }

    fn row(&self, moved: &Moved, point: u32) -> Option<ContactRow> {
        if self.is_held[point as usize] {
            return None;
        }
        let at = moved.surface.points[point as usize];
        let faces = |triangle: usize| self.faces(moved, point, triangle);
        let closest = moved.search.nearer_where(&at, self.reach[point as usize], faces)?;
        if moved.search.is_on_open_border(&closest) {
            return None;
        }
        let normal = self.normal(moved, point, &closest)?;
        let corners = self.rest.triangles[closest.triangle];
        let nodes = self.nodes();
        let mut terms = vec![(nodes[point as usize], normal)];
        let mut gap = normal.dot(&self.rest.points[point as usize]) - self.at_rest[point as usize];
        for (&corner, weight) in corners.iter().zip(closest.barycentric).filter(|(_, w)| *w > 0.0) {
            terms.push((nodes[corner as usize], -weight * normal));
            gap -= weight * normal.dot(&self.rest.points[corner as usize]);
        }
        Some(ContactRow { node: nodes[point as usize], terms, gap })
    }

    /// The mean of the normals of both sides, out of the triangle.
    fn normal(&self, moved: &Moved, point: u32, closest: &ClosestPoint) -> Option<Vector> {
        let corners = self.rest.triangles[closest.triangle];
        let is_rigid = corners.iter().all(|&corner| self.is_held[corner as usize]);
        let own = -moved.normals[point as usize];
        let of_corners = corners.iter().zip(closest.barycentric);
        let other: Vector = of_corners.map(|(&c, w)| moved.normals[c as usize] * w).sum();
        let flat = moved.surface.area_vector(closest.triangle);
        match is_rigid {
            true => flat.try_normalize(f64::MIN_POSITIVE),
            false => (own + other.try_normalize(0.0)?).try_normalize(f64::MIN_POSITIVE),
        }
    }

    /// Whether a triangle is one that a point may not pass.
    fn faces(&self, moved: &Moved, point: u32, triangle: usize) -> bool {
        let corners = self.rest.triangles[triangle];
        if corners.contains(&point) {
            return false;
        }
        let normal = moved.surface.area_vector(triangle);
        let opposes = normal.dot(&moved.normals[point as usize]) < OPPOSED * normal.norm();
        opposes && self.in_front_at_rest(point, triangle)
    }

    fn in_front_at_rest(&self, point: u32, triangle: usize) -> bool {
        let [a, b, c] = self.rest.corners(triangle);
        let normal = self.rest.area_vector(triangle);
        let Some(normal) = normal.try_normalize(f64::MIN_POSITIVE) else { return false };
        let at = self.rest.points[point as usize];
        let own = self.rest_normals[point as usize];
        let before = normal.dot(&(at - a));
        let ahead =
            [a, b, c].map(|corner| own.dot(&(corner - at))).into_iter().fold(f64::MIN, f64::max);
        if before > 0.0 && ahead > 0.0 {
            return true;
        }
        let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        let deepest = -DEEPEST * longest;
        let nearest =
            [a, b, c].map(|corner| (corner - at).norm()).into_iter().fold(f64::MAX, f64::min);
        let is_near = before > deepest && ahead > deepest && nearest <= longest;
        is_near && !self.is_of_one_fold(point, triangle)
    }

    /// Whether few cells of tissue lead from a point to a triangle.
    fn is_of_one_fold(&self, point: u32, triangle: usize) -> bool {
        let nodes = self.nodes();
        let corners = self.rest.triangles[triangle].map(|corner| nodes[corner as usize]);
        let first = nodes[point as usize];
        let mut seen = BTreeSet::from([first]);
        let mut ring = vec![first];
        for _ in 0..FOLD {
            let cells: BTreeSet<u32> =
                ring.iter().flat_map(|&node| &self.around[node as usize]).copied().collect();
            let reached = cells.iter().flat_map(|&cell| self.mesh.cells.nodes(cell as usize));
            ring = reached.copied().filter(|&node| seen.insert(node)).collect();
            if ring.iter().any(|node| corners.contains(node)) {
                return true;
            }
        }
        false
    }

    /// How deep points lie in other tissue at rest.
    fn depths_at_rest(&self) -> Vec<f64> {
        let nothing = vec![Vector::zeros(); self.mesh.nodes.len()];
        let mut depths = self.at_rest.clone();
        for row in self.rows(&nothing) {
            if let Ok(point) = self.nodes().binary_search(&row.node) {
                depths[point] = row.gap.min(0.0);
            }
        }
        depths
    }
}

fn cells_around(mesh: &VolumeMesh) -> Vec<Vec<u32>> {
    let mut around = vec![Vec::new(); mesh.nodes.len()];
    for (cell, (_, nodes)) in (0_u32..).zip(mesh.cells.iter()) {
        nodes.iter().for_each(|&node| around[node as usize].push(cell));
    }
    around
}

/// Of the triangles around each point.
fn longest_edges(surface: &TriangleSurface) -> Vec<f64> {
    let mut longest: Vec<f64> = vec![0.0; surface.points.len()];
    for (triangle, corners) in surface.triangles.iter().enumerate() {
        let [a, b, c] = surface.corners(triangle);
        let own = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        corners
            .iter()
            .for_each(|&corner| longest[corner as usize] = longest[corner as usize].max(own));
    }
    longest
}
