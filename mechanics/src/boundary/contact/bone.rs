//! Bone surfaces that tissue may not penetrate: rigid triangles, fixed or moved by a segment.
//!
//! The gap of a place is its distance to the closest triangle that it opposes, below 0 in the bone, along the normal of that triangle
//! or, at an edge between triangles, along the line to the edge. Whether it lies in the bone is asked of the closest triangle of
//! all: beside a wall the line to the edge below it leads out of the bone, not into it. Tissue outside a bone or hardly in it faces
//! walls across its normal too, so that what has slid around an edge does not slide back through the wall. A bone goes on a straight
//! way to where its segment takes it, as held nodes do: x + s ((R - I) x + t), s the share of the movement.

use std::sync::Arc;

use nalgebra::Matrix3;

use super::moved_boundary::OPPOSED;
use crate::mesh::closest_point::Feature;
use crate::mesh::{ClosestPoint, SurfaceSearch, TriangleSurface, Vector};
use crate::plan::RigidMovement;

/// Nearer to an edge than this, in mm, its normal is the mean of those of its triangles.
const AT_EDGE_MM: f64 = 1e-3;

/// The cosine between a normal of tissue and that of a wall of bone across it is below this.
const ACROSS: f64 = 0.3;

/// Tissue no deeper in bone than this part of its edges faces walls.
const SHALLOW: f64 = 0.05;

/// A closest triangle that is nearer than another by less than this part of the distance is as near.
const AS_NEAR: f64 = 1e-9;

/// A bone of a case and the movement of its segment.
#[derive(Clone, Debug)]
pub struct BoneSurface {
    pub name: String,
    /// Its place among the bones of the case.
    pub place: usize,
    /// Whether a segment has its name and carries it.
    pub is_carried: bool,
    pub surface: Arc<TriangleSurface>,
    /// Of its segment; none where it stays.
    pub movement: RigidMovement,
}

/// A bone prepared to be searched.
pub(super) struct RigidBone {
    surface: Arc<TriangleSurface>,
    movement: RigidMovement,
    search: SurfaceSearch,
    /// Unit normals of triangles at rest.
    flats: Vec<Vector>,
}

/// A bone after a share of its movement: x -> A x + b.
pub(super) struct MovedBone<'a> {
    bone: &'a RigidBone,
    forward: Matrix3<f64>,
    back: Matrix3<f64>,
    shift: Vector,
}

/// The place of a bone that a point faces.
pub(super) struct FacedBone {
    pub triangle: usize,
    /// At rest.
    pub place: Vector,
    /// Out of the bone, as moved.
    pub normal: Vector,
    /// In mm, below 0 behind the bone.
    pub gap: f64,
    /// Whether no other triangle of the bone is nearer.
    pub is_closest: bool,
}

impl RigidBone {
    /// None where no triangle has an area.
    pub fn new(bone: &BoneSurface) -> Option<Self> {
        let surface = bone.surface.clone();
        let search = SurfaceSearch::new(&surface).ok()?;
        let unit = |triangle| surface.area_vector(triangle).try_normalize(f64::MIN_POSITIVE);
        let flats = (0..surface.triangles.len()).map(|t| unit(t).unwrap_or_default()).collect();
        Some(RigidBone { movement: bone.movement, search, flats, surface })
    }

    /// The largest movement of its points, in mm.
    pub fn largest_movement(&self) -> f64 {
        let moved = self.surface.points.iter().map(|x| self.movement.displacement(x).norm());
        moved.fold(0.0, f64::max)
    }

    /// Where a place goes in the whole movement.
    pub fn displacement(&self, place: &Vector) -> Vector {
        self.movement.displacement(place)
    }

    pub fn after(&self, share: f64) -> MovedBone<'_> {
        let rotation = self.movement.rotation();
        let forward = Matrix3::identity() * (1.0 - share) + rotation * share;
        // Half a turn has none halfway.
        let back = forward.try_inverse().unwrap_or_else(|| rotation.transpose());
        MovedBone { bone: self, forward, back, shift: self.movement.translation() * share }
    }

    /// Whether a point with a normal of its own lies before a triangle, and that before it, at rest.
    pub fn is_in_front(&self, triangle: usize, at: &Vector, own: &Vector) -> bool {
        let corners = self.surface.corners(triangle);
        self.flats[triangle].dot(&(at - corners[0])) > 0.0
            && corners.iter().any(|corner| own.dot(&(corner - at)) > 0.0)
    }
}

impl MovedBone<'_> {
    /// The nearest place, no farther than `reach`, whose normal opposes the own one of a point.
    pub fn faced(&self, at: &Vector, reach: f64, own: &Vector) -> Option<FacedBone> {
        let search = &self.bone.search;
        let query = self.back * (at - self.shift);
        let nearest = search.closest_within(&query, reach)?;
        let is_outside = search.signed_distance(&query, &nearest) >= 0.0;
        let is_shallow = is_outside || nearest.distance <= SHALLOW * reach;
        let most = if is_shallow { ACROSS } else { OPPOSED };
        let opposes = |normal: &Vector| own.dot(normal) < most;
        let counts = |triangle: usize| opposes(&self.moved_normal(&self.bone.flats[triangle]));
        let closest = search.closest_within_where(&query, reach, counts)?;
        let (normal, gap) = self.normal_and_gap(at, &closest, is_outside);
        opposes(&normal).then_some(FacedBone {
            triangle: closest.triangle,
            place: closest.point,
            normal,
            gap,
            is_closest: nearest.distance >= closest.distance * (1.0 - AS_NEAR),
        })
    }

    fn normal_and_gap(
        &self,
        at: &Vector,
        closest: &ClosestPoint,
        is_outside: bool,
    ) -> (Vector, f64) {
        let search = &self.bone.search;
        let apart = at - (self.forward * closest.point + self.shift);
        let flat = self.moved_normal(&self.bone.flats[closest.triangle]);
        if closest.feature == Feature::Face {
            return (flat, flat.dot(&apart));
        }
        let mean = self.moved_normal(&search.pseudo_normal(closest));
        match apart.norm() {
            distance if distance < AT_EDGE_MM => (mean, mean.dot(&apart)),
            distance if is_outside => (apart / distance, distance),
            distance => (apart / -distance, -distance),
        }
    }

    fn moved_normal(&self, normal: &Vector) -> Vector {
        (self.back.transpose() * normal).try_normalize(f64::MIN_POSITIVE).unwrap_or_default()
    }
}
