//! Stress in a result, by region.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::schema::compare::result::StatDocument;

/// Which strain the arrays `strain` of `volume.vtu` hold, as tensor components: shear is half of the change of an angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum StrainMeasure {
    /// (grad u + grad u^T) / 2.
    Small,
    /// Green's (F^T F - 1) / 2, along the axes at rest.
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

/// Cauchy's stress in the tissue, as means over cells, weighted by their volumes at rest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct StressDocument {
    pub strain: StrainMeasure,
    /// By the names of the regions of the mesh.
    pub regions: BTreeMap<String, RegionStressDocument>,
}

/// Of the cells of a region.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RegionStressDocument {
    /// Mises' stress in kPa.
    pub von_mises_kpa: StatDocument,
    /// Minus a third of the trace of the stress in kPa: positive where tissue is pressed.
    pub pressure_kpa: StatDocument,
}
