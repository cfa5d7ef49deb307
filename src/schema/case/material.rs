//! Materials by region: stress in kPa, density in g/cm³.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::fibre::FibreDocument;
use super::law::{LawDocument, LawKind};
use super::preset_name::PresetName;
use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::material::{LinearElastic, MaterialError};
use mechanics::prediction::FibreDirection;

/// Default soft tissue: Young's modulus in kPa, Poisson's ratio, density in g/cm³.
pub(super) const DEFAULT_TISSUE: (f64, f64, f64) = (15.0, 0.46, 1.0);

/// Tolerated difference between linear constants and those of a law at zero strain.
const AGREEMENT: f64 = 0.01;

/// The material of a region. In a spec, omitted members are those of the case.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MaterialDocument {
    /// A material of the literature (`GET /v1/materials`): members beside it override it, and it replaces all that is
    /// stated elsewhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub preset: Option<PresetName>,
    /// In [1e-9, 1e9].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 1e-9, maximum = 1e9)]
    pub young_modulus_kpa: Option<f64>,
    /// In [0, 0.5).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 0.0, exclusive_maximum = 0.5)]
    pub poisson_ratio: Option<f64>,
    /// Default 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, minimum = 0.0, maximum = 100.0)]
    pub density_g_per_cm3: Option<f64>,
    /// Absent if the material is isotropic.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub fibre: Option<FibreDocument>,
    /// The hyperelastic law; absent: neo-Hookean with these constants. With a law, Young's modulus and
    /// Poisson's ratio may be omitted: they are those of the law at zero strain, and have to agree with them to 1 %.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub law: Option<LawDocument>,
}

/// Materials by region name; `*` is for every region without an entry.
pub type MaterialDocuments = BTreeMap<String, MaterialDocument>;

impl MaterialDocument {
    /// The members given here, the others from `base`.
    pub(super) fn over(&self, base: &MaterialDocument) -> MaterialDocument {
        MaterialDocument {
            preset: self.preset.or(base.preset),
            young_modulus_kpa: self.young_modulus_kpa.or(base.young_modulus_kpa),
            poisson_ratio: self.poisson_ratio.or(base.poisson_ratio),
            density_g_per_cm3: self.density_g_per_cm3.or(base.density_g_per_cm3),
            fibre: match (&self.fibre, &base.fibre) {
                (Some(own), Some(base)) => Some(own.over(base)),
                (own, base) => own.clone().or(base.clone()),
            },
            law: self.law.clone().or_else(|| base.law.clone()),
        }
    }

    /// A preset over other data of a tissue, of which only the fibre direction is kept.
    pub(super) fn over_course(&self, below: &MaterialDocument) -> MaterialDocument {
        let course = |fibre: &FibreDocument| FibreDocument {
            direction: fibre.direction,
            array: fibre.array.clone(),
            ..FibreDocument::default()
        };
        let fibre = self.fibre.as_ref().map(|own| match &below.fibre {
            Some(below) => own.over(&course(below)),
            None => own.clone(),
        });
        MaterialDocument { fibre, ..self.clone() }
    }

    /// The same over the default tissue, which a law with its own moduli replaces.
    pub(super) fn over_default(&self, base: &MaterialDocument) -> MaterialDocument {
        match self.law.as_ref().is_some_and(LawDocument::has_moduli) {
            true => self.clone(),
            false => self.over(base),
        }
    }

    /// The material and its fibre direction, if any.
    pub(super) fn to_material(
        &self,
        at: &Pointer,
        faults: &mut Faults,
    ) -> Option<(LinearElastic, Option<FibreDirection>)> {
        let isotropic = self.to_isotropic(at, faults)?;
        match &self.fibre {
            None => Some((isotropic, None)),
            Some(fibre) => {
                let (material, course) = fibre.to_fibred(isotropic, &at.key("fibre"), faults)?;
                Some((material, Some(course)))
            }
        }
    }

    /// Refuses an anisotropic law without fibres.
    fn check_pulling(&self, at: &Pointer, faults: &mut Faults) -> Option<()> {
        let needs = self.law.as_ref().is_some_and(|law| law.kind == LawKind::FungAnisotropic);
        let has = self.fibre.as_ref().is_some_and(|fibre| fibre.k1_kpa.is_some());
        if needs && !has {
            let detail = "`fung_anisotropic` needs `fibre` with `k1_kpa`, `k2` and a direction";
            faults.add(&at.key("fibre"), ErrorCode::MissingField, detail);
            return None;
        }
        Some(())
    }

    /// The tissue without its `fibre`.
    pub(super) fn to_isotropic(&self, at: &Pointer, faults: &mut Faults) -> Option<LinearElastic> {
        let Some(law) = &self.law else { return self.to_linear(at, faults) };
        self.check_pulling(at, faults)?;
        let is_whole = self.young_modulus_kpa.is_some() && self.poisson_ratio.is_some();
        // What is stated is checked, whether the law takes its moduli from it or not.
        let linear = match is_whole {
            true => Some(self.to_linear(at, faults)?),
            false => None,
        };
        let place = at.key("law");
        let law_itself = law.to_law(linear.as_ref(), &place, faults)?;
        let density = self.density_g_per_cm3.unwrap_or(DEFAULT_TISSUE.2);
        match LinearElastic::of_law(law_itself, density) {
            Ok(material) => self.agrees(&material, at, faults).then_some(material),
            Err(error) => {
                let field = match error {
                    MaterialError::Density(_) => at.key("density_g_per_cm3"),
                    _ => place,
                };
                faults.add(&field, ErrorCode::OutOfRange, error.to_string());
                None
            }
        }
    }

    /// Refuses linear constants that contradict the law at zero strain.
    fn agrees(&self, law: &LinearElastic, at: &Pointer, faults: &mut Faults) -> bool {
        let differs = |stated: f64, own: f64| (stated - own).abs() > AGREEMENT * own.abs() + 1e-12;
        let (young_modulus, poisson_ratio) = (law.young_modulus(), law.poisson_ratio());
        let compressible = |nu: f64| 1.0 - 2.0 * nu;
        let is_off = |nu: f64| {
            let ratio = compressible(nu) / compressible(poisson_ratio);
            differs(nu, poisson_ratio) || !(0.9..=1.1).contains(&ratio)
        };
        let wrong = [
            (
                "young_modulus_kpa",
                self.young_modulus_kpa.filter(|e| differs(*e, young_modulus)),
                young_modulus,
            ),
            ("poisson_ratio", self.poisson_ratio.filter(|nu| is_off(*nu)), poisson_ratio),
        ];
        let mut agrees = true;
        for (name, stated, own) in wrong {
            let Some(stated) = stated else { continue };
            let detail = format!(
                "`{name}` is {stated}, and the law has {own:.6} at rest: they have to agree to 1 %. State {own:.6}, also \
                 beside a law of the spec where the case states another value, or leave `{name}` out of the case"
            );
            faults.add(&at.key(name), ErrorCode::LawMismatch, detail);
            agrees = false;
        }
        agrees
    }

    fn to_linear(&self, at: &Pointer, faults: &mut Faults) -> Option<LinearElastic> {
        let missing = [
            ("young_modulus_kpa", self.young_modulus_kpa.is_none()),
            ("poisson_ratio", self.poisson_ratio.is_none()),
        ];
        for (name, _) in missing.iter().filter(|(_, missing)| *missing) {
            faults.add(&at.key(name), ErrorCode::MissingField, format!("missing field `{name}`"));
        }
        let density = self.density_g_per_cm3.unwrap_or(DEFAULT_TISSUE.2);
        match LinearElastic::new(self.young_modulus_kpa?, self.poisson_ratio?, density) {
            Ok(material) => Some(material),
            Err(error) => {
                let field = match error {
                    MaterialError::PoissonRatio(_) => "poisson_ratio",
                    MaterialError::Density(_) => "density_g_per_cm3",
                    _ => "young_modulus_kpa",
                };
                faults.add(&at.key(field), ErrorCode::OutOfRange, error.to_string());
                None
            }
        }
    }
}
