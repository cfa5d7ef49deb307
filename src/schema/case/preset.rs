//! Materials of the literature by name: constants, source, state of the tissue, and caveats.
//!
//! The constants of a name never change, because stored results refer to it: better ones get a new name.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::fibre::{FibreDocument, FibreLawName};
use super::law::{LawDocument, LawKind};
use super::material::MaterialDocument;
use super::preset_name::PresetName;
use super::preset_source::{MEASURED, MEASURED_IN, Words};

/// Source of constants.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SourceDocument {
    pub authors: String,
    pub year: u32,
    /// The section or table.
    pub place: String,
}

/// A material of the literature.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PresetDocument {
    pub name: PresetName,
    pub tissue: String,
    pub source: SourceDocument,
    /// The state of the tissue, and how the constants were obtained.
    pub state: String,
    /// Objections to them; the warning `preset-doubt` of a prediction with it repeats these.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub doubt: Option<String>,
    /// Whether its fibre direction has to be stated beside it, as `fibre.direction` or `fibre.array`.
    pub needs_course: bool,
    /// The tissue that it describes.
    pub material: MaterialDocument,
}

/// A reported Young's modulus, or the range of several.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MeasuredModulusDocument {
    pub tissue: String,
    /// The name in the table.
    pub source: String,
    pub from_kpa: f64,
    pub to_kpa: f64,
}

/// The response of `GET /v1/materials`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MaterialList {
    /// The names that `preset` of a material may have.
    pub presets: Vec<PresetDocument>,
    /// Other moduli of the literature, which differ too much to be used as constants.
    pub measured: Vec<MeasuredModulusDocument>,
    /// The source table of these.
    pub measured_in: SourceDocument,
}

/// A preset as repeated by a result, with the changes of the documents.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct UsedPresetDocument {
    pub source: SourceDocument,
    pub state: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub doubt: Option<String>,
    /// The constants used, with the name of the preset.
    pub material: MaterialDocument,
}

/// Density in g/cm³, eps0 in kPa, p, eta1, eta2 (Zhang et al. 2016, table 2).
const MUSCLE_OF_ZHANG: [f64; 5] = [1.0, 3700.0, 25.0, 595.0, 0.002_16];
const OTHER_OF_ZHANG: [f64; 5] = [1.1, 1700.0, 36.0, 1294.0, 0.000_08];

/// The constants of a preset, without a fibre direction.
pub fn material_of(preset: PresetName) -> MaterialDocument {
    match preset {
        PresetName::TissueChabanas => isotropic(15.0, 0.49),
        PresetName::MuscleAtRestChabanas => isotropic(6.2, 0.49),
        PresetName::MuscleActiveChabanas => {
            along(110.0, FibreLawName::Engineering, isotropic(6.2, 0.49))
        }
        PresetName::FatKim => isotropic(3.0, 0.46),
        PresetName::MuscleKim => along(500.0, FibreLawName::Kim2012, isotropic(790.0, 0.43)),
        PresetName::EmbeddingZachow => isotropic(20.0, 0.455),
        PresetName::MuscleZachow => isotropic(300.0, 0.44),
        PresetName::MuscleMandibleZhang => rubin_bodner(MUSCLE_OF_ZHANG, 0.95),
        PresetName::MuscleBothJawsZhang => rubin_bodner(MUSCLE_OF_ZHANG, 0.9),
        PresetName::OtherMandibleZhang => rubin_bodner(OTHER_OF_ZHANG, 0.95),
        PresetName::OtherBothJawsZhang => rubin_bodner(OTHER_OF_ZHANG, 0.9),
    }
}

/// A material with its preset in full.
pub fn expanded(material: &MaterialDocument) -> MaterialDocument {
    match material.preset {
        Some(preset) => material.over(&material_of(preset)),
        None => material.clone(),
    }
}

/// A preset as the list shows it.
fn described(preset: PresetName) -> PresetDocument {
    let Words { tissue, state, doubt, .. } = preset.words();
    let material = material_of(preset);
    PresetDocument {
        name: preset,
        tissue: tissue.to_owned(),
        source: source(preset),
        state: state.to_owned(),
        doubt: doubt.map(str::to_owned),
        needs_course: material.fibre.is_some(),
        material,
    }
}

fn source(preset: PresetName) -> SourceDocument {
    let Words { authors, year, place, .. } = preset.words();
    SourceDocument { authors: authors.to_owned(), year, place: place.to_owned() }
}

impl MaterialList {
    /// All there is.
    pub fn all() -> Self {
        let (authors, year, place) = MEASURED_IN;
        let measured = MEASURED.iter().map(|&(tissue, source, from_kpa, to_kpa)| {
            let (tissue, source) = (tissue.to_owned(), source.to_owned());
            MeasuredModulusDocument { tissue, source, from_kpa, to_kpa }
        });
        MaterialList {
            presets: PresetName::ALL.into_iter().map(described).collect(),
            measured: measured.collect(),
            measured_in: SourceDocument {
                authors: authors.to_owned(),
                year,
                place: place.to_owned(),
            },
        }
    }
}

/// The presets among expanded materials, by the name of their region or tissue.
pub fn used_presets<'a>(
    expanded: impl Iterator<Item = (&'a String, &'a MaterialDocument)>,
) -> BTreeMap<String, UsedPresetDocument> {
    let used = expanded.filter_map(|(name, material)| {
        let preset = material.preset?;
        let Words { state, doubt, .. } = preset.words();
        let document = UsedPresetDocument {
            source: source(preset),
            state: state.to_owned(),
            doubt: doubt.map(str::to_owned),
            material: material.clone(),
        };
        Some((name.clone(), document))
    });
    used.collect()
}

fn isotropic(young_modulus_kpa: f64, poisson_ratio: f64) -> MaterialDocument {
    MaterialDocument {
        young_modulus_kpa: Some(young_modulus_kpa),
        poisson_ratio: Some(poisson_ratio),
        ..MaterialDocument::default()
    }
}

/// With fibres of this modulus; the other one is transverse.
fn along(young_modulus_kpa: f64, law: FibreLawName, across: MaterialDocument) -> MaterialDocument {
    let fibre = FibreDocument {
        young_modulus_kpa: Some(young_modulus_kpa),
        law: Some(law),
        ..FibreDocument::default()
    };
    MaterialDocument { fibre: Some(fibre), ..across }
}

fn rubin_bodner([density, eps0, p, eta1, eta2]: [f64; 5], theta: f64) -> MaterialDocument {
    let law = LawDocument {
        eps0_kpa: Some(eps0),
        p: Some(p),
        eta1: Some(eta1),
        eta2: Some(eta2),
        theta: Some(theta),
        ..LawDocument::of_kind(LawKind::RubinBodner)
    };
    MaterialDocument {
        density_g_per_cm3: Some(density),
        law: Some(law),
        ..MaterialDocument::default()
    }
}
