//! The two constants of isotropic linear elasticity.

/// Young's modulus E in kPa and Poisson's ratio nu, and the moduli that follow from them (docs/methods.md#linear-elasticity).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Isotropic {
    pub young_modulus: f64,
    pub poisson_ratio: f64,
}

impl Isotropic {
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
