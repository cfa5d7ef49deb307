//! Stress and tangent of a material point from the derivatives of its energy.
//!
//! With g_a the gradient of a shape function at rest, k_a = F g_a and h_a = F^-T g_a, the derivatives of the invariants along
//! a displacement of node a are dI1 = 2 k_a, dI2 = 2 (I1 k_a - B k_a), dJ = J h_a, with B = F F^T, and the second ones
//!   d2I1 = 2 (g_a . g_b) I,
//!   d2I2 = 2 (2 k_a k_b^T - k_b k_a^T + (I1 g_a . g_b - k_a . k_b) I - (g_a . g_b) B),
//!   d2J = J (h_a h_b^T - h_b h_a^T)
//! For any W the force on node a is V P g_a, the block of nodes a and b
//! V (sum_i W_i d2I_i + sum_ij W_ij dI_i dI_j^T).

use nalgebra::{Matrix3, Vector3};

use super::principal::Principal;
use super::{Derivatives, Fibres, Invariants, Law, VolumeEnergy};

/// Fibres at a point: their law and their direction at rest, of length 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FibreAtPoint<'a> {
    pub law: &'a Fibres,
    pub direction: Vector3<f64>,
}

/// A part of the bulk modulus that a pressure carries in place of the law: W + p ln J - c/2 ln^2 J instead of W.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressureShare {
    /// p in kPa; c ln J where it is that of the point itself.
    pub pressure: f64,
    /// c in kPa.
    pub modulus: f64,
}

/// A part U(J) of the energy of volume that the mean of J over a cell carries: W - U(J) + p J instead of W at its points, U at
/// the mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanShare {
    /// p = U' of the mean in kPa.
    pub pressure: f64,
    pub energy: VolumeEnergy,
}

/// A deformed material point.
#[derive(Clone, Debug)]
pub struct Point {
    f: Matrix3<f64>,
    invariants: Invariants,
    w: Derivatives,
    /// J F^-T.
    cofactor: Matrix3<f64>,
    /// F F^T.
    left: Matrix3<f64>,
    fibres: Option<FibresAt>,
    principal: Option<Box<Principal>>,
    pull: Option<Box<Pull>>,
}

/// Active stress at a point: its energy S : (C - 1) / 2 and its second Piola-Kirchhoff stress S, in kPa.
#[derive(Clone, Debug)]
struct Pull {
    energy: f64,
    stress: Matrix3<f64>,
}

#[derive(Clone, Debug)]
struct FibresAt {
    direction: Vector3<f64>,
    /// F a.
    turned: Vector3<f64>,
    energy: f64,
    first: f64,
    second: f64,
}

/// Data of a shape function at a point.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    g: Vector3<f64>,
    k: Vector3<f64>,
    /// dI2 / 2.
    second: Vector3<f64>,
    /// dJ.
    volume: Vector3<f64>,
    along: f64,
}

impl Point {
    /// `f` has a positive determinant.
    #[inline]
    pub fn new(law: &Law, fibres: Option<FibreAtPoint>, f: Matrix3<f64>) -> Point {
        let invariants = Invariants::of(&f);
        let fibres = fibres.map(|along| {
            let turned = f * along.direction;
            let w = along.law.at(turned.norm_squared());
            let direction = along.direction;
            FibresAt { direction, turned, energy: w.energy, first: w.first, second: w.second }
        });
        let of_stretches = |law| Box::new(Principal::new(law, &f, invariants.j));
        Point {
            principal: law.in_stretches().map(of_stretches),
            w: law.at(&invariants),
            cofactor: cofactor(&f),
            left: f * f.transpose(),
            f,
            invariants,
            fibres,
            pull: None,
        }
    }

    /// The same point with an active second Piola-Kirchhoff stress in kPa beside that of its law.
    #[inline]
    pub fn pulled(mut self, stress: Option<&Matrix3<f64>>) -> Point {
        self.pull = stress.map(|stress| {
            Box::new(Pull { energy: stress.dot(&self.green_strain()), stress: *stress })
        });
        self
    }

    /// The same point with a pressure for a part of its bulk modulus.
    #[inline]
    pub fn carried(mut self, by: PressureShare) -> Point {
        let (j, log) = (self.invariants.j, self.log_volume());
        let left = by.pressure - by.modulus * log;
        self.w.energy += (by.pressure - 0.5 * by.modulus * log) * log;
        self.w.by_j += left / j;
        self.w.by_j_j -= (by.modulus + left) / (j * j);
        self
    }

    /// The same point with a part of its energy of volume taken at the mean of its cell.
    #[inline]
    pub fn of_mean(mut self, by: MeanShare) -> Point {
        let j = self.invariants.j;
        let own = by.energy.at(j);
        self.w.energy += by.pressure * j - own.energy;
        self.w.by_j += by.pressure - own.first;
        self.w.by_j_j -= own.second;
        self
    }

    /// ln det F.
    #[inline]
    pub fn log_volume(&self) -> f64 {
        self.invariants.j.ln()
    }

    /// Energy density in kPa.
    pub fn energy(&self) -> f64 {
        let fibres = self.fibres.as_ref().map_or(0.0, |fibres| fibres.energy);
        let principal = self.principal.as_ref().map_or(0.0, |principal| principal.energy);
        self.w.energy + fibres + principal + self.pull.as_ref().map_or(0.0, |pull| pull.energy)
    }

    /// The energy without that of active stress, which falls as muscles shorten.
    pub fn passive_energy(&self) -> f64 {
        self.energy() - self.pull.as_ref().map_or(0.0, |pull| pull.energy)
    }

    /// det F.
    pub fn volume(&self) -> f64 {
        self.invariants.j
    }

    /// First Piola-Kirchhoff stress P = dW/dF in kPa.
    #[inline]
    pub fn stress(&self) -> Matrix3<f64> {
        let w = &self.w;
        let mut stress = self.f * (2.0 * w.by_i1) + self.cofactor * w.by_j;
        if w.by_i2 != 0.0 {
            stress += (self.f * self.invariants.i1 - self.left * self.f) * (2.0 * w.by_i2);
        }
        if let Some(fibres) = &self.fibres {
            stress += fibres.turned * fibres.direction.transpose() * (2.0 * fibres.first);
        }
        if let Some(principal) = &self.principal {
            stress += self.f * principal.second_stress;
        }
        if let Some(pull) = &self.pull {
            stress += self.f * pull.stress;
        }
        stress
    }

    /// Kirchhoff's stress P F^T = J sigma in kPa.
    pub fn kirchhoff(&self) -> Matrix3<f64> {
        self.stress() * self.f.transpose()
    }

    /// F S F^T of a second Piola-Kirchhoff stress S in kPa.
    pub fn pushed(&self, second: &Matrix3<f64>) -> Matrix3<f64> {
        self.f * second * self.f.transpose()
    }

    /// Green's strain E = (F^T F - 1) / 2.
    pub fn green_strain(&self) -> Matrix3<f64> {
        (self.f.transpose() * self.f - Matrix3::identity()) * 0.5
    }

    /// For the gradient of a shape function at rest.
    #[inline]
    pub fn corner(&self, g: &Vector3<f64>) -> Corner {
        let k = self.f * g;
        Corner {
            g: *g,
            k,
            second: k * self.invariants.i1 - self.left * k,
            volume: self.cofactor * g,
            along: self.fibres.as_ref().map_or(0.0, |fibres| fibres.direction.dot(g)),
        }
    }

    /// d2W / du_a du_b, for each unit of volume.
    #[inline]
    pub fn block(&self, a: &Corner, b: &Corner) -> Matrix3<f64> {
        let w = &self.w;
        let gg = a.g.dot(&b.g);
        let by_volume = w.by_j / self.invariants.j;
        let column = b.volume * (w.by_j_j + by_volume)
            + b.k * (2.0 * w.by_i1_j)
            + b.second * (2.0 * w.by_i2_j);
        let mut block = a.volume * column.transpose() - b.volume * a.volume.transpose() * by_volume;
        let mut isotropic = 2.0 * w.by_i1 * gg;
        let first =
            b.k * (4.0 * w.by_i1_i1) + b.volume * (2.0 * w.by_i1_j) + b.second * (4.0 * w.by_i1_i2);
        block += a.k * first.transpose();
        if w.by_i2 != 0.0 || w.by_i1_i2 != 0.0 || w.by_i2_i2 != 0.0 {
            let second = b.k * (4.0 * w.by_i1_i2)
                + b.volume * (2.0 * w.by_i2_j)
                + b.second * (4.0 * w.by_i2_i2);
            block += a.second * second.transpose();
            let twice = 2.0 * w.by_i2;
            block += (a.k * b.k.transpose() * 2.0 - b.k * a.k.transpose() - self.left * gg) * twice;
            isotropic += twice * (self.invariants.i1 * gg - a.k.dot(&b.k));
        }
        if let Some(fibres) = &self.fibres {
            let both = a.along * b.along;
            isotropic += 2.0 * fibres.first * both;
            block += fibres.turned * fibres.turned.transpose() * (4.0 * fibres.second * both);
        }
        if let Some(principal) = &self.principal {
            block += principal.block(&a.g, &b.g);
        }
        if let Some(pull) = &self.pull {
            isotropic += a.g.dot(&(pull.stress * b.g));
        }
        for i in 0..3 {
            block[(i, i)] += isotropic;
        }
        block
    }
}

impl Corner {
    /// dJ / du.
    #[inline]
    pub fn of_volume(&self) -> Vector3<f64> {
        self.volume
    }

    /// d(ln J) / du at a point with that det F.
    #[inline]
    pub fn of_log_volume(&self, j: f64) -> Vector3<f64> {
        self.volume / j
    }
}

impl Law {
    /// Lambda and mu in kPa of the linear law that it agrees with at rest.
    pub fn at_rest(&self) -> (f64, f64) {
        let rest = Point::new(self, None, Matrix3::identity());
        let along = rest.corner(&Vector3::x());
        let across = rest.block(&rest.corner(&Vector3::y()), &rest.corner(&Vector3::y()));
        let mu = across[(0, 0)];
        (rest.block(&along, &along)[(0, 0)] - 2.0 * mu, mu)
    }
}

/// J F^-T, without a division.
#[inline]
pub fn cofactor(f: &Matrix3<f64>) -> Matrix3<f64> {
    let (x, y, z) = (f.column(0), f.column(1), f.column(2));
    Matrix3::from_columns(&[y.cross(&z), z.cross(&x), x.cross(&y)])
}
