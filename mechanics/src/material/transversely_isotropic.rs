//! Tissue with one fibre direction: stiffness E_f along it, E_t across, nu, and a shear modulus.
//!
//! Engineering constants (docs/methods.md#fibres; Chabanas et al. 2003 give E_f and E_t of muscle), fibre along axis 1:
//!   S11 = 1/E_f, S12 = S13 = -nu/E_f, S22 = S33 = 1/E_t, S23 = -nu_tt/E_t, C44 = C55 = G_ft,
//!   nu_tt = 1 - (1 - nu) E_t/E_f.
//! With this nu_tt pressure changes the volume alone, S 1 = 1/(3K) 1 with K = E_f / (3 (1 - 2 nu)), so that
//! C follows without a matrix to invert:
//!   mu = E_t / (2 (1 + nu_tt)), dmu = G_ft - mu, q = 3 (E_f / (2 (1 + nu)) - mu),
//!   beta = q - 4 dmu, dlam = -q/3, lambda = K - 2/3 mu + q/9.
//! Positive definite for 0 <= nu < 1/2 where E_f > E_t (1 - nu) / 2, and isotropic for E_f = E_t.
//!
//! Kim et al. 2012 (eq. 33, corrected: docs/methods.md#fibres) have lambda, mu of E_t and nu, and lambda_a, mu_a of
//! E_f and the same nu: dlam = lambda_a - lambda, dmu = mu_a - mu, beta = -(dlam + 2 dmu). Its moduli along and across
//! are not E_f and E_t, and from E_f/E_t = (1 - nu) / (2 nu^2) on its energy has no lowest value.

use super::elastic_tensor::{AlongFibre, ElasticTensor, FibreModuli};
use super::error::{MaterialError, is_modulus};
use super::isotropic::Isotropic;
use super::mixing_rule::MixingRule;
use nalgebra::{Matrix2, Vector3};
use std::f64::consts::SQRT_2;

/// How moduli along and across the fibre become a stiffness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FibreLaw {
    /// Moduli along and across that a block pulled along and across shows.
    #[default]
    Engineering,
    /// Lamé constants from each modulus with one nu: the law of Kim et al. 2012, corrected.
    Kim2012,
}

/// Constants of fibres, beside those of the tissue across them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fibre {
    /// E_f in kPa, in [1e-9, 1e9].
    pub young_modulus: f64,
    /// G_ft in kPa, in [1e-9, 1e9]; absent: E_t / (2 (1 + nu)). The law of Kim et al. 2012 has none.
    pub shear_modulus: Option<f64>,
    pub law: FibreLaw,
}

/// A positive definite stiffness about a fibre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransverselyIsotropic {
    /// E_f in kPa.
    young_modulus: f64,
    lambda: f64,
    mu: f64,
    moduli: FibreModuli,
}

impl TransverselyIsotropic {
    /// Fibres in a tissue with these constants across them.
    pub fn new(across: &Isotropic, fibre: &Fibre) -> Result<Self, MaterialError> {
        if !is_modulus(fibre.young_modulus) {
            return Err(MaterialError::FibreModulus(fibre.young_modulus));
        }
        if let Some(shear) = fibre.shear_modulus.filter(|&shear| !is_modulus(shear)) {
            return Err(MaterialError::FibreShear(shear));
        }
        let stiffness = match fibre.law {
            FibreLaw::Engineering => engineering(across, fibre)?,
            FibreLaw::Kim2012 if fibre.shear_modulus.is_some() => {
                return Err(MaterialError::ShearModulusOfKimLaw);
            }
            FibreLaw::Kim2012 => kim_2012(across, fibre),
        };
        let smallest = stiffness.along(&Vector3::x()).smallest_eigenvalue();
        if smallest.is_nan() || smallest <= 0.0 {
            let nu = across.poisson_ratio;
            return Err(MaterialError::NotPositiveDefinite {
                ratio: fibre.young_modulus / across.young_modulus,
                poisson_ratio: nu,
                eigenvalue: smallest,
                limit: limit(nu),
            });
        }
        Ok(stiffness)
    }

    /// Isotropic tissue, as if it had fibres.
    pub(super) fn isotropic(tissue: &Isotropic) -> Self {
        TransverselyIsotropic {
            young_modulus: tissue.young_modulus,
            lambda: tissue.lambda(),
            mu: tissue.shear_modulus(),
            moduli: FibreModuli::default(),
        }
    }

    /// C of parts with these shares about one fibre direction, which is positive definite as they are: by Voigt sum_i f_i C_i, by
    /// Reuss the inverse of sum_i f_i C_i^-1, and the exponential of sum_i f_i ln C_i. E_f is a mean by the same rule: what is told
    /// of the mixture, and not what a block of it would show.
    pub(super) fn mixture(parts: &[(f64, TransverselyIsotropic)], rule: MixingRule) -> Self {
        let terms = |of: fn(&TransverselyIsotropic) -> f64| {
            parts.iter().map(move |(share, part)| (*share, of(part)))
        };
        let young_modulus = rule.mean(terms(|part| part.young_modulus));
        if rule != MixingRule::Voigt {
            let normal = rule.matrix_mean(parts.iter().map(|(f, part)| (*f, part.normal())));
            let across = rule.mean(terms(|part| 2.0 * part.mu));
            let along = rule.mean(terms(|part| 2.0 * part.shear_modulus()));
            return Self::of_parts(young_modulus, normal, [across, along]);
        }
        let mean = |of: fn(&TransverselyIsotropic) -> f64| rule.mean(terms(of));
        TransverselyIsotropic {
            young_modulus,
            lambda: mean(|part| part.lambda),
            mu: mean(|part| part.mu),
            moduli: FibreModuli {
                delta_lambda: mean(|part| part.moduli.delta_lambda),
                delta_mu: mean(|part| part.moduli.delta_mu),
                beta: mean(|part| part.moduli.beta),
            },
        }
    }

    /// C between the two strains that it couples, (1, sqrt 2) / sqrt 3, which is a change of volume, and (sqrt 2, -1) / sqrt 3, of
    /// the strain along the fibre and sqrt 1/2 of both across it. Shear across and along the fibre, 2 mu and 2 (mu + dmu), go by
    /// themselves (Walpole 1984), so that a function of C is that of these three.
    fn normal(&self) -> Matrix2<f64> {
        let FibreModuli { delta_lambda: mixed, delta_mu, beta } = self.moduli;
        let across = 2.0 * self.mu;
        let along = across + 2.0 * mixed + 4.0 * delta_mu + beta;
        let coupled = SQRT_2 * (along + mixed - across) / 3.0;
        let volume = 3.0 * self.lambda + (along + 4.0 * mixed + 2.0 * across) / 3.0;
        Matrix2::new(volume, coupled, coupled, (2.0 * along - 4.0 * mixed + across) / 3.0)
    }

    /// The stiffness of these three.
    fn of_parts(young_modulus: f64, normal: Matrix2<f64>, [across, along_shear]: [f64; 2]) -> Self {
        let mixed = (SQRT_2 * normal[(0, 1)] + across - normal[(1, 1)]) / 2.0;
        let along = 3.0 / SQRT_2 * normal[(0, 1)] - mixed + across;
        let lambda = (normal[(0, 0)] - (along + 4.0 * mixed + 2.0 * across) / 3.0) / 3.0;
        let mu = across / 2.0;
        let delta_mu = along_shear / 2.0 - mu;
        let beta = along - across - 2.0 * mixed - 4.0 * delta_mu;
        let moduli = FibreModuli { delta_lambda: mixed, delta_mu, beta };
        TransverselyIsotropic { young_modulus, lambda, mu, moduli }
    }

    /// E_f in kPa.
    pub fn young_modulus(&self) -> f64 {
        self.young_modulus
    }

    /// Between the fibre and what lies across it, in kPa.
    pub fn shear_modulus(&self) -> f64 {
        self.mu + self.moduli.delta_mu
    }

    /// C with the fibre along a direction of length 1.
    pub fn along(&self, direction: &Vector3<f64>) -> ElasticTensor {
        let fibre = AlongFibre { direction: *direction, moduli: self.moduli };
        ElasticTensor { lambda: self.lambda, mu: self.mu, fibre: Some(fibre) }
    }
}

/// E_f/E_t from which on the law of Kim et al. 2012 is indefinite.
fn limit(nu: f64) -> f64 {
    (1.0 - nu) / (2.0 * nu * nu)
}

fn engineering(across: &Isotropic, fibre: &Fibre) -> Result<TransverselyIsotropic, MaterialError> {
    let (along, across_modulus, nu) =
        (fibre.young_modulus, across.young_modulus, across.poisson_ratio);
    if along <= across_modulus * (1.0 - nu) / 2.0 {
        return Err(MaterialError::FibreTooSoft {
            along,
            across: across_modulus,
            least: across_modulus * (1.0 - nu) / 2.0,
        });
    }
    let nu_tt = 1.0 - (1.0 - nu) * across_modulus / along;
    let mu = across_modulus / (2.0 * (1.0 + nu_tt));
    let bulk = along / (3.0 * (1.0 - 2.0 * nu));
    let delta_mu = fibre.shear_modulus.unwrap_or_else(|| across.shear_modulus()) - mu;
    let q = 3.0 * (along / (2.0 * (1.0 + nu)) - mu);
    Ok(TransverselyIsotropic {
        young_modulus: along,
        lambda: bulk - 2.0 / 3.0 * mu + q / 9.0,
        mu,
        moduli: FibreModuli { delta_lambda: -q / 3.0, delta_mu, beta: q - 4.0 * delta_mu },
    })
}

fn kim_2012(across: &Isotropic, fibre: &Fibre) -> TransverselyIsotropic {
    let along = Isotropic { young_modulus: fibre.young_modulus, ..*across };
    let delta_lambda = along.lambda() - across.lambda();
    let delta_mu = along.shear_modulus() - across.shear_modulus();
    let beta = -(delta_lambda + 2.0 * delta_mu);
    let moduli = FibreModuli { delta_lambda, delta_mu, beta };
    TransverselyIsotropic {
        young_modulus: fibre.young_modulus,
        lambda: across.lambda(),
        mu: across.shear_modulus(),
        moduli,
    }
}
