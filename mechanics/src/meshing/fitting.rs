//! Volume-preserving fit of the surface to the boundary of the body: nodes move along their normals until as much
//! volume lies between both on the one side as on the other.
//!
//! Triangles between points of a curved surface are its chords: a ball of radius R is short of volume by about h²/(4 R²) of it for
//! edges h, and the boundary lies up to a sagitta away on one side alone. The distance of a smooth boundary from a triangle
//! whose corners lie on it is a quadratic function; its mean over the triangle is three quarters of its value in the middle.
//! Each node goes by the mean of its triangles, which keeps the volume to second order and halves the largest distance.

use super::boundary_set::BoundarySet;
use super::climb::Climb;
use super::draft::Draft;
use super::error::MeshingError;
use super::rims::RimFace;
use super::watch::Watch;
use crate::domain::{Boundary, Domain};
use crate::mesh::Vector;

/// The mean of a quadratic function that is zero at the corners of a triangle over its value in the middle.
const MEAN: f64 = 0.75;
/// A node goes no farther, in parts of the mean edge of its triangles: where the boundary is farther, it is no chord of it.
const FARTHEST: f64 = 0.12;
/// Angles stay above 25 degrees, or do not get worse.
const FAIR: f64 = 0.42;

/// What the triangles at a node ask for, summed over them.
#[derive(Clone, Copy, Default)]
struct NodeTarget {
    /// Normals, with twice the areas as their lengths.
    normal: Vector,
    /// Twice the area.
    area: f64,
    /// Twice the volume that lacks beyond them, in mm³.
    volume: f64,
    /// Lengths of edges and how many they are.
    edges: f64,
    count: f64,
}

/// Moves the nodes of the surface; returns how many.
pub(super) fn fit(climb: &mut Climb, watch: &Watch) -> Result<usize, MeshingError> {
    let Climb { draft, domain, faces, .. } = &*climb;
    let lacks = watch.map(faces, |face| lack(draft, *domain, face))?;
    let mut asked = vec![NodeTarget::default(); draft.nodes.len()];
    let mut free: Vec<bool> = draft.boundaries.iter().map(|&set| only(set).is_some()).collect();
    draft.copies.iter().flatten().for_each(|&node| free[node as usize] = false);
    for (face, lack) in faces.iter().zip(lacks) {
        for node in face.nodes {
            match lack {
                Some(lack) => asked[node as usize].add(draft, face, lack),
                None => free[node as usize] = false,
            }
        }
    }
    let nodes = (0..free.len() as u32).filter(|&node| free[node as usize]);
    let nodes: Vec<u32> = nodes.collect();
    climb.sweep(&nodes, watch, |climb, node| {
        climb.star(node).moved_by(&asked[node as usize].way(), FAIR)
    })
}

/// The boundary that a node lies on, if it is one that may be curved.
fn only(set: BoundarySet) -> Option<Boundary> {
    let mut all = set.iter();
    let first = all.next().filter(|&boundary| boundary != Boundary::Cut);
    first.filter(|_| all.next().is_none())
}

/// How far the boundary lies beyond a face in the mean, in mm; None for a face between two boundaries.
fn lack(draft: &Draft, domain: &dyn Domain, face: &RimFace) -> Option<f64> {
    let sets = face.nodes.map(|node| draft.boundaries[node as usize]);
    let boundary = only(sets[0].shared(sets[1]).shared(sets[2]))?;
    let [a, b, c] = face.nodes.map(|node| draft.nodes[node as usize]);
    let middle = (a + b + c) / 3.0;
    let normal = (b - a).cross(&(c - a)).try_normalize(0.0)?;
    Some(MEAN * (domain.projection(&middle, boundary) - middle).dot(&normal))
}

impl NodeTarget {
    fn add(&mut self, draft: &Draft, face: &RimFace, lack: f64) {
        let [a, b, c] = face.nodes.map(|node| draft.nodes[node as usize]);
        let normal = (b - a).cross(&(c - a));
        self.normal += normal;
        self.area += normal.norm();
        self.volume += normal.norm() * lack;
        self.edges += (b - a).norm() + (c - b).norm() + (a - c).norm();
        self.count += 3.0;
    }

    /// So that the triangles sweep the volume that lacks: a third of each by each of its nodes.
    fn way(&self) -> Vector {
        let square = self.normal.norm_squared();
        let part = self.volume / square;
        let farthest = FARTHEST * self.edges / (self.count * square.sqrt());
        if part.is_finite() {
            self.normal * part.clamp(-farthest, farthest)
        } else {
            Vector::zeros()
        }
    }
}
