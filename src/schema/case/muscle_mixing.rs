//! How the material of muscles becomes that of cells, and what muscles are in the cells of a mesh.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::image::MOST_SAMPLES;
use mechanics::material::mixture::MixingRule;
use mechanics::prediction::{MuscleField, MuscleMixing, MuscleTissue, Scene};

/// How the `material` of muscles becomes the tissue of cells that they fill in part.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MuscleMixingDocument {
    #[serde(default)]
    pub rule: MixingRuleName,
    /// Points in each cell by which the share of a body in it is found.
    #[serde(default = "usual_samples")]
    #[schema(default = 64, minimum = 1, maximum = 512)]
    pub samples: u32,
}

fn usual_samples() -> u32 {
    MuscleMixing::default().samples as u32
}

/// How stiffnesses of parts become that of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum MixingRuleName {
    /// The mean of stiffnesses: parts are strained alike. The stiffest that shares allow.
    #[default]
    Voigt,
    /// The mean of compliances: parts are stressed alike. The softest.
    Reuss,
    /// The mean of logarithms, between both.
    Geometric,
}

impl From<MixingRuleName> for MixingRule {
    fn from(name: MixingRuleName) -> Self {
        match name {
            MixingRuleName::Voigt => MixingRule::Voigt,
            MixingRuleName::Reuss => MixingRule::Reuss,
            MixingRuleName::Geometric => MixingRule::Geometric,
        }
    }
}

impl From<MixingRule> for MixingRuleName {
    fn from(rule: MixingRule) -> Self {
        match rule {
            MixingRule::Voigt => MixingRuleName::Voigt,
            MixingRule::Reuss => MixingRuleName::Reuss,
            MixingRule::Geometric => MixingRuleName::Geometric,
        }
    }
}

impl MuscleMixingDocument {
    pub(super) fn to_mixing(self, at: &Pointer, faults: &mut Faults) -> MuscleMixing {
        let range = 1.0..=MOST_SAMPLES as f64;
        faults.check_range(&at.key("samples"), f64::from(self.samples), range, "");
        MuscleMixing { rule: self.rule.into(), samples: self.samples as usize }
    }
}

/// The muscles of a case in the cells of its mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MusclesDocument {
    pub muscles: BTreeMap<String, MuscleInCellsDocument>,
    /// Where muscles have a `material`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub tissue: Option<MuscleTissueDocument>,
}

/// A muscle in the cells of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MuscleInCellsDocument {
    /// Cells that are of it, be it in part.
    pub cells: u64,
    /// Of the muscle in the tissue: the volume of each cell times its share.
    pub volume_mm3: f64,
    /// Of what its surface encloses.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub enclosed_mm3: Option<f64>,
    /// The second over the first standard deviation of its surface, where its fibres run along its boxes: above 0.4 it is no strap.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub broadness: Option<f64>,
}

/// What the material of muscles makes of the tissue.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MuscleTissueDocument {
    pub rule: MixingRuleName,
    /// Cells that have some of it.
    pub cells: u64,
    /// Cells of several tissues.
    pub mixed_cells: u64,
    /// Cells in which fibres cross, the second eigenvalue of their axes above half of the first.
    pub crossing_cells: u64,
    /// Of the volume of the tissue: cells whose stiffest mixture is more than three times as stiff as their softest.
    pub rule_decides_share: f64,
}

impl MusclesDocument {
    /// Absent where the case names none.
    pub fn of(scene: &Scene) -> Option<Self> {
        let muscles = scene.muscles.iter().map(|own| (own.name.clone(), own.into())).collect();
        let tissue = scene.muscle_tissue.as_ref().map(Into::into);
        (!scene.muscles.is_empty()).then_some(MusclesDocument { muscles, tissue })
    }
}

impl From<&MuscleField> for MuscleInCellsDocument {
    fn from(field: &MuscleField) -> Self {
        MuscleInCellsDocument {
            cells: field.cells.len() as u64,
            volume_mm3: field.volume,
            enclosed_mm3: field.body.map(|body| body.enclosed),
            broadness: field.body.and_then(|body| body.broadness),
        }
    }
}

impl From<&MuscleTissue> for MuscleTissueDocument {
    fn from(told: &MuscleTissue) -> Self {
        MuscleTissueDocument {
            rule: told.rule.into(),
            cells: told.cells as u64,
            mixed_cells: told.mixed as u64,
            crossing_cells: told.crossing as u64,
            rule_decides_share: told.rule_decides,
        }
    }
}
