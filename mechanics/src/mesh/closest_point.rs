//! The nearest point of a triangle surface, and on which side of it a point lies.
//!
//! This wraps the geometry library (parry): a tree of boxes over the triangles and
//! the projection onto one triangle. All arithmetic is done relative to the middle of the surface,
//! so that a scanner origin 10 km away costs no digits.
//!
//! The side is the sign of (x - c) . n with n the angle-weighted pseudo-normal of the face, edge or
//! vertex that holds the closest point c.
//! Source: Baerentzen, Aanaes, Signed distance computation using the angle weighted pseudonormal,
//! IEEE Transactions on Visualization and Computer Graphics 11 (2005), section 3. It holds for closed
//! surfaces without self-intersection; beside an open border the sign is that of the extended border.

use super::bounds::to_parry;
pub use super::surface_topology::Feature;
use super::surface_topology::SurfaceTopology;
use super::{TriangleSurface, Vector};
use std::ops::Deref;

use parry3d_f64::{
    bounding_volume::Aabb,
    math::Vector as ParryVector,
    partitioning::{Bvh, BvhBuildStrategy, BvhNode},
    query::{PointQuery, PointQueryWithLocation, Ray, RayCast},
    shape::{Triangle, TrianglePointLocation},
};

/// Beyond this the square of a distance is no longer a number.
const LARGEST_COORDINATE: f64 = 1e100;

/// A triangle lower than this share of its longest edge is a line: its neighbours cover it.
const SMALLEST_RELATIVE_HEIGHT: f64 = 1e-12;

/// Why a surface cannot be searched.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SearchError {
    #[error("none of {triangles} triangles has an area")]
    NoArea { triangles: usize },
    #[error("point {point} is not finite or is farther than 1e100 mm away")]
    NotFinite { point: usize },
    #[error("triangle {triangle} names point {point} of {points}")]
    PointOutOfRange { triangle: usize, point: u32, points: usize },
}

/// The point of a surface that is nearest to a given one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint {
    /// In mm.
    pub point: Vector,
    /// The triangle that holds it, in the numbers of the surface.
    pub triangle: usize,
    /// Weights of the triangle's corners; they add up to one.
    pub barycentric: [f64; 3],
    /// In mm, never negative.
    pub distance: f64,
    pub feature: Feature,
}

/// Triangles prepared for nearest-point queries.
pub struct TriangleSearch {
    origin: Vector,
    tree: Bvh,
    /// Triangles with an area, relative to `origin`.
    triangles: Vec<Triangle>,
    /// For each of them its number in the surface.
    numbers: Vec<u32>,
}

/// A triangle surface prepared for nearest-point queries, and for on which side of it a point lies.
pub struct SurfaceSearch {
    search: TriangleSearch,
    topology: SurfaceTopology,
}

impl TriangleSearch {
    /// Triangles without area are left out; a surface that has no others is refused.
    pub fn new(surface: &TriangleSurface) -> Result<Self, SearchError> {
        check(surface)?;
        let (low, high) = surface.bounds();
        let origin = (low + high) * 0.5;
        let local = |point: &Vector| to_parry(&(point - origin));
        let mut triangles = Vec::with_capacity(surface.triangles.len());
        let mut numbers = Vec::with_capacity(surface.triangles.len());
        for number in 0..surface.triangles.len() {
            let [a, b, c] = surface.corners(number);
            if has_area(&a, &b, &c) {
                triangles.push(Triangle::new(local(&a), local(&b), local(&c)));
                numbers.push(number as u32);
            }
        }
        if triangles.is_empty() {
            let triangles = surface.triangles.len();
            return Err(SearchError::NoArea { triangles });
        }
        let boxes: Vec<Aabb> = triangles.iter().map(Triangle::local_aabb).collect();
        let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
        Ok(TriangleSearch { origin, tree, triangles, numbers })
    }

    /// The nearest point of the surface to a finite `point`. Among equally near triangles it is
    /// always the same one for the same surface. The distance to a point that is not finite is infinite.
    pub fn closest(&self, point: &Vector) -> ClosestPoint {
        self.closest_within(point, f64::INFINITY).unwrap_or_else(|| self.infinitely_far())
    }

    /// The nearest point of the surface if it is less than `limit` mm away; the smaller the limit,
    /// the less is searched.
    pub fn closest_within(&self, point: &Vector, limit: f64) -> Option<ClosestPoint> {
        self.closest_of(point, limit, |_| true)
    }

    /// The nearest point of those triangles for which `counts` holds.
    pub fn closest_where(
        &self,
        point: &Vector,
        counts: impl Fn(usize) -> bool,
    ) -> Option<ClosestPoint> {
        self.closest_of(point, f64::INFINITY, counts)
    }

    /// The nearest point of those triangles for which `counts` holds, if it is less than `limit` mm away.
    pub fn closest_within_where(
        &self,
        point: &Vector,
        limit: f64,
        counts: impl Fn(usize) -> bool,
    ) -> Option<ClosestPoint> {
        self.closest_of(point, limit, counts)
    }

    fn closest_of(
        &self,
        point: &Vector,
        limit: f64,
        counts: impl Fn(usize) -> bool,
    ) -> Option<ClosestPoint> {
        let query = to_parry(&(point - self.origin));
        let square = (limit * limit).min(f64::MAX);
        let (leaf, _) = self.tree.find_best(
            square,
            |node: &BvhNode, _| {
                let outside = (node.mins() - query).max(query - node.maxs());
                outside.max(ParryVector::ZERO).length_squared()
            },
            |leaf, _| {
                if !counts(self.numbers[leaf as usize] as usize) {
                    return None;
                }
                let triangle = &self.triangles[leaf as usize];
                let projection = triangle.project_local_point(query, true);
                Some(projection.point.distance_squared(query))
            },
        )?;
        Some(self.closest_on(leaf as usize, query))
    }

    /// The first triangle that a ray meets from a point, but for one of them, and how far that is, in mm, if less than `most`; the
    /// direction has length 1.
    pub fn first_hit(
        &self,
        from: &Vector,
        direction: &Vector,
        except: usize,
        most: f64,
    ) -> Option<(usize, f64)> {
        let ray = Ray::new(to_parry(&(from - self.origin)), to_parry(direction));
        let (leaf, distance) = self.tree.cast_ray(&ray, most, |leaf, best| {
            let is_other = self.numbers[leaf as usize] as usize != except;
            is_other.then(|| self.triangles[leaf as usize].cast_local_ray(&ray, best, false))?
        })?;
        Some((self.numbers[leaf as usize] as usize, distance))
    }

    fn closest_on(&self, leaf: usize, query: ParryVector) -> ClosestPoint {
        let triangle = &self.triangles[leaf];
        let (projection, location) = triangle.project_local_point_and_get_location(query, true);
        let (feature, barycentric) = match location {
            TrianglePointLocation::OnVertex(corner) => {
                let mut weights = [0.0; 3];
                weights[corner as usize] = 1.0;
                (Feature::Vertex(corner as usize), weights)
            }
            TrianglePointLocation::OnEdge(0, [a, b]) => (Feature::Edge(0), [a, b, 0.0]),
            TrianglePointLocation::OnEdge(1, [b, c]) => (Feature::Edge(1), [0.0, b, c]),
            TrianglePointLocation::OnEdge(_, [a, c]) => (Feature::Edge(2), [a, 0.0, c]),
            TrianglePointLocation::OnFace(_, weights) => (Feature::Face, weights),
            // A flat triangle has no inside; parry keeps this for two dimensions.
            TrianglePointLocation::OnSolid => (Feature::Face, [1.0 / 3.0; 3]),
        };
        ClosestPoint {
            point: from_parry(projection.point) + self.origin,
            triangle: self.numbers[leaf] as usize,
            barycentric,
            distance: projection.point.distance(query),
            feature,
        }
    }

    fn infinitely_far(&self) -> ClosestPoint {
        ClosestPoint {
            point: from_parry(self.triangles[0].a) + self.origin,
            triangle: self.numbers[0] as usize,
            barycentric: [1.0, 0.0, 0.0],
            distance: f64::INFINITY,
            feature: Feature::Vertex(0),
        }
    }
}

impl SurfaceSearch {
    /// As that of its triangles alone.
    pub fn new(surface: &TriangleSurface) -> Result<Self, SearchError> {
        let search = TriangleSearch::new(surface)?;
        Ok(SurfaceSearch { search, topology: SurfaceTopology::new(surface, has_area) })
    }

    /// Distance from `point` to `closest`, the closest point to it: positive outside, in mm.
    pub fn signed_distance(&self, point: &Vector, closest: &ClosestPoint) -> f64 {
        let side = (point - closest.point).dot(&self.pseudo_normal(closest));
        if side < 0.0 { -closest.distance } else { closest.distance }
    }

    /// The angle-weighted unit normal of the face, edge or vertex that holds a closest point.
    pub fn pseudo_normal(&self, closest: &ClosestPoint) -> Vector {
        self.topology.normal(closest.triangle, closest.feature)
    }

    /// Whether a closest point lies on an edge that belongs to one triangle only, or at its end.
    pub fn is_on_open_border(&self, closest: &ClosestPoint) -> bool {
        self.topology.is_open(closest.triangle, closest.feature)
    }
}

impl Deref for SurfaceSearch {
    type Target = TriangleSearch;

    fn deref(&self) -> &TriangleSearch {
        &self.search
    }
}

fn check(surface: &TriangleSurface) -> Result<(), SearchError> {
    let points = surface.points.len();
    for (triangle, corners) in surface.triangles.iter().enumerate() {
        if let Some(&point) = corners.iter().find(|&&corner| corner as usize >= points) {
            return Err(SearchError::PointOutOfRange { triangle, point, points });
        }
    }
    let far = |x: &f64| !x.is_finite() || x.abs() > LARGEST_COORDINATE;
    match surface.points.iter().position(|point| point.iter().any(far)) {
        Some(point) => Err(SearchError::NotFinite { point }),
        None => Ok(()),
    }
}

fn has_area(a: &Vector, b: &Vector, c: &Vector) -> bool {
    let [ab, bc, ca] = [b - a, c - b, a - c];
    let longest_square = ab.norm_squared().max(bc.norm_squared()).max(ca.norm_squared());
    ab.cross(&ca).norm() > SMALLEST_RELATIVE_HEIGHT * longest_square
}

fn from_parry(vector: ParryVector) -> Vector {
    Vector::new(vector.x, vector.y, vector.z)
}
