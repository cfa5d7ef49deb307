//! What tissue does: the constants of a material point. Knows no mesh.

pub mod elastic_tensor;
pub mod mixture;
pub mod plane_stress;
pub mod transversely_isotropic;

pub use elastic_tensor::ElasticTensor;
pub use plane_stress::{PlaneStress, Sheet, SheetError};
pub use transversely_isotropic::{Fibre, FibreLaw, TransverselyIsotropic};

/// Linear elastic tissue at small strain: isotropic, or with fibres of one direction at each point.
///
/// sigma = lambda tr(eps) I + 2 mu eps, with lambda = E nu / ((1 + nu)(1 - 2 nu)) and
/// mu = E / (2 (1 + nu)); METHODS A2. With fibres these constants are those across them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearElastic {
    young_modulus: f64,
    poisson_ratio: f64,
    density: f64,
    fibre: Option<TransverselyIsotropic>,
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MaterialError {
    #[error("Young's modulus is {0} kPa, and has to be above 0 and at most 1e9 kPa")]
    YoungModulus(f64),
    #[error("Poisson's ratio is {0}, and has to be at least 0 and below 0.5")]
    PoissonRatio(f64),
    #[error("density is {0} g/cm3, and has to be at least 0 and at most 100 g/cm3")]
    Density(f64),
    #[error(
        "Young's modulus along the fibre is {0} kPa, and has to be above 0 and at most 1e9 kPa"
    )]
    FibreModulus(f64),
    #[error(
        "the shear modulus along the fibre is {0} kPa, and has to be above 0 and at most 1e9 kPa"
    )]
    FibreShear(f64),
    #[error("the law of paper 002 takes its shear modulus from E and nu, and no other one")]
    ShearOfPaper002,
    #[error(
        "Young's modulus is {along} kPa along the fibre and {across} kPa across, and along it has to be above \
         (1 - nu)/2 of that across, {least} kPa"
    )]
    FibreTooSoft { along: f64, across: f64, least: f64 },
    #[error(
        "the law of paper 002 is not positive definite for E_f/E_t = {ratio:.4} and nu = {poisson_ratio}: its \
         smallest eigenvalue is {eigenvalue:.4} kPa, and E_f/E_t has to be below (1-nu)/(2 nu^2) = {limit:.4}"
    )]
    NotPositiveDefinite { ratio: f64, poisson_ratio: f64, eigenvalue: f64, limit: f64 },
}

/// Above 0 and at most `most`.
fn in_range(value: f64, most: f64) -> bool {
    value > 0.0 && value <= most
}

impl LinearElastic {
    /// Young's modulus in kPa, in (0, 1e9]; Poisson's ratio in [0, 0.5); density in g/cm³ (mg/mm³).
    pub fn new(
        young_modulus: f64,
        poisson_ratio: f64,
        density: f64,
    ) -> Result<Self, MaterialError> {
        if !in_range(young_modulus, 1e9) {
            return Err(MaterialError::YoungModulus(young_modulus));
        }
        if !(0.0..0.5).contains(&poisson_ratio) {
            return Err(MaterialError::PoissonRatio(poisson_ratio));
        }
        if !(0.0..=100.0).contains(&density) {
            return Err(MaterialError::Density(density));
        }
        Ok(LinearElastic { young_modulus, poisson_ratio, density, fibre: None })
    }

    /// The tissue with fibres; what it was before it is across them.
    pub fn with_fibre(self, fibre: &Fibre) -> Result<Self, MaterialError> {
        let fibre = TransverselyIsotropic::new(&self, fibre)?;
        Ok(LinearElastic { fibre: Some(fibre), ..self })
    }

    /// The tissue as it is across its fibres, in all directions.
    pub fn without_fibre(self) -> Self {
        LinearElastic { fibre: None, ..self }
    }

    /// Young's modulus along the fibres in kPa, where there are any.
    pub fn fibre_modulus(&self) -> Option<f64> {
        self.fibre.map(|fibre| fibre.young_modulus())
    }

    pub fn has_fibre(&self) -> bool {
        self.fibre.is_some()
    }

    /// The stiffness where the fibres, if there are any, have this direction of length 1.
    pub fn tensor(&self, fibre: &nalgebra::Vector3<f64>) -> ElasticTensor {
        match &self.fibre {
            None => ElasticTensor::isotropic(self.lambda(), self.shear_modulus()),
            Some(law) => law.along(fibre),
        }
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

    /// The bulk modulus K = lambda + 2 mu / 3 in kPa.
    pub fn bulk_modulus(&self) -> f64 {
        self.young_modulus / (3.0 * (1.0 - 2.0 * self.poisson_ratio))
    }
}
