//! A sheet that carries tension only: it wrinkles, as finely as one likes and for nothing, where it would be pressed.
//!
//! What it stores at a strain E is the least over all strains that wrinkles add, and by duality the most over all stresses without pressure:
//!   W(E) = min_{N >= 0} (E + N):C:(E + N) / 2 = max_{S >= 0} S:E - S:C^-1:S / 2,
//! which is convex in E. The sheet is
//!   taut,     S = C:E, where that presses in no direction;
//!   slack,    S = 0, where no direction is stretched;
//!   wrinkled, S = e/a t t^T otherwise, with e = t.E t and 1/a the stiffness against a pull along t, a = t t^T : C^-1 : t t^T, and the
//!             direction t in which e^2 / (2 a) is largest; isotropic: that of the largest strain, and 1/a Young's modulus.
//! The tangent of a wrinkled sheet has that of its turning direction: with F(E, theta) = e^2 / (2 a) it is F_EE - F_Et F_tE / F_tt.
//!
//! Source: Reissner, On tension field theory, Proceedings of the 5th International Congress for Applied Mechanics, 1938; Pipkin, The
//! relaxed energy density for isotropic elastic membranes, IMA Journal of Applied Mathematics 36, 1986 (docs/methods.md#membrane).

use std::f64::consts::PI;

use nalgebra::{Matrix2, Matrix3, Matrix3x2, Vector3};

use super::ElasticTensor;

/// Stresses (11, 22, 12) and strains (11, 22, twice 12) in the plane.
pub type InPlane = Vector3<f64>;

/// Directions that are looked at before the best of them is made better, and how often that is.
const DIRECTIONS: usize = 24;
const MOST_STEPS: usize = 60;

/// A state of such a sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TensionField {
    /// In kPa.
    pub energy: f64,
    /// In kPa.
    pub stress: InPlane,
    /// In kPa.
    pub tangent: Matrix3<f64>,
}

impl TensionField {
    /// At a strain, for a positive definite stiffness in kPa.
    pub fn at(stiffness: &Matrix3<f64>, strain: &InPlane) -> Self {
        let stress = stiffness * strain;
        if presses_nowhere(&stress) {
            return TensionField { energy: 0.5 * stress.dot(strain), stress, tangent: *stiffness };
        }
        let compliance = stiffness.try_inverse().unwrap_or_default();
        let along = |angle: f64| Pull::new(&compliance, strain, angle);
        let spacing = PI / DIRECTIONS as f64;
        let angles = (0..DIRECTIONS).map(|k| k as f64 * spacing);
        let best =
            angles.max_by(|one, other| along(*one).energy().total_cmp(&along(*other).energy()));
        let best = best.unwrap_or_default();
        // The slope falls between the two neighbours of the best one.
        let (mut low, mut high) = (best - spacing, best + spacing);
        let mut angle = best;
        for _ in 0..MOST_STEPS {
            let own = along(angle);
            let (slope, bend) = (own.slope(), own.bend());
            if slope > 0.0 {
                low = angle;
            } else {
                high = angle;
            }
            let newton = angle - slope / bend;
            let next = if bend < 0.0 && newton > low && newton < high {
                newton
            } else {
                0.5 * (low + high)
            };
            if next == angle || slope == 0.0 {
                break;
            }
            angle = next;
        }
        along(angle).field()
    }
}

/// A sheet that bears no compression, in a plane in space.
#[derive(Clone)]
pub struct TensionOnly {
    /// Two directions in its plane.
    axes: Matrix3x2<f64>,
    /// C in these: stresses 11, 22, 12 of strains 11, 22 and twice 12.
    stiffness: Matrix3<f64>,
    /// The strain that the stress at rest is that of.
    before: InPlane,
}

impl TensionOnly {
    /// Of a sheet whose stiffness and stress at rest, in kPa, are given, in the plane of this normal and a direction in it, both of length 1.
    pub fn new(
        tensor: &ElasticTensor,
        tension: f64,
        along: Vector3<f64>,
        normal: Vector3<f64>,
    ) -> Self {
        let across = normal.cross(&along);
        let shear = (along * across.transpose() + across * along.transpose()) * 0.5;
        let strains = [along * along.transpose(), across * across.transpose(), shear];
        let stiffness = Matrix3::from_columns(&strains.map(|strain| {
            let stress = tensor.stress(&strain);
            let [a, b] = [stress * along, stress * across];
            InPlane::new(along.dot(&a), across.dot(&b), along.dot(&b))
        }));
        let before =
            stiffness.try_inverse().unwrap_or_default() * InPlane::new(tension, tension, 0.0);
        TensionOnly { axes: Matrix3x2::from_columns(&[along, across]), stiffness, before }
    }

    /// After a strain in the plane.
    pub fn at(&self, strain: &Matrix3<f64>) -> TensionField {
        let own = self.axes.transpose() * strain * self.axes;
        let own = InPlane::new(own[(0, 0)], own[(1, 1)], 2.0 * own[(0, 1)]);
        TensionField::at(&self.stiffness, &(own + self.before))
    }

    /// A stress of it.
    pub fn in_space(&self, stress: &InPlane) -> Matrix3<f64> {
        let own = Matrix2::new(stress.x, stress.z, stress.z, stress.y);
        self.axes * own * self.axes.transpose()
    }

    /// Two directions in its plane.
    pub fn axes(&self) -> &Matrix3x2<f64> {
        &self.axes
    }

    /// In kPa, of the stress at rest.
    pub fn energy_at_rest(&self) -> f64 {
        0.5 * self.before.dot(&(self.stiffness * self.before))
    }
}

/// Whether a stress has no principal value below 0.
fn presses_nowhere(stress: &InPlane) -> bool {
    let [a, b, c] = [stress.x, stress.y, stress.z];
    a >= 0.0 && b >= 0.0 && a * b >= c * c
}

/// A pull along one direction: values and their derivatives by its angle.
struct Pull {
    /// t t^T.
    along: [InPlane; 3],
    /// e.
    strain: [f64; 3],
    /// a.
    compliance: [f64; 3],
}

impl Pull {
    fn new(compliance: &Matrix3<f64>, strain: &InPlane, angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        let along = [
            InPlane::new(cos * cos, sin * sin, sin * cos),
            InPlane::new(-2.0 * sin * cos, 2.0 * sin * cos, cos * cos - sin * sin),
            InPlane::new(sin * sin - cos * cos, cos * cos - sin * sin, -2.0 * sin * cos) * 2.0,
        ];
        let [t, by] = [along[0], along[1]].map(|own| compliance * own);
        let compliance = [
            along[0].dot(&t),
            2.0 * along[1].dot(&t),
            2.0 * (along[2].dot(&t) + along[1].dot(&by)),
        ];
        Pull { along, strain: along.map(|own| own.dot(strain)), compliance }
    }

    /// 0 where the direction is not stretched.
    fn energy(&self) -> f64 {
        let [e, a] = [self.strain[0].max(0.0), self.compliance[0]];
        0.5 * e * e / a
    }

    fn slope(&self) -> f64 {
        let ([e, e1, _], [a, a1, _]) = (self.strain, self.compliance);
        e * e1 / a - 0.5 * e * e * a1 / (a * a)
    }

    fn bend(&self) -> f64 {
        let ([e, e1, e2], [a, a1, a2]) = (self.strain, self.compliance);
        (e1 * e1 + e * e2) / a - (2.0 * e * e1 * a1 + 0.5 * e * e * a2) / (a * a)
            + e * e * a1 * a1 / (a * a * a)
    }

    /// The state of a sheet that is wrinkled along this direction, or slack.
    fn field(&self) -> TensionField {
        let ([e, e1, _], [a, a1, _]) = (self.strain, self.compliance);
        if e <= 0.0 {
            return TensionField {
                energy: 0.0,
                stress: InPlane::zeros(),
                tangent: Matrix3::zeros(),
            };
        }
        let [t, by, _] = self.along;
        let turning = t * (e1 / a - e * a1 / (a * a)) + by * (e / a);
        let fixed = t * t.transpose() / a;
        let bend = self.bend();
        let turned =
            if bend < 0.0 { turning * turning.transpose() / bend } else { Matrix3::zeros() };
        TensionField { energy: self.energy(), stress: t * (e / a), tangent: fixed - turned }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Isotropic, and four times as stiff along the first axis.
    fn stiffnesses() -> [Matrix3<f64>; 2] {
        let (e, nu) = (200.0, 0.45);
        let of = |along: f64| {
            let d = 1.0 - nu * nu * e / along;
            let [a, b, c] = [along / d, e / d, nu * e / d];
            Matrix3::new(a, c, 0.0, c, b, 0.0, 0.0, 0.0, 0.5 * e / (1.0 + nu))
        };
        [of(e), of(4.0 * e)]
    }

    /// Taut, slack and wrinkled, in axes and turned.
    fn strains() -> [InPlane; 5] {
        [
            [0.1, 0.05, 0.02],
            [-0.1, -0.08, 0.05],
            [0.1, -0.2, 0.0],
            [0.03, -0.1, 0.2],
            [-0.2, 0.1, -0.3],
        ]
        .map(InPlane::from)
    }

    #[test]
    fn stress_and_tangent_are_the_derivatives_of_the_energy() {
        let step = 1e-6;
        for stiffness in stiffnesses() {
            for strain in strains() {
                let own = TensionField::at(&stiffness, &strain);
                for k in 0..3 {
                    let ends = [step, -step].map(|by| {
                        let mut moved = strain;
                        moved[k] += by;
                        TensionField::at(&stiffness, &moved)
                    });
                    let stress = (ends[0].energy - ends[1].energy) / (2.0 * step);
                    assert!((stress - own.stress[k]).abs() < 1e-6, "{strain:?} {stress} {own:?}");
                    let tangent = (ends[0].stress - ends[1].stress) / (2.0 * step);
                    let off = (tangent - own.tangent.column(k)).norm();
                    assert!(off < 1e-4, "{strain:?} {tangent:?} {own:?}");
                }
                assert!(own.tangent.symmetric_eigenvalues().min() > -1e-9, "{own:?}");
                assert!(presses_nowhere(&(own.stress + InPlane::new(1e-9, 1e-9, 0.0))), "{own:?}");
            }
        }
    }

    #[test]
    fn an_isotropic_sheet_wrinkles_across_its_largest_strain_and_pulls_with_youngs_modulus() {
        let [stiffness, _] = stiffnesses();
        // Principal strains .1 and -.2: with nu .45 the sheet would narrow by .045 only.
        let own = TensionField::at(&stiffness, &InPlane::new(0.1, -0.2, 0.0));
        assert!((own.stress - InPlane::new(20.0, 0.0, 0.0)).norm() < 1e-9, "{own:?}");
        let (sin, cos) = 0.4_f64.sin_cos();
        let turned = InPlane::new(
            0.1 * cos * cos - 0.2 * sin * sin,
            0.1 * sin * sin - 0.2 * cos * cos,
            2.0 * 0.3 * sin * cos,
        );
        let other = TensionField::at(&stiffness, &turned);
        assert!((other.energy - own.energy).abs() < 1e-9 && (own.energy - 1.0).abs() < 1e-9);
        // That of a sheet which narrows by less is taut.
        let taut = InPlane::new(0.1, -0.04, 0.0);
        assert_eq!(TensionField::at(&stiffness, &taut).stress, stiffness * taut);
    }
}
