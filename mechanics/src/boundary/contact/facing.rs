//! Points of the boundary that face each other: where the line along both normals meets the other side.
//!
//! Every node of the boundary that may move is held against the triangle of the boundary that is nearest among those that it
//! faces: the line through the node along the mean normal of both sides meets it, and some of the node's own triangles oppose
//! it. So the gap is the distance to a point in front of or behind the node, and not to one beside it. Normals are means of
//! triangles of about one direction: an edge of a block has those of its faces. Where one side is held as a whole the normal
//! is that of its triangle, which moves as a rigid body. Points in front face each other through air. Points that lie in each
//! other do where they lay in front of each other at rest, or are not two sides of one fold of tissue. Points that lie in
//! each other at rest, as those of scanned lips do, start with no gap.

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use super::line::{Meeting, meeting};
use super::moved_boundary::{Boundary, MovedBoundary};
use super::row::ContactRow;
use crate::boundary::Hold;
use crate::mesh::volume::BoundaryFace;
use crate::mesh::{TriangleSurface, Vector, VolumeMesh};

/// Points that lie in each other without having been in front are at most this part of their edges deep.
const DEEPEST: f64 = 0.5;

/// Points this many edges of tissue apart, or fewer, do not lie in each other: they are two sides of one fold.
const FOLD: usize = 4;

/// Nodes that move by more than this part of the largest movement move much.
const MUCH: f64 = 0.5;

/// Gaps below 0 by less than this, in mm, are closed.
pub const CLOSED_MM: f64 = 1e-6;

const MOST_STEPS: usize = 100;

/// The boundary of a mesh as a surface that may touch itself.
pub struct FacingSurfaces<'a> {
    mesh: &'a VolumeMesh,
    boundary: Boundary,
    /// Unit normals of points at rest.
    rest_normals: Vec<Vector>,
    /// For each point, whether its node is held in every direction.
    is_held: Vec<bool>,
    /// Of each face for each of its nodes: an equal part of its area, along its normal, in mm².
    shares: Vec<(u32, Vector)>,
    /// The cells around each node.
    around: Vec<Vec<u32>>,
    /// For each point, how far it is looked for what it faces, in mm: the longest edge around it.
    reach: Vec<f64>,
    /// For each point, how deep it lies in other tissue at rest, in mm: 0 or below.
    at_rest: Vec<f64>,
}

/// A point of a triangle that a node faces.
struct Faced {
    triangle: usize,
    weights: [f64; 3],
    /// Out of the triangle.
    normal: Vector,
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
            shares: shares(mesh, boundary),
            around: cells_around(mesh),
            reach: longest_edges(&rest),
            at_rest: vec![0.0; rest.points.len()],
            boundary: Boundary::new(rest),
        };
        surfaces.at_rest = surfaces.depths_at_rest();
        surfaces
    }

    /// For each node the area in mm² that a force on it presses on: its share of the faces around it, seen along the force.
    pub fn areas(&self, forces: &[Vector]) -> BTreeMap<u32, f64> {
        let mut areas = BTreeMap::new();
        for (node, share) in &self.shares {
            if let Some(along) = forces[*node as usize].try_normalize(f64::MIN_POSITIVE) {
                *areas.entry(*node).or_default() += (-share.dot(&along)).max(0.0);
            }
        }
        areas
    }

    /// The largest movement, and the median of the longest edges around nodes that move much, in mm.
    fn movement_and_edge(&self, displacement: &[Vector]) -> (f64, f64) {
        let movements = || self.nodes().iter().map(|&node| displacement[node as usize].norm());
        let largest = movements().fold(0.0, f64::max);
        let much = movements().zip(&self.reach).filter(|(movement, _)| *movement >= MUCH * largest);
        let mut edges: Vec<f64> = much.map(|(_, edge)| *edge).collect();
        edges.sort_by(f64::total_cmp);
        (largest, edges.get(edges.len() / 2).copied().unwrap_or(f64::INFINITY))
    }

    /// The number of steps in which what moves much goes by a part of its edges.
    pub fn steps(&self, displacement: &[Vector], part: f64) -> usize {
        let (movement, edge) = self.movement_and_edge(displacement);
        ((movement / (part * edge)).ceil() as usize).clamp(1, MOST_STEPS)
    }

    /// Whether a gap closes along a displacement, in so many steps.
    pub fn touches(&self, displacement: &[Vector], steps: usize) -> bool {
        let share = |step: usize| step as f64 / steps as f64;
        let part = |share: f64| displacement.iter().map(|u| u * share).collect::<Vec<Vector>>();
        let closes =
            |row: &ContactRow, share: f64| row.gap_after_part(displacement, share) < -CLOSED_MM;
        (1..=steps + 1).any(|step| {
            let rows = self.rows(&part(share(step - 1)));
            rows.iter().any(|row| closes(row, share(step).min(1.0)))
        })
    }

    pub fn rest(&self) -> &TriangleSurface {
        &self.boundary.rest
    }

    /// The boundary after a displacement.
    pub fn after(&self, displacement: &[Vector]) -> TriangleSurface {
        self.boundary.after(displacement)
    }

    /// The rows of the points that face another near by after a displacement, linear about it, by node.
    pub fn rows(&self, displacement: &[Vector]) -> Vec<ContactRow> {
        let Some(moved) = self.boundary.moved(displacement) else { return Vec::new() };
        let points = (0..self.is_held.len() as u32).into_par_iter();
        points.filter_map(|point| self.row(&moved, point)).collect()
    }

    fn nodes(&self) -> &[u32] {
        self.boundary.rest.node_ids.as_deref().unwrap_or_default()
    }

    fn row(&self, moved: &MovedBoundary, point: u32) -> Option<ContactRow> {
        let Faced { triangle, weights, normal } = self.faced(moved, point)?;
        let (rest, nodes) = (&self.boundary.rest, self.nodes());
        let node = nodes[point as usize];
        let mut terms = vec![(node, normal)];
        let mut gap = normal.dot(&rest.points[point as usize]) - self.at_rest[point as usize];
        let corners = rest.triangles[triangle].iter();
        for (&corner, weight) in corners.zip(weights).filter(|(_, weight)| *weight > 0.0) {
            terms.push((nodes[corner as usize], -weight * normal));
            gap -= weight * normal.dot(&rest.points[corner as usize]);
        }
        Some(ContactRow { node, terms, gap })
    }

    /// What a point faces: first along its own normal or across a triangle, then along the mean of both normals.
    fn faced(&self, moved: &MovedBoundary, point: u32) -> Option<Faced> {
        if self.is_held[point as usize] {
            return None;
        }
        let (at, reach) = (moved.surface.points[point as usize], self.reach[point as usize]);
        let first = |triangle: usize| self.first(moved, point, triangle);
        let nearest =
            moved.search.nearer_where(&at, reach, |triangle| first(triangle).is_some())?;
        let normal = self.normal(moved, point, nearest.triangle, &first(nearest.triangle)?)?;
        let along = |triangle: usize, normal: &Vector| {
            let found = meeting(&moved.surface.corners(triangle), &at, &-normal)?;
            self.may_face(moved, point, triangle, found.ahead).then_some(found)
        };
        let nearest = moved.search.nearer_where(&at, reach, |t| along(t, &normal).is_some())?;
        let triangle = nearest.triangle;
        let weights = along(triangle, &normal)?.weights;
        let better = self.normal(moved, point, triangle, &weights)?;
        Some(match along(triangle, &better) {
            Some(found) => Faced { triangle, weights: found.weights, normal: better },
            None => Faced { triangle, weights, normal },
        })
    }

    /// The weights of the point of a triangle that a point faces along its own normal, or across the triangle.
    fn first(&self, moved: &MovedBoundary, point: u32, triangle: usize) -> Option<[f64; 3]> {
        let own = self.boundary.own_normal(moved, point, triangle)?;
        let at = moved.surface.points[point as usize];
        let corners = moved.surface.corners(triangle);
        let across = || meeting(&corners, &at, &-moved.flats[triangle]);
        let Meeting { weights, ahead } = meeting(&corners, &at, &own).or_else(across)?;
        self.may_face(moved, point, triangle, ahead).then_some(weights)
    }

    /// The mean of the normals of both sides, out of the triangle.
    fn normal(
        &self,
        moved: &MovedBoundary,
        point: u32,
        triangle: usize,
        weights: &[f64; 3],
    ) -> Option<Vector> {
        let corners = self.boundary.rest.triangles[triangle];
        if corners.iter().all(|&corner| self.is_held[corner as usize]) {
            return Some(moved.flats[triangle]);
        }
        let own = self.boundary.own_normal(moved, point, triangle)?;
        let other = self.boundary.normal_at(moved, triangle, weights)?;
        (other - own).try_normalize(f64::MIN_POSITIVE)
    }

    /// Whether a triangle that lies so far ahead of a point, in mm, is one that it may not pass.
    fn may_face(&self, moved: &MovedBoundary, point: u32, triangle: usize, ahead: f64) -> bool {
        if self.boundary.rest.triangles[triangle].contains(&point) {
            return false;
        }
        let is_behind = || {
            self.was_in_front(point, triangle)
                || -ahead <= DEEPEST * self.reach[point as usize]
                    && !self.is_of_one_fold(point, triangle)
        };
        self.boundary.own_normal(moved, point, triangle).is_some() && (ahead >= 0.0 || is_behind())
    }

    /// Whether a point and a triangle lay in front of each other at rest.
    fn was_in_front(&self, point: u32, triangle: usize) -> bool {
        let rest = &self.boundary.rest;
        let corners = rest.corners(triangle);
        let at = rest.points[point as usize];
        let own = self.rest_normals[point as usize];
        rest.area_vector(triangle).dot(&(at - corners[0])) > 0.0
            && corners.iter().any(|corner| own.dot(&(corner - at)) > 0.0)
    }

    /// Whether few cells of tissue lead from a point to a triangle.
    fn is_of_one_fold(&self, point: u32, triangle: usize) -> bool {
        let nodes = self.nodes();
        let corners = self.boundary.rest.triangles[triangle].map(|corner| nodes[corner as usize]);
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

fn shares(mesh: &VolumeMesh, boundary: &[BoundaryFace]) -> Vec<(u32, Vector)> {
    let of_face = |face: &BoundaryFace| {
        let at = |node: u32| mesh.nodes[node as usize];
        let area = |[a, b, c]: [u32; 3]| 0.5 * (at(b) - at(a)).cross(&(at(c) - at(a)));
        let share = face.triangles().map(area).sum::<Vector>() / face.nodes().len() as f64;
        face.nodes().iter().map(|&node| (node, share)).collect::<Vec<_>>()
    };
    boundary.iter().flat_map(of_face).collect()
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
