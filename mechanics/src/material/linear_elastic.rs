//! Linear elastic tissue at small strain, isotropic or with fibres, and the law that it follows at finite strain.

use super::elastic_tensor::ElasticTensor;
use super::error::{MaterialError, is_modulus};
use super::hyperelastic::{Fibres, Hyperelastic, Law, NeoHookean, RubinBodner};
use super::isotropic::Isotropic;
use super::mixing_rule::MixingRule;
use super::transversely_isotropic::{Fibre, TransverselyIsotropic};

/// Linear elastic tissue at small strain: isotropic, or with fibres of one direction at each point.
///
/// sigma = lambda tr(eps) I + 2 mu eps, with lambda = E nu / ((1 + nu)(1 - 2 nu)) and
/// mu = E / (2 (1 + nu)). With fibres these constants are those across them. At finite strain it is neo-Hookean
/// with these constants, unless a law is stated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearElastic {
    isotropic: Isotropic,
    density: f64,
    fibre: Option<TransverselyIsotropic>,
    law: Option<Law>,
    /// At finite strain.
    fibres: Option<Fibres>,
}

impl LinearElastic {
    /// Young's modulus in kPa, in [1e-9, 1e9]; Poisson's ratio in [0, 0.5); density in g/cm³ (mg/mm³).
    pub fn new(
        young_modulus: f64,
        poisson_ratio: f64,
        density: f64,
    ) -> Result<Self, MaterialError> {
        if !is_modulus(young_modulus) {
            return Err(MaterialError::YoungModulus(young_modulus));
        }
        if !(0.0..0.5).contains(&poisson_ratio) {
            return Err(MaterialError::PoissonRatio(poisson_ratio));
        }
        if !(0.0..=100.0).contains(&density) {
            return Err(MaterialError::Density(density));
        }
        let isotropic = Isotropic { young_modulus, poisson_ratio };
        Ok(LinearElastic { isotropic, density, fibre: None, law: None, fibres: None })
    }

    /// Tissue of a law at finite strain, with the constants that the law has at rest; density as above.
    pub fn of_law(law: Law, density: f64) -> Result<Self, MaterialError> {
        let (lambda, mu) = law.at_rest();
        let young_modulus = mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu);
        let poisson_ratio = 0.5 * lambda / (lambda + mu);
        let at_rest = LinearElastic::new(young_modulus, poisson_ratio, density);
        let tissue = at_rest.map_err(|error| match error {
            MaterialError::Density(_) => error,
            _ => MaterialError::LawAtRest { young_modulus, poisson_ratio },
        })?;
        Ok(LinearElastic { law: Some(law), ..tissue })
    }

    /// Tissue of Rubin and Bodner's law with another theta, and what that makes of it at rest; nothing of tissue of another law.
    pub fn with_theta(&self, theta: f64) -> Option<Result<Self, MaterialError>> {
        let Some(Law::RubinBodner(law)) = self.law else { return None };
        let other = Self::of_law(Law::RubinBodner(RubinBodner { theta, ..law }), self.density);
        Some(other.map(|other| LinearElastic { fibre: self.fibre, fibres: self.fibres, ..other }))
    }

    /// The tissue with fibres that only pull at finite strain.
    pub fn with_pulling_fibres(self, fibres: Fibres) -> Self {
        LinearElastic { fibres: Some(fibres), ..self }
    }

    /// What it does at finite strain: the law that is stated, or the neo-Hookean one of its constants.
    pub fn hyperelastic(&self) -> Hyperelastic {
        let (lambda, mu) = (self.lambda(), self.shear_modulus());
        let law = self.law.unwrap_or(Law::NeoHookean(NeoHookean { lambda, mu }));
        Hyperelastic { law, fibres: self.fibres }
    }

    /// The law that is stated for finite strain.
    pub fn stated_law(&self) -> Option<&Law> {
        self.law.as_ref()
    }

    /// The tissue with fibres; what it was before it is across them.
    pub fn with_fibre(self, fibre: &Fibre) -> Result<Self, MaterialError> {
        let fibre = TransverselyIsotropic::new(&self.isotropic, fibre)?;
        Ok(LinearElastic { fibre: Some(fibre), ..self })
    }

    /// The tissue as it is across its fibres, in all directions.
    pub fn without_fibre(self) -> Self {
        LinearElastic { fibre: None, ..self }
    }

    /// The tissue with the fibres of a mixture, whose parts have these shares and one direction of fibres; without where no part
    /// has any.
    pub(super) fn with_mixed_fibres(
        self,
        parts: &[(f64, LinearElastic)],
        rule: MixingRule,
    ) -> Self {
        if parts.iter().all(|(_, part)| part.fibre.is_none()) {
            return self;
        }
        let about = |part: &LinearElastic| {
            let isotropic = TransverselyIsotropic::isotropic(&part.isotropic);
            part.fibre.unwrap_or(isotropic)
        };
        let parts: Vec<(f64, TransverselyIsotropic)> =
            parts.iter().map(|(share, part)| (*share, about(part))).collect();
        LinearElastic { fibre: Some(TransverselyIsotropic::mixture(&parts, rule)), ..self }
    }

    /// Young's modulus along the fibres in kPa, where there are any.
    pub fn fibre_modulus(&self) -> Option<f64> {
        self.fibre.map(|fibre| fibre.young_modulus())
    }

    /// The shear modulus along the fibres in kPa, where there are any.
    pub fn fibre_shear_modulus(&self) -> Option<f64> {
        self.fibre.map(|fibre| fibre.shear_modulus())
    }

    pub fn has_fibre(&self) -> bool {
        self.fibre.is_some()
    }

    /// Whether it has fibres that only pull at finite strain.
    pub fn has_pulling_fibres(&self) -> bool {
        self.fibres.is_some()
    }

    /// The stiffness where the fibres, if there are any, have this direction of length 1.
    pub fn tensor(&self, fibre: &nalgebra::Vector3<f64>) -> ElasticTensor {
        match &self.fibre {
            None => ElasticTensor::isotropic(self.lambda(), self.shear_modulus()),
            Some(law) => law.along(fibre),
        }
    }

    pub fn young_modulus(&self) -> f64 {
        self.isotropic.young_modulus
    }

    pub fn poisson_ratio(&self) -> f64 {
        self.isotropic.poisson_ratio
    }

    /// In mg/mm³.
    pub fn density(&self) -> f64 {
        self.density
    }

    /// Lamé's first constant lambda in kPa.
    pub fn lambda(&self) -> f64 {
        self.isotropic.lambda()
    }

    /// The shear modulus mu in kPa.
    pub fn shear_modulus(&self) -> f64 {
        self.isotropic.shear_modulus()
    }

    /// The bulk modulus K = lambda + 2 mu / 3 in kPa.
    pub fn bulk_modulus(&self) -> f64 {
        self.isotropic.bulk_modulus()
    }
}
