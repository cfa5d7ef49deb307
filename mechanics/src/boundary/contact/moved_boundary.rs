//! The boundary of a mesh at rest and after a displacement, with normals of those triangles around a point that have about one
//! direction.

use crate::mesh::{TriangleSearch, TriangleSurface, Vector};

/// The cosine of normals that oppose each other is below this.
pub(super) const OPPOSED: f64 = -0.3;

/// The cosine of normals that have about one direction is above this.
const ALIKE: f64 = 0.5;

/// The boundary at rest.
pub(super) struct Boundary {
    /// With `node_ids`, ascending.
    pub rest: TriangleSurface,
    /// The triangles around each point.
    fans: Vec<Vec<u32>>,
}

/// The boundary after a displacement.
pub(super) struct MovedBoundary {
    pub surface: TriangleSurface,
    /// Unit normals of triangles; zero where one has no area.
    pub flats: Vec<Vector>,
    /// Unit normals of points.
    pub normals: Vec<Vector>,
    pub search: TriangleSearch,
}

impl Boundary {
    pub fn new(rest: TriangleSurface) -> Self {
        let mut fans = vec![Vec::new(); rest.points.len()];
        for (triangle, corners) in (0_u32..).zip(&rest.triangles) {
            corners.iter().for_each(|&corner| fans[corner as usize].push(triangle));
        }
        Boundary { rest, fans }
    }

    /// None where no triangle has an area.
    pub fn moved(&self, displacement: &[Vector]) -> Option<MovedBoundary> {
        let surface = self.rest.displaced(displacement);
        let search = TriangleSearch::new(&surface).ok()?;
        let unit = |triangle: usize| surface.area_vector(triangle).try_normalize(f64::MIN_POSITIVE);
        let flats = (0..surface.triangles.len()).map(|triangle| unit(triangle).unwrap_or_default());
        Some(MovedBoundary {
            flats: flats.collect(),
            normals: surface.point_normals(),
            search,
            surface,
        })
    }

    /// Whether a point has a normal that opposes another one.
    fn opposes(moved: &MovedBoundary, point: u32, other: &Vector) -> bool {
        moved.normals[point as usize].dot(other) < OPPOSED
    }

    /// The normal of a point over those of its triangles that oppose a triangle; none where its normal does not.
    pub fn own_normal(&self, moved: &MovedBoundary, point: u32, triangle: usize) -> Option<Vector> {
        let other = moved.flats[triangle];
        let opposes = |normal: &Vector| normal.dot(&other) < OPPOSED;
        Self::opposes(moved, point, &other).then(|| self.mean(moved, point, opposes))?
    }

    /// The normal at a point of a triangle, over triangles around its corners that are much like it.
    pub fn normal_at(
        &self,
        moved: &MovedBoundary,
        triangle: usize,
        weights: &[f64; 3],
    ) -> Option<Vector> {
        let flat = moved.flats[triangle];
        let at_corner = |corner: u32| self.mean(moved, corner, |other| other.dot(&flat) > ALIKE);
        let corners = self.rest.triangles[triangle].iter().zip(weights);
        let sum: Vector =
            corners.map(|(&corner, weight)| at_corner(corner).unwrap_or_default() * *weight).sum();
        sum.try_normalize(f64::MIN_POSITIVE)
    }

    /// The unit normal of those triangles around a point that count, by their areas.
    fn mean(
        &self,
        moved: &MovedBoundary,
        point: u32,
        counts: impl Fn(&Vector) -> bool,
    ) -> Option<Vector> {
        let fan = self.fans[point as usize].iter().map(|&triangle| triangle as usize);
        let counted = fan.filter(|&triangle| counts(&moved.flats[triangle]));
        let sum: Vector = counted.map(|triangle| moved.surface.area_vector(triangle)).sum();
        sum.try_normalize(f64::MIN_POSITIVE)
    }
}
