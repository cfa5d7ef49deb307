//! Triangle surfaces: skin, bone.

use super::{EMPTY_BOUNDS, Vector, bounds_of};

/// Triangles with outward orientation where the surface is closed; points in mm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleSurface {
    pub points: Vec<Vector>,
    pub triangles: Vec<[u32; 3]>,
    /// For each point the 0-based node of the volume mesh it was cut from, where that is known.
    pub node_ids: Option<Vec<u32>>,
}

impl TriangleSurface {
    /// The three corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [Vector; 3] {
        self.triangles[triangle].map(|point| self.points[point as usize])
    }

    /// The mean of the corners of a triangle.
    pub fn middle(&self, triangle: usize) -> Vector {
        self.corners(triangle).iter().sum::<Vector>() / 3.0
    }

    /// Half the cross product of two edges: along the normal, as long as the triangle's area in mm².
    pub fn area_vector(&self, triangle: usize) -> Vector {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(&(c - a)) * 0.5
    }

    /// The total area in mm².
    pub fn area(&self) -> f64 {
        (0..self.triangles.len()).map(|triangle| self.area_vector(triangle).norm()).sum()
    }

    /// How often some of the triangles wind around a point: 1 within a closed surface, 0 outside.
    /// Source: Van Oosterom, Strackee, The solid angle of a plane triangle, IEEE Transactions on Biomedical Engineering 30
    /// (1983), equation 8.
    pub fn winding_number(&self, triangles: impl Iterator<Item = usize>, point: &Vector) -> f64 {
        let angle = |triangle: usize| {
            let [a, b, c] = self.corners(triangle).map(|corner| corner - point);
            let [la, lb, lc] = [a.norm(), b.norm(), c.norm()];
            let across = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
            2.0 * a.dot(&b.cross(&c)).atan2(across)
        };
        triangles.map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
    }

    /// The lowest and the highest corner of the box around the points that triangles use, in mm.
    /// Without triangles the lowest is above the highest.
    pub fn bounds(&self) -> (Vector, Vector) {
        let used = self.triangles.iter().flatten().map(|&point| &self.points[point as usize]);
        bounds_of(used).unwrap_or(EMPTY_BOUNDS).into()
    }

    /// For each point a third of the area of its triangles, in mm².
    pub fn point_areas(&self) -> Vec<f64> {
        let mut areas = vec![0.0; self.points.len()];
        for (triangle, corners) in self.triangles.iter().enumerate() {
            let third = self.area_vector(triangle).norm() / 3.0;
            for &corner in corners {
                areas[corner as usize] += third;
            }
        }
        areas
    }

    /// The same surface of a volume mesh after a displacement of its nodes in mm.
    pub fn displaced(&self, displacement: &[Vector]) -> TriangleSurface {
        let mut surface = self.clone();
        let nodes = self.node_ids.as_deref().unwrap_or_default();
        for (point, &node) in surface.points.iter_mut().zip(nodes) {
            *point += displacement[node as usize];
        }
        surface
    }

    /// For each point the area-weighted unit normal; zero where its triangles cancel.
    pub fn point_normals(&self) -> Vec<Vector> {
        let mut normals = vec![Vector::zeros(); self.points.len()];
        for (triangle, corners) in self.triangles.iter().enumerate() {
            let area_vector = self.area_vector(triangle);
            for &corner in corners {
                normals[corner as usize] += area_vector;
            }
        }
        for normal in &mut normals {
            *normal = normal.try_normalize(f64::MIN_POSITIVE).unwrap_or_else(Vector::zeros);
        }
        normals
    }
}
