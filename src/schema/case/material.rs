//! Materials by region: stress in kPa, density in g/cm³.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::fibre::FibreDocument;
use super::law::{LawDocument, LawKind};
use crate::schema::code::ErrorCode;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use mechanics::material::{LinearElastic, MaterialError};
use mechanics::mesh::Warning;
use mechanics::prediction::FibreDirection;

/// Serves every region without a material of its own.
const EVERY_REGION: &str = "*";
/// Soft tissue where a case says nothing: Young's modulus in kPa, Poisson's ratio, density in g/cm³.
const DEFAULT_TISSUE: (f64, f64, f64) = (15.0, 0.46, 1.0);

/// By how much linear constants may differ from those of a law at rest.
const AGREEMENT: f64 = 0.01;

/// The material of a region. In a spec, what is not given stays what the case says.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MaterialDocument {
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
    /// Absent where the material is isotropic.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub fibre: Option<FibreDocument>,
    /// What the tissue does at finite strain; absent: neo-Hookean with these constants. Where it is stated, Young's modulus and
    /// Poisson's ratio may be left out: they are those of the law at rest, and have to agree with them to 1 %.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub law: Option<LawDocument>,
}

/// Materials by region name; `*` serves every region without an entry of its own.
pub type MaterialDocuments = BTreeMap<String, MaterialDocument>;

impl MaterialDocument {
    /// What is given here, and for the rest what `base` gives.
    fn over(&self, base: &MaterialDocument) -> MaterialDocument {
        MaterialDocument {
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

    /// The same over the default tissue, which nobody stated: a law with moduli of its own takes its place.
    fn over_default(&self, base: &MaterialDocument) -> MaterialDocument {
        match self.law.as_ref().is_some_and(LawDocument::has_moduli) {
            true => self.clone(),
            false => self.over(base),
        }
    }

    /// The material and the course of its fibres, if it has any.
    fn to_material(
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
            let detail = "`fung_anisotropic` has fibres: `fibre` with `k1_kpa`, `k2` and a course is missing";
            faults.add(&at.key("fibre"), ErrorCode::MissingField, detail);
            return None;
        }
        Some(())
    }

    /// The tissue without what `fibre` says.
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

    /// Refuses linear constants that are not those of the law at rest.
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
                "`{name}` is {stated}, and the law has {own:.6} at rest: they have to agree to 1 %. Leave `{name}` out; that \
                 of a case stands below a law of the spec until the spec states it too"
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

/// Materials and the place in the documents where they stand.
pub struct PlacedMaterials<'a> {
    pub at: Pointer,
    pub materials: Option<&'a MaterialDocuments>,
}

/// Materials by region name, the courses of their fibres, and what a reader must know.
pub struct Merged {
    pub materials: BTreeMap<String, LinearElastic>,
    pub fibres: BTreeMap<String, FibreDirection>,
    pub warnings: Vec<Warning>,
}

/// The materials of a case with those of a spec over them, field by field.
/// A region that only the spec names starts from the case's `*`.
pub fn merge_materials(
    case: &PlacedMaterials,
    spec: &PlacedMaterials,
    limits: &Limits,
    faults: &mut Faults,
) -> Merged {
    let mut merged: BTreeMap<String, (Pointer, MaterialDocument)> = BTreeMap::new();
    let mut warnings = Vec::new();
    if case.materials.is_none() {
        let (young_modulus, poisson_ratio, density) = DEFAULT_TISSUE;
        let tissue = MaterialDocument {
            young_modulus_kpa: Some(young_modulus),
            poisson_ratio: Some(poisson_ratio),
            density_g_per_cm3: Some(density),
            ..MaterialDocument::default()
        };
        let at = case.at.key(EVERY_REGION);
        merged.insert(EVERY_REGION.to_owned(), (at, tissue));
        if !spec.materials.is_some_and(|given| given.contains_key(EVERY_REGION)) {
            warnings.push(default_material());
        }
    }
    for placed in [case, spec] {
        let base = merged.get(EVERY_REGION).map(|(_, material)| material.clone());
        let given = placed.materials;
        faults.check_length(
            &placed.at,
            given.map_or(0, BTreeMap::len),
            limits.map_entries as usize,
        );
        for (region, material) in given.into_iter().flatten() {
            let at = placed.at.key(region);
            faults.check_name(&at, region, limits.name_characters as usize);
            let known = merged.get(region).map(|(_, material)| material);
            // Within the case itself an entry stands alone: only a spec leaves fields to what it overrides.
            let below = known.or(base.as_ref()).cloned().unwrap_or_default();
            let material = match case.materials {
                Some(_) => material.over(&below),
                None => material.over_default(&below),
            };
            merged.insert(region.clone(), (at, material));
        }
    }
    let (mut materials, mut fibres) = (BTreeMap::new(), BTreeMap::new());
    for (region, (at, material)) in merged {
        if let Some((material, course)) = material.to_material(&at, faults) {
            fibres.extend(course.map(|course| (region.clone(), course)));
            materials.insert(region, material);
        }
    }
    Merged { materials, fibres, warnings }
}

fn default_material() -> Warning {
    let (young_modulus, poisson_ratio, density) = DEFAULT_TISSUE;
    let detail = format!(
        "the case names no materials; all tissue has the default one: Young's modulus {young_modulus} kPa, Poisson's ratio \
         {poisson_ratio}"
    );
    Warning::new("default-material", detail)
        .with("young_modulus_kpa", young_modulus)
        .with("poisson_ratio", poisson_ratio)
        .with("density_g_per_cm3", density)
}

/// What is stated, in words: `muscle E 300 kPa nu 0.44, * nu 0.46`.
pub fn in_words(document: &MaterialDocuments) -> String {
    let region = |(name, of): (&String, &MaterialDocument)| {
        let mut words = if name == "*" { "all".to_owned() } else { name.clone() };
        if let Some(modulus) = of.young_modulus_kpa {
            words += &format!(" E {modulus} kPa");
        }
        if let Some(ratio) = of.poisson_ratio {
            words += &format!(" nu {ratio}");
        }
        if let Some(law) = &of.law {
            words += &format!(" {}", law.kind.name());
        }
        words
    };
    document.iter().map(region).collect::<Vec<_>>().join(", ")
}
