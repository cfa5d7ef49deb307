//! The nearest point of a triangle surface: the one place that speaks the geometry library's types.

use parry3d_f64::math::Vector as Coordinates;
use parry3d_f64::query::PointQueryWithLocation;
use parry3d_f64::shape::TriMesh;

use super::{TriangleSurface, Vector};

/// A surface prepared for many queries. Coordinates far from the origin lose no digits: the search
/// works about the centre of the surface.
pub struct SurfaceSearch {
    mesh: TriMesh,
    centre: Vector,
    /// The triangle of the surface behind each triangle of the search.
    triangles: Vec<usize>,
}

/// The point of a surface that is nearest to a query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint {
    pub point: Vector,
    pub triangle: usize,
    /// Weights of the triangle's corners.
    pub barycentric: [f64; 3],
    /// In mm.
    pub distance: f64,
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SearchError {
    #[error("none of the {triangles} triangles has an area")]
    NoArea { triangles: usize },
    #[error("the geometry library refuses the surface: {0}")]
    Refused(String),
}

impl SurfaceSearch {
    /// Triangles without area are left out.
    pub fn new(surface: &TriangleSurface) -> Result<Self, SearchError> {
        let has_area = |triangle: &usize| surface.area_vector(*triangle).norm() > 0.0;
        let triangles: Vec<usize> = (0..surface.triangles.len()).filter(has_area).collect();
        if triangles.is_empty() {
            return Err(SearchError::NoArea { triangles: surface.triangles.len() });
        }
        let sum: Vector = surface.points.iter().sum();
        let centre = sum / surface.points.len() as f64;
        let points = surface.points.iter().map(|point| outside_type(point - centre)).collect();
        let indices = triangles.iter().map(|&triangle| surface.triangles[triangle]).collect();
        let mesh =
            TriMesh::new(points, indices).map_err(|error| SearchError::Refused(error.to_string()))?;
        Ok(SurfaceSearch { mesh, centre, triangles })
    }

    /// The nearest point; the same answer at every call.
    pub fn closest(&self, point: &Vector) -> ClosestPoint {
        let query = outside_type(point - self.centre);
        let (projection, (triangle, location)) =
            self.mesh.project_local_point_and_get_location(query, false);
        let nearest = Vector::new(projection.point.x, projection.point.y, projection.point.z);
        ClosestPoint {
            point: nearest + self.centre,
            triangle: self.triangles[triangle as usize],
            barycentric: location.barycentric_coordinates().unwrap_or([1.0 / 3.0; 3]),
            distance: (point - self.centre - nearest).norm(),
        }
    }
}

fn outside_type(vector: Vector) -> Coordinates {
    Coordinates::new(vector.x, vector.y, vector.z)
}
