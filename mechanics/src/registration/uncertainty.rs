//! The standard error of a registration of surfaces: what their shape leaves open.
//!
//! At the end of iterative closest point the distances are linear in a small turn ω about the middle c and a shift t, with
//! the row ((x_i - c) × n_i, n_i) at each pair. Patches of L x L are independent observations, in each of which all errors are
//! the same, so each counts by the mean of its rows:
//!
//!   C = σ² (Σ_p A_p / L² ā_p ā_pᵀ)⁻¹,   σ = max(rms, .05 mm),   L = 10 mm
//!
//! A_p: the area of patch p. Means over patches also keep the normals of single triangles, which noise turns by more than shape
//! does, from counting as shape: chords of a sphere would else determine its rotation. A patch is the part of a surface in a cube
//! of edge L that faces one way, since both faces of thin bone lie in one.
//!
//! Source: Gelfand, Ikemoto, Rusinkiewicz, Levoy, Geometrically stable sampling for the ICP algorithm, 3DIM 2003, section 2
//! (the matrix, and what slides); Censi, An accurate closed-form estimate of ICP's covariance, ICRA 2007. σ and L are assumptions:
//! thresholds and partial volume move the surfaces of CT by tenths of a mm over a centimetre, and the residual of a base
//! that slid along itself tells nothing of that.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Matrix6, Vector6};

use crate::mesh::{Vector, Warning};

/// In mm: errors of a surface are the same over this length, L.
const CORRELATION: f64 = 10.0;

/// In mm: the least σ, however well surfaces fit.
const LEAST_ERROR: f64 = 0.05;

/// What a direction is determined by, as a share of the best determined one, is rounding below that.
const FREE_DIRECTION: f64 = 1e-9;

/// In radians: beyond this a standard error of a rotation is no small turn, and its number means nothing.
const LARGEST_TURN: f64 = 0.5;

/// In mm: a larger standard error is told.
const TOLD: f64 = 0.5;

/// A place on a surface, its normal, and the area in mm² that it stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Observation {
    pub point: Vector,
    pub normal: Vector,
    pub area: f64,
}

/// The covariance of a small turn in radians about a centre, and of a shift in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidUncertainty {
    centre: Vector,
    covariance: Matrix6<f64>,
}

impl RigidUncertainty {
    /// Of surfaces that fit to `rms` mm; nothing where a movement is free.
    pub(super) fn new(observations: &[Observation], rms: f64) -> Option<Self> {
        let centre = middle(observations);
        let squares = observations.iter().map(|one| (one.point - centre).norm_squared());
        let radius = (squares.sum::<f64>() / observations.len() as f64).sqrt();
        let mut matrix = Matrix6::zeros();
        for Patch { sum, points, area, .. } in patches(observations, &centre, radius) {
            let mean = sum / points;
            matrix += mean * mean.transpose() * (area / (CORRELATION * CORRELATION));
        }
        let modes = matrix.symmetric_eigen();
        let stiffest = modes.eigenvalues.amax();
        let is_free = |value: &f64| value.is_nan() || *value <= FREE_DIRECTION * stiffest;
        if modes.eigenvalues.iter().any(is_free) {
            return None;
        }
        let variance = rms.max(LEAST_ERROR).powi(2);
        let units = Vector6::new(radius, radius, radius, 1.0, 1.0, 1.0).map(f64::recip);
        let mut covariance = Matrix6::zeros();
        for (value, mode) in modes.eigenvalues.iter().zip(modes.eigenvectors.column_iter()) {
            let mode = mode.component_mul(&units);
            covariance += mode * mode.transpose() * (variance / value);
        }
        let found = RigidUncertainty { centre, covariance };
        (found.rotation() <= LARGEST_TURN).then_some(found)
    }

    /// The standard error of the rotation, in radians.
    pub fn rotation(&self) -> f64 {
        self.covariance.fixed_view::<3, 3>(0, 0).trace().sqrt()
    }

    /// The standard error of where a point is moved to, in mm; the point as registered.
    pub fn displacement(&self, point: &Vector) -> f64 {
        let turn = self.covariance.fixed_view::<3, 3>(0, 0).into_owned();
        let both = self.covariance.fixed_view::<3, 3>(0, 3).into_owned();
        let shift = self.covariance.fixed_view::<3, 3>(3, 3).into_owned();
        let arm: Matrix3<f64> = -(point - self.centre).cross_matrix();
        let squared = (arm * turn * arm.transpose()).trace() + 2.0 * (arm * both).trace();
        (squared + shift.trace()).max(0.0).sqrt()
    }
}

/// How far what was registered may be off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StandardError {
    /// Of the rotation, in radians.
    pub rotation: f64,
    /// The largest of displacements, in mm.
    pub displacement: f64,
}

impl StandardError {
    /// Of points that a registration moves, where they are then.
    pub fn of_points(uncertainty: &RigidUncertainty, points: &[Vector]) -> Self {
        let errors = points.iter().map(|point| uncertainty.displacement(point));
        StandardError { rotation: uncertainty.rotation(), displacement: errors.fold(0.0, f64::max) }
    }
}

/// A warning where the shape of what was registered leaves a displacement to more than .5 mm, or a movement free; `what` says
/// what it is to determine.
pub fn undetermined(what: &str, error: Option<&StandardError>) -> Option<Warning> {
    let advice = "register by a larger surface, or one that is less even or less round";
    let Some(StandardError { rotation, displacement }) = error else {
        let detail = format!(
            "the shape of what was registered leaves {what} open, as a sphere or a plane does: {advice}"
        );
        return Some(Warning::new("registration-undetermined", detail));
    };
    (*displacement > TOLD).then(|| {
        let degrees = rotation.to_degrees();
        let detail = format!(
            "the shape of what was registered determines {what} only to a standard error of {displacement:.2} mm and {degrees:.2} degrees, \
             which its rms does not show: {advice}"
        );
        let warning = Warning::new("registration-undetermined", detail);
        warning.with("displacement_mm", *displacement).with("rotation_deg", degrees)
    })
}

/// The part of a surface in a cube that faces one way.
struct Patch {
    /// The normal of its first observation.
    faces: Vector,
    sum: Vector6<f64>,
    points: f64,
    area: f64,
}

/// Rows with the turn measured by the shift it causes at `radius`, summed over patches.
fn patches(observations: &[Observation], centre: &Vector, radius: f64) -> Vec<Patch> {
    let mut cubes: BTreeMap<[i64; 3], Vec<Patch>> = BTreeMap::new();
    for Observation { point, normal, area } in observations {
        let arm = point - centre;
        let turn = (arm / radius).cross(normal);
        let row = Vector6::new(turn.x, turn.y, turn.z, normal.x, normal.y, normal.z);
        let place = arm.map(|coordinate| (coordinate / CORRELATION).floor() as i64);
        let cube = cubes.entry(place.into()).or_default();
        match cube.iter_mut().find(|patch| patch.faces.dot(normal) > 0.0) {
            Some(patch) => {
                patch.sum += row;
                (patch.points, patch.area) = (patch.points + 1.0, patch.area + area);
            }
            None => cube.push(Patch { faces: *normal, sum: row, points: 1.0, area: *area }),
        }
    }
    cubes.into_values().flatten().collect()
}

fn middle(observations: &[Observation]) -> Vector {
    let origin = observations.first().map_or_else(Vector::zeros, |one| one.point);
    let offsets = observations.iter().map(|one| one.point - origin);
    origin + offsets.sum::<Vector>() / observations.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::TriangleSurface;
    use crate::progress::Unobserved;
    use crate::registration::{IterativeClosestPoint, SurfaceAlignment};

    /// A ball of 40 mm, or the cap of it up to an angle in degrees from the top, whose radius a function adds to.
    fn ball(angle: f64, rings: u32, added: impl Fn(&Vector) -> f64) -> TriangleSurface {
        let around = 4 * rings;
        let mut surface = TriangleSurface::default();
        for ring in 0..=rings {
            for place in 0..around {
                // Not one triangulation turned by a step of itself.
                let down = angle.to_radians() * f64::from(ring) / f64::from(rings);
                let turn = std::f64::consts::TAU * (f64::from(place) + 0.3 * f64::from(ring))
                    / f64::from(around);
                let way = Vector::new(down.sin() * turn.cos(), down.sin() * turn.sin(), down.cos());
                surface.points.push(way * (40.0 + added(&(way * 40.0))));
                if ring < rings {
                    let [a, b] = [place, (place + 1) % around].map(|place| ring * around + place);
                    let faces = [[a, a + around, b], [b, a + around, b + around]];
                    surface.triangles.extend(faces);
                }
            }
        }
        surface
    }

    fn bumps(x: &Vector) -> f64 {
        2.0 * (x.x / 9.0 + 1.0).sin() * (x.y / 11.0).cos() + 2.0 * (x.z / 10.0 + x.x / 15.0).sin()
    }

    /// Noise of .3 mm that is smooth over about 10 mm, from a linear congruence.
    fn noise(mut seed: u64) -> impl Fn(&Vector) -> f64 {
        let mut draw = move || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let mut wave =
            || Vector::from_fn(|_, _| 0.25 * (draw() + draw() + draw() + draw()) * 3.0_f64.sqrt());
        let waves: Vec<(Vector, Vector)> = (0..40).map(|_| (wave(), wave() * 20.0)).collect();
        move |x: &Vector| {
            let one = |(wave, phase): &(Vector, Vector)| (wave.dot(x) + phase.sum()).sin();
            0.3 * waves.iter().map(one).sum::<f64>() / 20.0_f64.sqrt()
        }
    }

    fn aligned(fixed: &TriangleSurface, moving: &TriangleSurface) -> SurfaceAlignment {
        IterativeClosestPoint::default().align(fixed, moving, &Unobserved).unwrap()
    }

    #[test]
    fn the_cap_of_a_sphere_does_not_determine_its_rotation() {
        let found = aligned(&ball(60.0, 24, |_| 0.0), &ball(60.0, 21, |_| 0.0));
        assert!(found.rms < 0.02, "{found:?}");
        let error =
            found.uncertainty.map(|own| StandardError::of_points(&own, &[Vector::z() * 40.0]));
        // Nothing says how far: free, or by several degrees, of which the skin on it is told.
        assert!(error.is_none_or(|error| error.rotation.to_degrees() > 2.0), "{error:?}");
        let skin = [Vector::new(0.0, 50.0, 0.0)];
        let error = found.uncertainty.map(|own| StandardError::of_points(&own, &skin));
        let told = undetermined("the place", error.as_ref()).unwrap();
        assert_eq!(told.code, "registration-undetermined");
    }

    #[test]
    fn a_plane_is_free_and_has_no_number() {
        let at = |i: usize| Vector::new((i % 40) as f64, (i / 40) as f64, 0.0);
        let plane = (0..1600).map(|i| Observation { point: at(i), normal: Vector::z(), area: 1.0 });
        assert_eq!(RigidUncertainty::new(&plane.collect::<Vec<_>>(), 0.1), None);
        let told = undetermined("the place", None).unwrap();
        assert!(told.numbers.is_empty(), "{told:?}");
    }

    #[test]
    fn what_noise_does_to_a_bumpy_ball_is_of_the_order_of_its_standard_error() {
        let fixed = ball(180.0, 40, bumps);
        let (mut turned, mut moved, mut stated) = (0.0, 0.0, [0.0; 2]);
        const SEEDS: u64 = 6;
        for seed in 0..SEEDS {
            let noise = noise(seed);
            let moving = ball(180.0, 37, |x| bumps(x) + noise(x));
            let found = aligned(&fixed, &moving);
            let top = Vector::z() * 40.0;
            let error = StandardError::of_points(&found.uncertainty.unwrap(), &[top]);
            assert!(undetermined("the place", Some(&error)).is_none(), "{error:?}");
            turned += found.transform.angle().powi(2);
            moved += (found.transform.apply(&top) - top).norm_squared();
            stated = [stated[0] + error.rotation.powi(2), stated[1] + error.displacement.powi(2)];
        }
        for (found, stated) in [(turned, stated[0]), (moved, stated[1])] {
            let ratio = (found / stated).sqrt();
            assert!((0.4..2.5).contains(&ratio), "{ratio}");
        }
    }
}
