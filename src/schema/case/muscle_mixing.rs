//! Mixing of muscles into the material of cells, passive and active, and the report of muscles in the cells of a mesh.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::wire::fault::{Faults, Pointer};
use mechanics::image::MOST_SAMPLES;
use mechanics::material::Fibre;
use mechanics::material::mixture::MixingRule;
use mechanics::mesh::VolumeMesh;
use mechanics::prediction::{MuscleField, MuscleMixing, MuscleTissue, Scene, Stiffening};

/// How the `material` of muscles is mixed into cells that they fill in part.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MuscleMixingDocument {
    #[serde(default)]
    pub rule: MixingRuleName,
    /// Sample points in each cell for the share of a body.
    #[serde(default = "default_samples")]
    #[schema(default = 64, minimum = 1, maximum = 512)]
    pub samples: u32,
}

fn default_samples() -> u32 {
    MuscleMixing::default().samples as u32
}

/// How the stiffnesses of the parts of a cell are averaged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum MixingRuleName {
    /// The mean of stiffnesses: uniform strain, the upper bound.
    #[default]
    Voigt,
    /// The mean of compliances: uniform stress, the lower bound.
    Reuss,
    /// The mean of logarithms, between the two.
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

/// Stiffness along the fibres of an active muscle: E_f + (E_0 - E_f) T / T_0 with E_f that of its material, T the `stress_kpa` of
/// its activation, at most T_0 (Chabanas et al. 2003: from 6.2 to 110 kPa).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct StiffeningDocument {
    /// E_0, of the fully active muscle; in [1e-9, 1e9] and not below that of the material.
    #[schema(minimum = 1e-9, maximum = 1e9)]
    pub young_modulus_kpa: f64,
    /// T_0, its stress then; in [0.001, 10000].
    #[schema(minimum = 0.001, maximum = 10000.0)]
    pub stress_kpa: f64,
}

impl StiffeningDocument {
    pub(super) fn to_stiffening(
        self,
        fibre: Fibre,
        at: &Pointer,
        faults: &mut Faults,
    ) -> Option<Stiffening> {
        let (own, stress) = (self.young_modulus_kpa, self.stress_kpa);
        let least = fibre.young_modulus;
        let is_right = faults.check_range(&at.key("stress_kpa"), stress, 1e-3..=1e4, "kPa");
        (faults.check_range(&at.key("young_modulus_kpa"), own, least..=1e9, "kPa") && is_right)
            .then_some(Stiffening { fibre, young_modulus: own, stress })
    }
}

/// The muscles of a case in the cells of its mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MusclesDocument {
    pub muscles: BTreeMap<String, MuscleInCellsDocument>,
    /// If muscles have a `material`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub tissue: Option<MuscleTissueDocument>,
}

/// A muscle in the cells of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MuscleInCellsDocument {
    /// Cells with a share of it.
    pub cells: u64,
    /// Of the muscle in the mesh: the sum of cell volume times share.
    pub volume_mm3: f64,
    /// Inside its surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub enclosed_mm3: Option<f64>,
    /// The second over the first standard deviation of its surface, if its fibres follow its boxes: above 0.4 it is no strap.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub broadness: Option<f64>,
}

/// The effect of muscle materials on the tissue.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MuscleTissueDocument {
    pub rule: MixingRuleName,
    /// Cells with a share of any muscle.
    pub cells: u64,
    /// Cells of several tissues.
    pub mixed_cells: u64,
    /// Cells with crossing fibres: the second eigenvalue of their axes is above half of the first.
    pub crossing_cells: u64,
    /// Share of the tissue volume in cells whose stiffest mixture is more than three times as stiff as their softest.
    pub rule_decides_share: f64,
}

impl MusclesDocument {
    /// Absent without muscles in the case.
    pub fn of(scene: &Scene) -> Option<Self> {
        let of =
            |own: &MuscleField| (own.name.clone(), MuscleInCellsDocument::of(own, &scene.mesh));
        let muscles = scene.muscles.iter().map(of).collect();
        let tissue = scene.muscle_tissue.as_ref().map(Into::into);
        (!scene.muscles.is_empty()).then_some(MusclesDocument { muscles, tissue })
    }
}

impl MuscleInCellsDocument {
    fn of(field: &MuscleField, mesh: &VolumeMesh) -> Self {
        MuscleInCellsDocument {
            cells: field.cells.len() as u64,
            volume_mm3: field.volume(mesh),
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
