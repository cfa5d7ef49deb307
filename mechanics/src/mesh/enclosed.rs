//! Volume and centre of what a closed surface encloses.

use super::{TriangleSurface, Vector};

/// What a closed surface encloses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosed {
    /// In mm³; positive where triangles face outwards.
    pub volume_mm3: f64,
    /// The centre of mass, in mm.
    pub centre: Vector,
}

impl TriangleSurface {
    /// Volume and centre by the divergence theorem; `None` where nothing is enclosed.
    pub fn enclosed(&self) -> Option<Enclosed> {
        let origin = *self.points.first()?;
        let (mut six_volumes, mut moment) = (0.0, Vector::zeros());
        for triangle in 0..self.triangles.len() {
            let (corners, six_volume) = self.tetrahedron_on(triangle);
            six_volumes += six_volume;
            moment += corners.iter().sum::<Vector>() * (six_volume / 4.0);
        }
        let enclosed =
            || Enclosed { volume_mm3: six_volumes / 6.0, centre: origin + moment / six_volumes };
        (six_volumes > 0.0).then(enclosed)
    }

    /// The volume enclosed in mm³, negative where the triangles face inwards.
    pub fn signed_volume(&self) -> f64 {
        let six_volumes = (0..self.triangles.len()).map(|triangle| self.tetrahedron_on(triangle).1);
        six_volumes.sum::<f64>() / 6.0
    }

    /// The corners of a triangle, from the first point of the surface so that a far origin costs no digits, and six times the volume
    /// in mm³ of the tetrahedron between them, negative where that point lies in front.
    pub fn tetrahedron_on(&self, triangle: usize) -> ([Vector; 3], f64) {
        let origin = self.points.first().copied().unwrap_or_default();
        let corners = self.corners(triangle).map(|corner| corner - origin);
        let [a, b, c] = &corners;
        let six_volume = a.dot(&b.cross(c));
        (corners, six_volume)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tetrahedron_has_a_sixth_of_its_cube_and_its_centre_at_the_mean_of_its_corners() {
        let points: Vec<Vector> =
            [[5.0, 5.0, 5.0], [8.0, 5.0, 5.0], [5.0, 9.0, 5.0], [5.0, 5.0, 7.0]]
                .map(Vector::from)
                .to_vec();
        let triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        let surface = TriangleSurface { points, triangles, ..TriangleSurface::default() };
        let found = surface.enclosed().unwrap();
        assert!((surface.signed_volume() - 4.0).abs() < 1e-12, "{found:?}");
        assert!((found.volume_mm3 - 4.0).abs() < 1e-12, "{found:?}");
        assert!((found.centre - Vector::new(5.75, 6.0, 5.5)).norm() < 1e-12, "{found:?}");
        assert_eq!(TriangleSurface::default().enclosed(), None);
    }
}
