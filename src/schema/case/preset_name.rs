//! The names of materials of the literature.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::preset_source::{self as source, Words};
use mechanics::mesh::Warning;

/// A material of the literature; `GET /v1/materials` describes each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema)]
pub enum PresetName {
    #[serde(rename = "tissue_chabanas_2003")]
    TissueChabanas,
    #[serde(rename = "muscle_at_rest_chabanas_2003")]
    MuscleAtRestChabanas,
    #[serde(rename = "muscle_active_chabanas_2003")]
    MuscleActiveChabanas,
    #[serde(rename = "fat_kim_2012")]
    FatKim,
    #[serde(rename = "muscle_kim_2012")]
    MuscleKim,
    #[serde(rename = "embedding_zachow_2006")]
    EmbeddingZachow,
    #[serde(rename = "muscle_zachow_2006")]
    MuscleZachow,
    #[serde(rename = "muscle_mandible_zhang_2016")]
    MuscleMandibleZhang,
    #[serde(rename = "muscle_both_jaws_zhang_2016")]
    MuscleBothJawsZhang,
    #[serde(rename = "other_mandible_zhang_2016")]
    OtherMandibleZhang,
    #[serde(rename = "other_both_jaws_zhang_2016")]
    OtherBothJawsZhang,
}

impl PresetName {
    /// In the order of lists.
    pub const ALL: [PresetName; 11] = [
        PresetName::TissueChabanas,
        PresetName::MuscleAtRestChabanas,
        PresetName::MuscleActiveChabanas,
        PresetName::FatKim,
        PresetName::MuscleKim,
        PresetName::EmbeddingZachow,
        PresetName::MuscleZachow,
        PresetName::MuscleMandibleZhang,
        PresetName::MuscleBothJawsZhang,
        PresetName::OtherMandibleZhang,
        PresetName::OtherBothJawsZhang,
    ];

    /// Its name in documents.
    pub fn name(self) -> &'static str {
        self.words().name
    }

    pub(super) fn words(self) -> Words {
        match self {
            PresetName::TissueChabanas => source::TISSUE_CHABANAS,
            PresetName::MuscleAtRestChabanas => source::MUSCLE_AT_REST_CHABANAS,
            PresetName::MuscleActiveChabanas => source::MUSCLE_ACTIVE_CHABANAS,
            PresetName::FatKim => source::FAT_KIM,
            PresetName::MuscleKim => source::MUSCLE_KIM,
            PresetName::EmbeddingZachow => source::EMBEDDING_ZACHOW,
            PresetName::MuscleZachow => source::MUSCLE_ZACHOW,
            PresetName::MuscleMandibleZhang => source::MUSCLE_MANDIBLE_ZHANG,
            PresetName::MuscleBothJawsZhang => source::MUSCLE_BOTH_JAWS_ZHANG,
            PresetName::OtherMandibleZhang => source::OTHER_MANDIBLE_ZHANG,
            PresetName::OtherBothJawsZhang => source::OTHER_BOTH_JAWS_ZHANG,
        }
    }
}

/// The warning of a prediction about the preset of a region or tissue of that name.
pub(super) fn doubt(of: &str, preset: Option<PresetName>) -> Option<Warning> {
    let preset = preset?;
    let Words { authors, year, place, doubt, .. } = preset.words();
    let name = preset.name();
    let detail = format!("{of:?} is `{name}` ({authors} {year}, {place}): {}", doubt?);
    Some(Warning::new("preset-doubt", detail))
}
