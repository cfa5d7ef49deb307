//! What tissue does: the constants of a material point. Knows no mesh.

pub mod mixture;

/// Isotropic linear elastic tissue at small strain.
///
/// sigma = lambda tr(eps) I + 2 mu eps, with lambda = E nu / ((1 + nu)(1 - 2 nu)) and
/// mu = E / (2 (1 + nu)); METHODS A2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearElastic {
    young_modulus: f64,
    poisson_ratio: f64,
    density: f64,
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MaterialError {
    #[error("Young's modulus is {0} kPa, and has to be above 0 and at most 1e9 kPa")]
    YoungModulus(f64),
    #[error("Poisson's ratio is {0}, and has to be at least 0 and below 0.5")]
    PoissonRatio(f64),
    #[error("density is {0} g/cm3, and has to be at least 0 and at most 100 g/cm3")]
    Density(f64),
}

impl LinearElastic {
    /// Young's modulus in kPa, in (0, 1e9]; Poisson's ratio in [0, 0.5); density in g/cm³ (mg/mm³).
    pub fn new(
        young_modulus: f64,
        poisson_ratio: f64,
        density: f64,
    ) -> Result<Self, MaterialError> {
        if !(young_modulus > 0.0 && young_modulus <= 1e9) {
            return Err(MaterialError::YoungModulus(young_modulus));
        }
        if !(0.0..0.5).contains(&poisson_ratio) {
            return Err(MaterialError::PoissonRatio(poisson_ratio));
        }
        if !(0.0..=100.0).contains(&density) {
            return Err(MaterialError::Density(density));
        }
        Ok(LinearElastic { young_modulus, poisson_ratio, density })
    }

    pub fn young_modulus(&self) -> f64 {
        self.young_modulus
    }

    pub fn poisson_ratio(&self) -> f64 {
        self.poisson_ratio
    }

    /// In mg/mm³.
    pub fn density(&self) -> f64 {
        self.density
    }

    /// Lamé's first constant lambda in kPa.
    pub fn lambda(&self) -> f64 {
        let (e, nu) = (self.young_modulus, self.poisson_ratio);
        e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    }

    /// The shear modulus mu in kPa.
    pub fn shear_modulus(&self) -> f64 {
        self.young_modulus / (2.0 * (1.0 + self.poisson_ratio))
    }

    /// The material with the same shear modulus and density whose Lamé constant lambda is zero.
    pub fn shear_only(&self) -> Self {
        let young_modulus = 2.0 * self.shear_modulus();
        LinearElastic { young_modulus, poisson_ratio: 0.0, density: self.density }
    }

    /// The bulk modulus K = lambda + 2 mu / 3 in kPa.
    pub fn bulk_modulus(&self) -> f64 {
        self.young_modulus / (3.0 * (1.0 - 2.0 * self.poisson_ratio))
    }
}
