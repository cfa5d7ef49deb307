//! Directions of anisotropy: fibres of a material, lines of the skin.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::law::{EXPONENT, MODULUS};
use crate::schema::Triple;
use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::material::hyperelastic::Fibres;
use mechanics::material::{Fibre, FibreLaw, LinearElastic, MaterialError};
use mechanics::mesh::Vector;
use mechanics::prediction::FibreDirection;

/// Fibres of a material, whose Young's modulus and Poisson's ratio are then transverse. In a spec,
/// omitted members are those of the case.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct FibreDocument {
    /// Along the fibre, for methods of small strain; in [1e-9, 1e9]. Optional beside `k1_kpa` and `k2`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1e-9, maximum = 1e9)]
    pub young_modulus_kpa: Option<f64>,
    /// Between the fibre and a transverse direction; in [1e-9, 1e9]. Default E / (2 (1 + nu)) of the material. The
    /// law of Kim et al. 2012 has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1e-9, maximum = 1e9)]
    pub shear_modulus_kpa: Option<f64>,
    /// Uniform in the region. Exactly one of `direction` and `array`; neither length nor sign matters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub direction: Option<Triple>,
    /// A cell array of the volume mesh with 3 components, or else a point array: cells then have the mean axis of their nodes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub array: Option<String>,
    /// Of tension-only fibres at finite strain: W = k1/(2 k2) (exp(k2 (I4 - 1)^2) - 1) if they are stretched, I4 their
    /// squared stretch, added to any law of the tissue between them. `k1_kpa` and `k2` go together.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1e-9, maximum = 1e9)]
    pub k1_kpa: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1e-6, maximum = 1e3)]
    pub k2: Option<f64>,
    /// Default `engineering`; `kim_2012` is the law of Kim et al. 2012.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub law: Option<FibreLawName>,
}

/// How moduli give a stiffness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum FibreLawName {
    /// Longitudinal and transverse moduli are those of tensile tests of a strip.
    #[default]
    Engineering,
    /// Lamé constants from each modulus with the same Poisson's ratio nu (Kim et al. 2012, eq. 33, corrected:
    /// docs/methods.md#fibres); only if the ratio of moduli along
    /// and across is below (1 - nu) / (2 nu^2).
    #[serde(rename = "kim_2012", alias = "paper_002")]
    Kim2012,
}

impl FibreDocument {
    /// The members given here, the others from `base`; a direction given here replaces the other.
    pub(super) fn over(&self, base: &FibreDocument) -> FibreDocument {
        let course = match (self.direction, &self.array) {
            (None, None) => base,
            _ => self,
        };
        FibreDocument {
            young_modulus_kpa: self.young_modulus_kpa.or(base.young_modulus_kpa),
            shear_modulus_kpa: self.shear_modulus_kpa.or(base.shear_modulus_kpa),
            direction: course.direction,
            array: course.array.clone(),
            k1_kpa: self.k1_kpa.or(base.k1_kpa),
            k2: self.k2.or(base.k2),
            law: self.law.or(base.law),
        }
    }

    /// The material with these fibres, and their directions.
    pub(super) fn to_fibred(
        &self,
        across: LinearElastic,
        at: &Pointer,
        faults: &mut Faults,
    ) -> Option<(LinearElastic, FibreDirection)> {
        let material = self.to_stiffened(across, at, faults);
        let course = to_course(self.direction, self.array.as_deref(), at, faults);
        Some((material?, course?))
    }

    /// The material with these fibres, in any direction.
    pub(super) fn to_stiffened(
        &self,
        across: LinearElastic,
        at: &Pointer,
        faults: &mut Faults,
    ) -> Option<LinearElastic> {
        let pulling = self.pulling(at, faults);
        let is_linear = self.young_modulus_kpa.is_some()
            || self.shear_modulus_kpa.is_some()
            || self.law.is_some();
        let pulls = self.k1_kpa.is_some() || self.k2.is_some();
        if self.young_modulus_kpa.is_none() && (is_linear || !pulls) {
            let place = at.key("young_modulus_kpa");
            faults.add(&place, ErrorCode::MissingField, "missing field `young_modulus_kpa`");
        }
        let across = pulling.map_or(across, |fibres| across.with_pulling_fibres(fibres));
        if !is_linear {
            return pulling.map(|_| across);
        }
        match across.with_fibre(&self.to_fibre()?) {
            Ok(material) => Some(material),
            Err(error) => {
                let (field, code) = match error {
                    MaterialError::FibreShear(_) => ("shear_modulus_kpa", ErrorCode::OutOfRange),
                    MaterialError::ShearModulusOfKimLaw => {
                        ("shear_modulus_kpa", ErrorCode::NotInLaw)
                    }
                    MaterialError::FibreTooSoft { .. }
                    | MaterialError::NotPositiveDefinite { .. } => {
                        ("young_modulus_kpa", ErrorCode::NotPositiveDefinite)
                    }
                    MaterialError::FibreModulus(_)
                    | MaterialError::YoungModulus(_)
                    | MaterialError::PoissonRatio(_)
                    | MaterialError::LawAtRest { .. }
                    | MaterialError::Density(_) => ("young_modulus_kpa", ErrorCode::OutOfRange),
                };
                faults.add(&at.key(field), code, error.to_string());
                None
            }
        }
    }
}

impl FibreDocument {
    /// Its constants at small strain, if any.
    pub(super) fn to_fibre(&self) -> Option<Fibre> {
        let law = match self.law.unwrap_or_default() {
            FibreLawName::Engineering => FibreLaw::Engineering,
            FibreLawName::Kim2012 => FibreLaw::Kim2012,
        };
        let (young_modulus, shear_modulus) = (self.young_modulus_kpa?, self.shear_modulus_kpa);
        Some(Fibre { young_modulus, shear_modulus, law })
    }

    /// The tension-only fibres, if both constants are given.
    fn pulling(&self, at: &Pointer, faults: &mut Faults) -> Option<Fibres> {
        if self.k1_kpa.is_none() && self.k2.is_none() {
            return None;
        }
        let constants = [("k1_kpa", self.k1_kpa, MODULUS, "kPa"), ("k2", self.k2, EXPONENT, "")];
        for (name, value, range, unit) in constants {
            match value {
                Some(value) => _ = faults.check_range(&at.key(name), value, range, unit),
                None => {
                    let detail = format!("missing field `{name}`: `k1_kpa` and `k2` go together");
                    faults.add(&at.key(name), ErrorCode::MissingField, detail);
                }
            }
        }
        Some(Fibres { k1: self.k1_kpa?, k2: self.k2? })
    }
}

/// The one direction or array that is given.
pub(super) fn to_course(
    direction: Option<Triple>,
    array: Option<&str>,
    at: &Pointer,
    faults: &mut Faults,
) -> Option<FibreDirection> {
    let given = usize::from(direction.is_some()) + usize::from(array.is_some());
    if !faults.check_one_of(at, given, "`direction`, `array`") {
        return None;
    }
    match (direction, array) {
        (Some(direction), _) => Some(FibreDirection::Uniform(Vector::from(direction))),
        (None, array) => array.map(|name| FibreDirection::Array(name.trim().to_owned())),
    }
}
