//! Volume and centre of what a closed surface encloses.

use crate::mesh::{TriangleSurface, Vector};

/// What a closed surface encloses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosed {
    /// In mm³; positive where triangles face outwards.
    pub volume_mm3: f64,
    /// The centre of mass, in mm.
    pub centre: Vector,
}

/// By the divergence theorem; `None` where nothing is enclosed.
pub fn enclosed(surface: &TriangleSurface) -> Option<Enclosed> {
    let origin = *surface.points.first()?;
    let (mut six_volumes, mut moment) = (0.0, Vector::zeros());
    for triangle in 0..surface.triangles.len() {
        let [a, b, c] = surface.corners(triangle).map(|corner| corner - origin);
        let six_volume = a.dot(&b.cross(&c));
        six_volumes += six_volume;
        moment += (a + b + c) * (six_volume / 4.0);
    }
    let enclosed =
        || Enclosed { volume_mm3: six_volumes / 6.0, centre: origin + moment / six_volumes };
    (six_volumes > 0.0).then(enclosed)
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
        let found = enclosed(&surface).unwrap();
        assert!((found.volume_mm3 - 4.0).abs() < 1e-12, "{found:?}");
        assert!((found.centre - Vector::new(5.75, 6.0, 5.5)).norm() < 1e-12, "{found:?}");
        assert_eq!(enclosed(&TriangleSurface::default()), None);
    }
}
