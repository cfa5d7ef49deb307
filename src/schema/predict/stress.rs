//! Stress in a result, by region.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::compare::result::StatDocument;

/// The strain measure of the arrays `strain` of `volume.vtu`, as tensor components: shear is half of the change of an angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum StrainMeasure {
    /// (grad u + grad u^T) / 2.
    Small,
    /// Green-Lagrange, (F^T F - 1) / 2, along the undeformed axes.
    Green,
}

impl StrainMeasure {
    pub fn name(self) -> &'static str {
        match self {
            StrainMeasure::Small => "small",
            StrainMeasure::Green => "green",
        }
    }
}

/// Cauchy stress in the tissue, as means over cells, weighted by their undeformed volumes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct StressDocument {
    pub strain: StrainMeasure,
    /// By the names of the regions of the mesh.
    pub regions: BTreeMap<String, RegionStressDocument>,
}

/// Of the cells of a region.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RegionStressDocument {
    /// Von Mises stress in kPa.
    pub von_mises_kpa: StatDocument,
    /// Minus a third of the trace of the stress in kPa: positive under compression.
    pub pressure_kpa: StatDocument,
}
