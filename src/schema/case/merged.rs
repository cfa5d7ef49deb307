//! The materials of a case with those of a spec over them, by region.

use std::collections::{BTreeMap, BTreeSet};

use super::material::{DEFAULT_TISSUE, MaterialDocument, MaterialDocuments};
use super::preset::expanded;
use super::preset_name::doubt;
use crate::schema::wire::fault::{Faults, Pointer};
use crate::schema::wire::limits::Limits;
use mechanics::material::LinearElastic;
use mechanics::mesh::Warning;
use mechanics::mesh::ignored::listed;
use mechanics::prediction::FibreDirection;

/// The entry for every region without a material.
const EVERY_REGION: &str = "*";

/// Materials and their place in the documents.
pub struct PlacedMaterials<'a> {
    pub at: Pointer,
    pub materials: Option<&'a MaterialDocuments>,
}

impl PlacedMaterials<'_> {
    pub(super) fn names(&self, region: &str) -> bool {
        self.materials.is_some_and(|given| given.contains_key(region))
    }

    /// The `*` of a spec if every region of the mesh has its own entry, in the spec or in the case.
    pub fn unused_default(
        &self,
        case: &PlacedMaterials,
        regions: &BTreeSet<String>,
    ) -> Option<Warning> {
        let has_own = |region: &String| self.names(region) || case.names(region);
        if !self.names(EVERY_REGION) || !regions.iter().all(has_own) {
            return None;
        }
        let detail = format!(
            "{} has no effect: it is for regions without an entry, and each of {} has one; name these to change \
             them",
            self.at.key(EVERY_REGION),
            listed(regions)
        );
        Some(Warning::new("material-serves-nothing", detail).with("regions", regions.len() as f64))
    }
}

/// Materials by region name, their fibre directions, and warnings.
pub struct Merged {
    pub materials: BTreeMap<String, LinearElastic>,
    pub fibres: BTreeMap<String, FibreDirection>,
    pub warnings: Vec<Warning>,
}

/// The statements on each region, presets in full, with their places.
type Stated = BTreeMap<String, (Pointer, MaterialDocument)>;

/// The materials of a case with those of a spec over them, field by field.
/// A region that only the spec names starts from the case's `*`.
pub fn merge_materials(
    case: &PlacedMaterials,
    spec: &PlacedMaterials,
    limits: &Limits,
    faults: &mut Faults,
) -> Merged {
    let mut warnings = Vec::new();
    let is_default = !spec.materials.is_some_and(|given| given.contains_key(EVERY_REGION));
    if case.materials.is_none() && is_default {
        warnings.push(default_material());
    }
    for placed in [case, spec] {
        let given = placed.materials;
        faults.check_length(
            &placed.at,
            given.map_or(0, BTreeMap::len),
            limits.map_entries as usize,
        );
        for region in given.into_iter().flat_map(BTreeMap::keys) {
            faults.check_name(&placed.at.key(region), region, limits.name_characters as usize);
        }
    }
    let (mut materials, mut fibres) = (BTreeMap::new(), BTreeMap::new());
    for (region, (at, material)) in merged(case, spec) {
        warnings.extend(doubt(&region, material.preset));
        if let Some((material, course)) = material.to_material(&at, faults) {
            fibres.extend(course.map(|course| (region.clone(), course)));
            materials.insert(region, material);
        }
    }
    Merged { materials, fibres, warnings }
}

/// The statements on each region, the spec over the case.
fn merged(case: &PlacedMaterials, spec: &PlacedMaterials) -> Stated {
    let mut merged = Stated::new();
    if case.materials.is_none() {
        let (young_modulus, poisson_ratio, density) = DEFAULT_TISSUE;
        let tissue = MaterialDocument {
            young_modulus_kpa: Some(young_modulus),
            poisson_ratio: Some(poisson_ratio),
            density_g_per_cm3: Some(density),
            ..MaterialDocument::default()
        };
        merged.insert(EVERY_REGION.to_owned(), (case.at.key(EVERY_REGION), tissue));
    }
    for placed in [case, spec] {
        let base = merged.get(EVERY_REGION).map(|(_, material)| material.clone());
        for (region, material) in placed.materials.into_iter().flatten() {
            let known = merged.get(region).map(|(_, material)| material);
            // Within the case itself an entry stands alone: only a spec leaves fields to what it overrides.
            let below = known.or(base.as_ref()).cloned().unwrap_or_default();
            let own = expanded(material);
            let material = match (own.preset, case.materials) {
                (Some(_), _) => own.over_course(&below),
                (None, Some(_)) => own.over(&below),
                (None, None) => own.over_default(&below),
            };
            merged.insert(region.clone(), (placed.at.key(region), material));
        }
    }
    merged
}

/// The materials of a case with those of a spec over them, by region, with presets in full.
pub fn expanded_materials(
    case: Option<&MaterialDocuments>,
    spec: Option<&MaterialDocuments>,
) -> MaterialDocuments {
    let placed = |materials| PlacedMaterials { at: Pointer::root(), materials };
    let all = merged(&placed(case), &placed(spec)).into_iter();
    all.map(|(region, (_, material))| (region, material)).collect()
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

/// The statements in words: `muscle E 300 kPa nu 0.44, * nu 0.46`.
pub fn in_words(document: &MaterialDocuments) -> String {
    let region = |(name, of): (&String, &MaterialDocument)| {
        let mut words = if name == "*" { "all".to_owned() } else { name.clone() };
        if let Some(preset) = of.preset {
            words += &format!(" {}", preset.name());
        }
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
