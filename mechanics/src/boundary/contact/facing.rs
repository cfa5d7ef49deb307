//! Points of the boundary that face each other: where the line along both normals meets the other side.
//!
//! Every node of the boundary that may move is held against the triangle of the boundary that is nearest among those that it
//! faces: the line through the node along the mean normal of both sides meets it, and some of the node's own triangles oppose
//! it. So the gap is the distance to a point in front of or behind the node, and not to one beside it. Normals are means of
//! triangles of about one direction: an edge of a block has those of its faces. Where one side is held as a whole the normal
//! is that of its triangle, which moves as a rigid body. Points in front face each other through air. Points that lie in each
//! other do where they lay in front of each other at rest, or are not two sides of one fold of tissue. Points that lie in
//! each other at rest, as those of scanned lips do, start with no gap. Of tissue and of surfaces of bone (`bone`) a node is held
//! against what it is nearest to, or deepest in.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::bone::{BoneSurface, FacedBone, MovedBone, RigidBone};
use super::fold::Folds;
use super::line::{Meeting, meeting};
use super::moved_boundary::{Boundary, MovedBoundary};
use super::row::{ContactRow, OnBone};
use crate::boundary::Constraint;
use crate::mesh::volume::BoundaryFace;
use crate::mesh::{TriangleSurface, Vector, VolumeMesh};

/// Points that lie in each other without having been in front are at most this part of their edges deep.
const DEEPEST: f64 = 0.5;

/// Nodes that move by more than this part of the largest movement move much.
const MUCH: f64 = 0.5;

/// Gaps below 0 by less than this, in mm, are closed.
pub const CLOSED_MM: f64 = 1e-6;

/// A point that is held along a normal, but for less than this part of it, is held there already.
const LEAST_FREE: f64 = 0.5;

const MOST_STEPS: usize = 100;

/// The boundary of a mesh as a surface that may touch itself.
pub struct FacingSurfaces<'a> {
    mesh: &'a VolumeMesh,
    boundary: Boundary,
    /// Unit normals of points at rest.
    rest_normals: Vec<Vector>,
    /// For each point, whether its node is held in every direction.
    is_held: Vec<bool>,
    /// Those of the boundary.
    faces: &'a [BoundaryFace],
    folds: Folds<'a>,
    /// For each point, how far it is looked for what it faces, in mm: the longest edge around it.
    reach: Vec<f64>,
    /// For each point, how deep it lies in other tissue at rest, in mm: 0 or below.
    at_rest: Vec<f64>,
    bones: Vec<BesideTissue>,
    /// Of points that are held in one or two directions.
    partly_constrained: BTreeMap<u32, Constraint>,
}

/// A bone beside the tissue.
struct BesideTissue {
    number: u32,
    bone: RigidBone,
    /// For each point of the boundary, how deep it lies in the bone at rest, in mm: 0 or below.
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
    /// The boundary of a mesh under some holds, and bones beside it; those without area are left out.
    pub fn new(
        mesh: &'a VolumeMesh,
        boundary: &'a [BoundaryFace],
        constraints: &[Constraint],
        bones: &[BoneSurface],
    ) -> Self {
        let rest = mesh.surface_of(boundary);
        let mut held = vec![false; mesh.nodes.len()];
        constraints
            .iter()
            .filter(|constraint| constraint.count() == 3)
            .for_each(|constraint| held[constraint.node as usize] = true);
        let nodes = rest.node_ids.as_deref().unwrap_or_default();
        let mut surfaces = FacingSurfaces {
            mesh,
            rest_normals: rest.point_normals(),
            is_held: nodes.iter().map(|&node| held[node as usize]).collect(),
            faces: boundary,
            folds: Folds::new(mesh),
            reach: longest_edges(&rest),
            at_rest: vec![0.0; rest.points.len()],
            bones: beside(bones, rest.points.len()),
            partly_constrained: partly_constrained(constraints),
            boundary: Boundary::new(rest),
        };
        surfaces.set_depths_at_rest();
        surfaces
    }

    /// For each node the area in mm² that a force on it presses on: its share of the faces around it, at positions of all nodes, seen
    /// along the force.
    pub fn areas(&self, forces: &[Vector], positions: &[Vector]) -> BTreeMap<u32, f64> {
        let mut areas = BTreeMap::new();
        for face in self.faces {
            let share = face.area_vector(positions) / face.nodes().len() as f64;
            for node in face.nodes() {
                if let Some(along) = forces[*node as usize].try_normalize(f64::MIN_POSITIVE) {
                    *areas.entry(*node).or_default() += (-share.dot(&along)).max(0.0);
                }
            }
        }
        areas
    }

    /// Positions of all nodes after a displacement.
    pub fn positions(&self, displacement: &[Vector]) -> Vec<Vector> {
        self.mesh.nodes.iter().zip(displacement).map(|(node, u)| node + u).collect()
    }

    /// Positions of all nodes at rest.
    pub fn rest_positions(&self) -> &[Vector] {
        &self.mesh.nodes
    }

    /// The largest movement of nodes and bones, and the median of the longest edges around nodes that move much, in mm.
    fn movement_and_edge(&self, displacement: &[Vector]) -> (f64, f64) {
        let movements = || self.nodes().iter().map(|&node| displacement[node as usize].norm());
        let largest = movements().fold(0.0, f64::max);
        let much = movements().zip(&self.reach).filter(|(movement, _)| *movement >= MUCH * largest);
        let mut edges: Vec<f64> = much.map(|(_, edge)| *edge).collect();
        edges.sort_by(f64::total_cmp);
        let edge = edges.get(edges.len() / 2).copied().unwrap_or(f64::INFINITY);
        (largest.max(self.movement_of_bones()), edge)
    }

    /// The largest movement of bones, in mm.
    pub fn movement_of_bones(&self) -> f64 {
        self.bones.iter().map(|beside| beside.bone.largest_movement()).fold(0.0, f64::max)
    }

    /// The number of steps in which what moves much goes by a part of its edges.
    pub fn steps(&self, displacement: &[Vector], part: f64) -> usize {
        let (movement, edge) = self.movement_and_edge(displacement);
        ((movement / (part * edge)).ceil() as usize).clamp(1, MOST_STEPS)
    }

    /// Whether a gap closes from one share of a displacement, and of the movement of bones, to another one.
    pub fn closes(&self, displacement: &[Vector], [before, after]: [f64; 2]) -> bool {
        let part: Vec<Vector> = displacement.iter().map(|u| u * before).collect();
        let closes = |row: &ContactRow| row.gap_after_part(displacement, after) < -CLOSED_MM;
        self.rows(&part, before).iter().any(closes)
    }

    pub fn rest(&self) -> &TriangleSurface {
        &self.boundary.rest
    }

    /// The boundary after a displacement.
    pub fn after(&self, displacement: &[Vector]) -> TriangleSurface {
        self.boundary.rest.displaced(displacement)
    }

    /// The rows of the points that face another or a bone near by after a displacement and a share of the movement of bones,
    /// linear about it, by node.
    pub fn rows(&self, displacement: &[Vector], share: f64) -> Vec<ContactRow> {
        let Some(moved) = self.boundary.moved(displacement) else { return Vec::new() };
        let bones: Vec<MovedBone> =
            self.bones.iter().map(|beside| beside.bone.after(share)).collect();
        let points = (0..self.is_held.len() as u32).into_par_iter();
        let row = |point: u32| {
            let on_bones = self.bones.iter().zip(&bones);
            let on_bones =
                on_bones.filter_map(|(beside, bone)| self.row_on(beside, bone, &moved, point));
            let all = self.row(&moved, point).into_iter().chain(on_bones);
            let gap = |row: &ContactRow| row.gap_after(displacement, share);
            all.min_by(|one, other| gap(one).total_cmp(&gap(other)))
        };
        points.filter_map(row).collect()
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
        Some(ContactRow { node, terms, gap, bone: None })
    }

    /// The row of a point that faces a bone.
    fn row_on(
        &self,
        beside: &BesideTissue,
        moved_bone: &MovedBone,
        moved: &MovedBoundary,
        point: u32,
    ) -> Option<ContactRow> {
        let FacedBone { place, normal, .. } =
            self.faced_of(&beside.bone, moved_bone, moved, point)?;
        let node = self.nodes()[point as usize];
        let rest = self.boundary.rest.points[point as usize];
        let bone =
            OnBone { bone: beside.number, carried: -normal.dot(&beside.bone.displacement(&place)) };
        Some(ContactRow {
            node,
            terms: vec![(node, normal)],
            gap: normal.dot(&(rest - place)) - beside.at_rest[point as usize],
            bone: Some(bone),
        })
    }

    /// What a point faces of a bone. Behind it lies what was in front at rest, or what is less deep than a part of its edges and
    /// not nearer to another side of the bone.
    fn faced_of(
        &self,
        bone: &RigidBone,
        moved_bone: &MovedBone,
        moved: &MovedBoundary,
        point: u32,
    ) -> Option<FacedBone> {
        let at = point as usize;
        if self.is_held[at] {
            return None;
        }
        let reach = self.reach[at];
        let found = moved_bone.faced(&moved.surface.points[at], reach, &moved.normals[at])?;
        let (rest, own) = (self.boundary.rest.points[at], self.rest_normals[at]);
        let is_behind = || {
            bone.is_in_front(found.triangle, &rest, &own)
                || found.is_closest && -found.gap <= DEEPEST * reach
        };
        let is_free = |normal: &Vector| {
            let held = self.partly_constrained.get(&self.nodes()[at]);
            held.is_none_or(|constraint| {
                (normal - constraint.part_along(normal)).norm() > LEAST_FREE
            })
        };
        (is_free(&found.normal) && (found.gap >= 0.0 || is_behind())).then_some(found)
    }

    /// What a point faces: first along its own normal or across a triangle, then along the mean of both normals.
    fn faced(&self, moved: &MovedBoundary, point: u32) -> Option<Faced> {
        if self.is_held[point as usize] {
            return None;
        }
        let (at, reach) = (moved.surface.points[point as usize], self.reach[point as usize]);
        let first = |triangle: usize| self.first(moved, point, triangle);
        let nearest =
            moved.search.closest_within_where(&at, reach, |triangle| first(triangle).is_some())?;
        let normal = self.normal(moved, point, nearest.triangle, &first(nearest.triangle)?)?;
        let along = |triangle: usize, normal: &Vector| {
            let found = meeting(&moved.surface.corners(triangle), &at, &-normal)?;
            self.can_touch(moved, point, triangle, found.ahead).then_some(found)
        };
        let nearest =
            moved.search.closest_within_where(&at, reach, |t| along(t, &normal).is_some())?;
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
        self.can_touch(moved, point, triangle, ahead).then_some(weights)
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
    fn can_touch(&self, moved: &MovedBoundary, point: u32, triangle: usize, ahead: f64) -> bool {
        if self.boundary.rest.triangles[triangle].contains(&point) {
            return false;
        }
        let is_behind = || {
            self.faced_at_rest(point, triangle)
                || -ahead <= DEEPEST * self.reach[point as usize]
                    && !self.is_of_one_fold(point, triangle)
        };
        self.boundary.own_normal(moved, point, triangle).is_some() && (ahead >= 0.0 || is_behind())
    }

    /// Whether a point and a triangle faced each other at rest.
    fn faced_at_rest(&self, point: u32, triangle: usize) -> bool {
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
        self.folds.are_near(nodes[point as usize], &corners)
    }

    /// How deep points lie in other tissue and in bone at rest.
    fn set_depths_at_rest(&mut self) {
        let nothing = vec![Vector::zeros(); self.mesh.nodes.len()];
        let Some(moved) = self.boundary.moved(&nothing) else { return };
        let points = 0..self.is_held.len() as u32;
        let depth = |row: Option<ContactRow>| row.map_or(0.0, |row| row.gap.min(0.0));
        let in_tissue = |point| depth(self.row(&moved, point));
        let at_rest = points.clone().into_par_iter().map(in_tissue).collect();
        let in_bone = |beside: &BesideTissue| -> Vec<f64> {
            let bone = beside.bone.after(0.0);
            let depth = |point| depth(self.row_on(beside, &bone, &moved, point));
            points.clone().into_par_iter().map(depth).collect()
        };
        let in_bones: Vec<Vec<f64>> = self.bones.iter().map(in_bone).collect();
        self.at_rest = at_rest;
        self.bones.iter_mut().zip(in_bones).for_each(|(beside, depths)| beside.at_rest = depths);
    }
}

fn beside(bones: &[BoneSurface], points: usize) -> Vec<BesideTissue> {
    let numbered = (0_u32..).zip(bones);
    let of_bone = |(number, bone)| {
        let bone = RigidBone::new(bone)?;
        Some(BesideTissue { number, bone, at_rest: vec![0.0; points] })
    };
    numbered.filter_map(of_bone).collect()
}

fn partly_constrained(constraints: &[Constraint]) -> BTreeMap<u32, Constraint> {
    let partly = constraints.iter().filter(|constraint| (1..3).contains(&constraint.count()));
    partly.map(|constraint| (constraint.node, constraint.clone())).collect()
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
