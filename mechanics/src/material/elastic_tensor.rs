//! The stiffness C of a material point, isotropic or with one fibre direction a, |a| = 1.
//!
//! 2 W = lambda (tr E)^2 + 2 mu E:E + 2 dlam (a.Ea) tr E + 4 dmu a.E^2 a + beta (a.Ea)^2
//!
//! is the general transversely isotropic energy. Between two gradients of shape functions it is the block
//!
//! g_j.C.g_k = lambda g_j g_k^T + mu [ g_k g_j^T + (g_j.g_k) I ]
//!           + dlam [ (a.g_k) g_j a^T + (a.g_j) a g_k^T ] + beta (a.g_j)(a.g_k) a a^T
//!           + dmu [ (a.g_k) a g_j^T + (a.g_j) g_k a^T + (g_j.g_k) a a^T + (a.g_j)(a.g_k) I ]
//!
//! Source: Spencer 1984; Kim et al. 2012, eq. 33, in its corrected form (docs/methods.md#fibres), has
//! beta = -(dlam + 2 dmu).

use nalgebra::{Matrix3, Vector3};

type Vector = Vector3<f64>;
type Block = [[f64; 3]; 3];

/// C of a material point, in kPa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticTensor {
    pub lambda: f64,
    pub mu: f64,
    /// Absent where the tissue is isotropic.
    pub fibre: Option<AlongFibre>,
}

/// Contribution of fibres to lambda and mu.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlongFibre {
    /// Of length 1.
    pub direction: Vector,
    pub moduli: FibreModuli,
}

/// dlam, dmu and beta in kPa.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FibreModuli {
    pub delta_lambda: f64,
    pub delta_mu: f64,
    pub beta: f64,
}

/// block += lambda g_j g_k^T + mu g_k g_j^T + mu (g_j . g_k) I, with moduli times the volume of a point.
#[inline(always)]
pub fn add_isotropic_pair(block: &mut Block, [gj, gk]: [&Vector; 2], lambda: f64, mu: f64) {
    let diagonal = mu * gj.dot(gk);
    for (r, row) in block.iter_mut().enumerate() {
        for (c, value) in row.iter_mut().enumerate() {
            *value += lambda * gj[r] * gk[c] + mu * gk[r] * gj[c];
        }
        row[r] += diagonal;
    }
}

impl ElasticTensor {
    pub fn isotropic(lambda: f64, mu: f64) -> Self {
        ElasticTensor { lambda, mu, fibre: None }
    }

    /// block += weight g_j.C.g_k; the weight is the volume that a point stands for.
    #[inline]
    pub fn add_pair(&self, block: &mut Block, [gj, gk]: [&Vector; 2], weight: f64) {
        add_isotropic_pair(block, [gj, gk], self.lambda * weight, self.mu * weight);
        if let Some(fibre) = &self.fibre {
            fibre.add_pair(block, [gj, gk], weight);
        }
    }

    /// The sum of w g_j.C.g_k over pairs of gradients, from G = sum w g_j g_k^T.
    #[inline]
    pub fn block(&self, products: &Matrix3<f64>) -> Matrix3<f64> {
        let both = products.trace();
        let mut block = products * self.lambda + products.transpose() * self.mu;
        let mut diagonal = self.mu * both;
        if let Some(AlongFibre { direction: a, moduli }) = &self.fibre {
            let FibreModuli { delta_lambda, delta_mu, beta } = *moduli;
            let (of_k, of_j) = (products * a, products.tr_mul(a));
            let along = a.dot(&of_k);
            block += (of_k * a.transpose() + a * of_j.transpose()) * delta_lambda
                + (a * of_k.transpose() + of_j * a.transpose()) * delta_mu
                + a * a.transpose() * (beta * along + delta_mu * both);
            diagonal += delta_mu * along;
        }
        (0..3).for_each(|k| block[(k, k)] += diagonal);
        block
    }

    /// C : grad u, of which only the symmetric part counts:
    ///
    /// lambda tr E + 2 mu E + dlam [ (a.Ea) 1 + tr E a a^T ] + 2 dmu (a (Ea)^T + Ea a^T) + beta (a.Ea) a a^T.
    #[inline]
    pub fn stress(&self, gradient: &Matrix3<f64>) -> Matrix3<f64> {
        let strain = (gradient + gradient.transpose()) * 0.5;
        let mut stress = strain * (2.0 * self.mu);
        let mut pressure = self.lambda * strain.trace();
        if let Some(AlongFibre { direction: a, moduli }) = &self.fibre {
            let along = strain * a;
            let stretch = a.dot(&along);
            pressure += moduli.delta_lambda * stretch;
            let on_fibre = moduli.delta_lambda * strain.trace() + moduli.beta * stretch;
            let shear = (a * along.transpose() + along * a.transpose()) * (2.0 * moduli.delta_mu);
            stress += a * a.transpose() * on_fibre + shear;
        }
        (0..3).for_each(|k| stress[(k, k)] += pressure);
        stress
    }

    /// C as a part that resists changes of shape alone and a part that counts with the change of volume:
    ///
    /// C = D C D + rest, D = identity - 1/3 (1 x 1), rest with mu = dmu = beta = 0.
    ///
    /// With q = beta + 4 dmu, D C D has lambda = q/9 - 2/3 mu and dlam = -q/3.
    pub fn split_volume(&self) -> (Self, Self) {
        let q = self.fibre.map_or(0.0, |fibre| fibre.moduli.beta + 4.0 * fibre.moduli.delta_mu);
        let lambda = q / 9.0 - 2.0 / 3.0 * self.mu;
        let of_shape = |fibre: AlongFibre| {
            let moduli = FibreModuli { delta_lambda: -q / 3.0, ..fibre.moduli };
            AlongFibre { moduli, ..fibre }
        };
        let of_volume = |fibre: AlongFibre| {
            let delta_lambda = fibre.moduli.delta_lambda + q / 3.0;
            AlongFibre { moduli: FibreModuli { delta_lambda, ..FibreModuli::default() }, ..fibre }
        };
        (
            ElasticTensor { lambda, mu: self.mu, fibre: self.fibre.map(of_shape) },
            ElasticTensor {
                lambda: self.lambda - lambda,
                mu: 0.0,
                fibre: self.fibre.map(of_volume),
            },
        )
    }

    /// The part lambda' (1 x 1) of C that a pressure p = lambda' div u can carry, so that what stays is
    /// positive definite:
    ///
    /// lambda' = K - 2/3 mu', 1/K = 1.S.1 with S = C^-1, mu' the smaller of the two shear moduli.
    ///
    /// C - lambda' (1 x 1) is positive definite as long as lambda' < K. Isotropic: lambda' = lambda, mu' = mu.
    /// Where it would be negative there is no such part.
    pub fn pressure_part(&self) -> PressurePart {
        let Some(fibre) = &self.fibre else {
            return PressurePart { lambda: self.lambda, mu: self.mu };
        };
        let shear = self.mu.min(self.mu + fibre.moduli.delta_mu);
        let WithoutLambda { along, mixed, across } = self.without_lambda();
        let bulk = self.lambda
            + (along * across - 2.0 * mixed * mixed) / (2.0 * along + across - 4.0 * mixed);
        PressurePart { lambda: (bulk - 2.0 / 3.0 * shear).max(0.0), mu: shear }
    }

    /// The smallest eigenvalue of the 6 x 6 matrix of C in kPa, shear strains as angles.
    pub fn smallest_eigenvalue(&self) -> f64 {
        let delta_mu = self.fibre.map_or(0.0, |fibre| fibre.moduli.delta_mu);
        let WithoutLambda { along, mixed, across } = self.without_lambda();
        // Of the normal strains e1 and e2 = e3 these two remain: (C11, sqrt 2 C12; sqrt 2 C12, C22 + C23).
        // Their determinant is linear in lambda, which keeps it exact where lambda is large.
        let determinant = self.lambda * (across + 2.0 * along - 4.0 * mixed) + along * across
            - 2.0 * mixed * mixed;
        let (c11, c12, c22_c23) =
            (self.lambda + along, self.lambda + mixed, 2.0 * self.lambda + across);
        let spread = ((c11 - c22_c23) / 2.0).hypot(std::f64::consts::SQRT_2 * c12);
        let normal = determinant / ((c11 + c22_c23) / 2.0 + spread);
        normal.min(self.mu).min(self.mu + delta_mu)
    }

    fn without_lambda(&self) -> WithoutLambda {
        let FibreModuli { delta_lambda, delta_mu, beta } =
            self.fibre.map_or_else(FibreModuli::default, |fibre| fibre.moduli);
        WithoutLambda {
            along: 2.0 * (self.mu + delta_lambda) + beta + 4.0 * delta_mu,
            mixed: delta_lambda,
            across: 2.0 * self.mu,
        }
    }
}

/// Entries without lambda: C11 - lambda, C12 - lambda and C22 + C23 - 2 lambda with the fibre along the first axis.
struct WithoutLambda {
    along: f64,
    mixed: f64,
    across: f64,
}

/// The part of C that a pressure carries, and the shear modulus that belongs to it, in kPa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressurePart {
    pub lambda: f64,
    pub mu: f64,
}

impl AlongFibre {
    #[inline]
    fn add_pair(&self, block: &mut Block, [gj, gk]: [&Vector; 2], weight: f64) {
        let a = &self.direction;
        let FibreModuli { delta_lambda, delta_mu, beta } = self.moduli;
        let (dlam, dmu) = (delta_lambda * weight, delta_mu * weight);
        let (aj, ak) = (a.dot(gj), a.dot(gk));
        let diagonal = dmu * aj * ak;
        let both = beta * weight * aj * ak + dmu * gj.dot(gk);
        for (r, row) in block.iter_mut().enumerate() {
            for (c, value) in row.iter_mut().enumerate() {
                *value += dlam * (ak * gj[r] * a[c] + aj * a[r] * gk[c])
                    + dmu * (ak * a[r] * gj[c] + aj * gk[r] * a[c])
                    + both * a[r] * a[c];
            }
            row[r] += diagonal;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stress_along_a_gradient_is_the_block_of_two_gradients() {
        // C : (v g_k^T) g_j is the block of j and k times v.
        let moduli = FibreModuli { delta_lambda: 3.0, delta_mu: 5.0, beta: 11.0 };
        let direction = Vector::new(0.36, 0.48, -0.8);
        let fibre = Some(AlongFibre { direction, moduli });
        let (gj, gk) = (Vector::new(0.2, -1.0, 0.7), Vector::new(1.1, 0.4, -0.3));
        let v = Vector::new(-0.6, 0.9, 1.7);
        for fibre in [None, fibre] {
            let tensor = ElasticTensor { lambda: 7.0, mu: 2.0, fibre };
            let mut block = [[0.0; 3]; 3];
            tensor.add_pair(&mut block, [&gj, &gk], 1.0);
            let expected = Matrix3::from_fn(|i, j| block[i][j]) * v;
            let found = tensor.stress(&(v * gk.transpose())) * gj;
            assert!((found - expected).norm() < 1e-13, "{found} {expected}");
            let of_products = tensor.block(&(gj * gk.transpose())) * v;
            assert!((of_products - expected).norm() < 1e-13, "{of_products} {expected}");
        }
    }
}
