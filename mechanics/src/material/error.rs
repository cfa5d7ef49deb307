//! Errors in the constants of a material.

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MaterialError {
    #[error("Young's modulus is {0} kPa, and has to be at least 1e-9 and at most 1e9 kPa")]
    YoungModulus(f64),
    #[error("Poisson's ratio is {0}, and has to be at least 0 and below 0.5")]
    PoissonRatio(f64),
    #[error("density is {0} g/cm3, and has to be at least 0 and at most 100 g/cm3")]
    Density(f64),
    #[error(
        "at rest this law has a Young's modulus of {young_modulus} kPa and a Poisson's ratio of {poisson_ratio}, which have to \
         be at least 1e-9 and at most 1e9 kPa, and at least 0 and below 0.5"
    )]
    LawAtRest { young_modulus: f64, poisson_ratio: f64 },
    #[error(
        "Young's modulus along the fibre is {0} kPa, and has to be at least 1e-9 and at most 1e9 kPa"
    )]
    FibreModulus(f64),
    #[error(
        "the shear modulus along the fibre is {0} kPa, and has to be at least 1e-9 and at most 1e9 kPa"
    )]
    FibreShear(f64),
    #[error("the law of Kim et al. 2012 takes its shear modulus from E and nu: none may be stated")]
    ShearModulusOfKimLaw,
    #[error(
        "Young's modulus is {along} kPa along the fibre and {across} kPa across, and along it has to be above \
         (1 - nu)/2 of that across, {least} kPa"
    )]
    FibreTooSoft { along: f64, across: f64, least: f64 },
    #[error(
        "the law of Kim et al. 2012 is not positive definite for E_f/E_t = {ratio:.4} and nu = {poisson_ratio}: its \
         smallest eigenvalue is {eigenvalue:.4} kPa, and E_f/E_t has to be below (1-nu)/(2 nu^2) = {limit:.4}"
    )]
    NotPositiveDefinite { ratio: f64, poisson_ratio: f64, eigenvalue: f64, limit: f64 },
}

/// Stiffness that a mistake in the unit explains and no tissue, in kPa: smaller and larger ones leave the range of
/// single precision, in which systems are preconditioned, once they are multiplied by lengths.
const MODULI: std::ops::RangeInclusive<f64> = 1e-9..=1e9;

/// Whether a modulus in kPa can be computed with.
pub(super) fn is_modulus(value: f64) -> bool {
    MODULI.contains(&value)
}
