//! Materials by region: stress in kPa, density in g/cm³.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::fibre::FibreDocument;
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

    pub(super) fn to_isotropic(&self, at: &Pointer, faults: &mut Faults) -> Option<LinearElastic> {
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
            fibre: None,
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
            merged.insert(region.clone(), (at, material.over(&below)));
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
    Warning::new("default-material", "the case names no materials; all tissue has the default one")
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
        words
    };
    document.iter().map(region).collect::<Vec<_>>().join(", ")
}
