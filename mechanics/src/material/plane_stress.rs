//! A thin sheet that carries stress in its plane only, isotropic or stiffer along lines a in it.
//!
//! sigma = C eps with C11 = E_f / d, C22 = E_t / d, C12 = nu E_t / d, C66 = E_t / (2 (1 + nu)),
//! d = 1 - nu^2 E_t / E_f, the first axis along a; isotropic: E_f = E_t. nu is what the sheet narrows by when it
//! is stretched along a. In the words of `elastic_tensor`, restricted to the plane:
//!   mu = C66, lambda = C22 - 2 C66, dlam = C12 - lambda, dmu = 0, beta = C11 - C22 - 2 dlam.
//!
//! Source: Timoshenko, Goodier, Theory of Elasticity, 3rd ed., 1970, section 7; orthotropic: Jones, Mechanics of
//! Composite Materials, 2nd ed., 1999, section 2.4. Skin as such a sheet, stiffer along Langer's lines: Zachow et
//! al. 2006, section 4.2 (docs/methods.md#membrane).

use super::elastic_tensor::{AlongFibre, ElasticTensor, FibreModuli};
use super::error::is_modulus;
use nalgebra::Vector3;

/// In mm.
const THICKNESSES: std::ops::RangeInclusive<f64> = 1e-3..=20.0;

/// In kPa.
const TENSIONS: std::ops::RangeInclusive<f64> = 0.0..=1000.0;

/// The least tension of a sheet that bears no compression, as a part of Young's modulus: below, Newton's method stalls at the kink of its
/// law.
const LEAST_TENSION: f64 = 5e-3;

/// A sheet of skin: what it is made of, and how thick it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneStress {
    thickness: f64,
    young_modulus: f64,
    lambda: f64,
    mu: f64,
    lines: Option<FibreModuli>,
    /// At rest, in kPa.
    tension: f64,
    bears_compression: bool,
}

/// Constants of a sheet, as stated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    /// In mm, in [1e-3, 20].
    pub thickness: f64,
    /// E_t in kPa, in [1e-9, 1e9].
    pub young_modulus: f64,
    /// In [0, 0.5].
    pub poisson_ratio: f64,
    /// E_f in kPa along the lines, in [1e-9, 1e9]; absent where the sheet is isotropic.
    pub along_lines: Option<f64>,
}

/// Why there is no such sheet.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SheetError {
    #[error("the thickness is {0} mm, and has to be at least 0.001 and at most 20 mm")]
    Thickness(f64),
    #[error("Young's modulus is {0} kPa, and has to be at least 1e-9 and at most 1e9 kPa")]
    YoungModulus(f64),
    #[error("Poisson's ratio is {0}, and has to be at least 0 and at most 0.5")]
    PoissonRatio(f64),
    #[error(
        "Young's modulus along the lines is {0} kPa, and has to be at least 1e-9 and at most 1e9 kPa"
    )]
    AlongLines(f64),
    #[error(
        "Young's modulus along the lines is {along} kPa, and has to be above nu^2 times the one across them, \
         {least} kPa"
    )]
    TooSoftAlongLines { along: f64, least: f64 },
    #[error("the tension at rest is {0} kPa, and has to be at least 0 and at most 1000 kPa")]
    Tension(f64),
    #[error(
        "the tension at rest is {tension} kPa, and a sheet that bears no compression needs at least a 200th of its Young's modulus, \
         {least} kPa: without, it is taut and slack at once where nothing moves it"
    )]
    TooSlack { tension: f64, least: f64 },
}

impl PlaneStress {
    pub fn new(sheet: &Sheet) -> Result<Self, SheetError> {
        let Sheet { thickness, young_modulus, poisson_ratio, along_lines } = *sheet;
        if !THICKNESSES.contains(&thickness) {
            return Err(SheetError::Thickness(thickness));
        }
        if !is_modulus(young_modulus) {
            return Err(SheetError::YoungModulus(young_modulus));
        }
        if !(0.0..=0.5).contains(&poisson_ratio) {
            return Err(SheetError::PoissonRatio(poisson_ratio));
        }
        let along = along_lines.unwrap_or(young_modulus);
        if !is_modulus(along) {
            return Err(SheetError::AlongLines(along));
        }
        let least = young_modulus * poisson_ratio * poisson_ratio;
        if along <= least {
            return Err(SheetError::TooSoftAlongLines { along, least });
        }
        let d = 1.0 - least / along;
        let (c11, c22) = (along / d, young_modulus / d);
        let mu = young_modulus / (2.0 * (1.0 + poisson_ratio));
        let lambda = c22 - 2.0 * mu;
        let delta_lambda = poisson_ratio * c22 - lambda;
        let beta = c11 - c22 - 2.0 * delta_lambda;
        let moduli = FibreModuli { delta_lambda, delta_mu: 0.0, beta };
        let lines = along_lines.map(|_| moduli);
        let bears_compression = true;
        Ok(PlaneStress {
            thickness,
            young_modulus,
            lambda,
            mu,
            lines,
            tension: 0.0,
            bears_compression,
        })
    }

    /// The sheet with a stress in kPa, in [0, 1000], that is there at rest, the same in every direction of its plane.
    pub fn with_tension(self, tension: f64) -> Result<Self, SheetError> {
        match TENSIONS.contains(&tension) {
            true => Ok(PlaneStress { tension, ..self }),
            false => Err(SheetError::Tension(tension)),
        }
    }

    /// The sheet that wrinkles instead of being pressed (`tension_field`).
    pub fn without_compression(self) -> Result<Self, SheetError> {
        let least = LEAST_TENSION * self.young_modulus;
        match self.tension >= least {
            true => Ok(PlaneStress { bears_compression: false, ..self }),
            false => Err(SheetError::TooSlack { tension: self.tension, least }),
        }
    }

    /// Whether it resists being pressed along itself.
    pub fn bears_compression(&self) -> bool {
        self.bears_compression
    }

    /// At rest, in kPa.
    pub fn tension(&self) -> f64 {
        self.tension
    }

    /// In mm.
    pub fn thickness(&self) -> f64 {
        self.thickness
    }

    /// E_t in kPa.
    pub fn young_modulus(&self) -> f64 {
        self.young_modulus
    }

    /// Whether the sheet has lines along which it is stiffer or softer.
    pub fn has_lines(&self) -> bool {
        self.lines.is_some()
    }

    /// C for strains in the plane; the direction of the lines has length 1 and lies in it.
    pub fn tensor(&self, lines: &Vector3<f64>) -> ElasticTensor {
        let fibre = self.lines.map(|moduli| AlongFibre { direction: *lines, moduli });
        ElasticTensor { lambda: self.lambda, mu: self.mu, fibre }
    }
}
